//! What can be implausible about an arm.

use std::fmt;

use serde::Serialize;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// It could not be told; what would tell it.
    Open,
    /// It may be right; somebody should look.
    Doubtful,
    /// It is wrong.
    Wrong,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// What was looked at, a word for programs: `rate`, `torque_sign`, …
    pub what: &'static str,
    /// Which joint, where it is about one.
    pub joint: Option<String>,
    /// In words, with numbers and what to do.
    pub words: String,
}

impl Finding {
    /// About the arm as a whole.
    pub fn new(severity: Severity, what: &'static str, words: impl Into<String>) -> Finding {
        Finding {
            severity,
            what,
            joint: None,
            words: words.into(),
        }
    }

    /// About a joint.
    pub fn of(self, joint: &str) -> Finding {
        Finding {
            joint: Some(joint.to_owned()),
            ..self
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = match self.severity {
            Severity::Open => "open    ",
            Severity::Doubtful => "doubtful",
            Severity::Wrong => "WRONG   ",
        };
        match &self.joint {
            Some(joint) => write!(f, "{mark}  {joint}: {}", self.words),
            None => write!(f, "{mark}  {}", self.words),
        }
    }
}

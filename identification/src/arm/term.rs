//! An effect in the model of an arm: what it is, and of which joint.

use std::fmt;

use crate::data::{CustomEffect, Term};

/// An effect of an arm's model.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmTerm {
    /// The effect, of a joint or of the arm.
    pub effect: Term,
    /// Name of its joint; `None`: every joint, or the arm.
    pub joint: Option<String>,
}

impl ArmTerm {
    /// Of a name as it is written in files: `payload`, `stribeck@elbow`.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let (id, joint) = split(text);
        Self {
            effect: Term::Catalogue(id.to_owned()),
            joint: joint.map(str::to_owned),
        }
    }

    /// The same of a formula of the user's own, whose name may say the joint.
    #[must_use]
    pub fn of(term: &Term) -> Self {
        match term {
            Term::Catalogue(text) => Self::parse(text),
            Term::Custom(custom) => {
                let (name, joint) = split(&custom.name);
                let (name, joint) = (name.to_owned(), joint.map(str::to_owned));
                let mut custom = custom.clone();
                custom.name = name;
                Self {
                    effect: Term::Custom(custom),
                    joint,
                }
            }
        }
    }

    /// As it is written in files: what [`of`](Self::of) reads.
    #[must_use]
    pub fn written(&self) -> Term {
        match &self.effect {
            Term::Catalogue(_) => Term::Catalogue(self.to_string()),
            Term::Custom(own) => Term::Custom(CustomEffect {
                name: self.to_string(),
                ..own.clone()
            }),
        }
    }
}

fn split(text: &str) -> (&str, Option<&str>) {
    match text.split_once('@') {
        Some((name, joint)) => (name.trim(), Some(joint.trim())),
        None => (text.trim(), None),
    }
}

impl fmt::Display for ArmTerm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.joint {
            Some(joint) => write!(f, "{}@{joint}", self.effect.name()),
            None => f.write_str(self.effect.name()),
        }
    }
}

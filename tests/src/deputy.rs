//! Somebody on a host who gives words and looks, without a process for every word.
//!
//! `src/bin/deputy.rs` is the process on the host, in its network and shared memory; here is
//! how a test talks to it: a line in, a line of JSON out.

use std::{
    io::{BufRead, BufReader, Lines, Write},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
};

use ferntast_msgs::Time;
use serde_json::Value;

/// What a deputy sees on its host.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sight {
    /// State of the device of that host; `None` while the device says nothing.
    pub state: Option<String>,
    /// The law of the link's end of the operator.
    pub law: Option<String>,
    /// Whether a tip was commanded a moment ago.
    pub commanded: bool,
    /// Normal force of the contact \[N\]; zero without one.
    pub force: f64,
}

/// A deputy on a host; ends with its handle.
#[derive(Debug)]
pub struct Deputy {
    child: Child,
    input: Option<ChildStdin>,
    answers: Lines<BufReader<ChildStdout>>,
}

impl Deputy {
    /// Starts `command`, a deputy in a session that is running or being started.
    ///
    /// # Panics
    ///
    /// It cannot be started.
    pub fn start(mut command: Command) -> Deputy {
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("cannot start {command:?}: {error}"));
        let input = child.stdin.take();
        let output = child.stdout.take().expect("a pipe was asked for");
        Deputy {
            child,
            input,
            answers: BufReader::new(output).lines(),
        }
    }

    /// Says `line`; gives the answer.
    ///
    /// # Panics
    ///
    /// It has ended, or does not understand.
    pub fn say(&mut self, line: &str) -> Value {
        let input = self.input.as_mut().expect("open until it is dropped");
        let answer = writeln!(input, "{line}")
            .and_then(|()| input.flush())
            .and_then(|()| self.answers.next().unwrap_or_else(|| Ok(String::new())))
            .unwrap_or_else(|error| panic!("the deputy has ended: {error}"));
        serde_json::from_str(&answer).unwrap_or_else(|error| {
            panic!("the deputy was told {line:?} and said {answer:?}: {error}")
        })
    }

    /// When a word to `device` was given.
    pub fn word(&mut self, device: &str, word: &str) -> Time {
        let told = self.say(&format!("{device} {word}"));
        Time::from_nanos(told["at"].as_i64().unwrap_or(0))
    }

    /// What is to be seen.
    pub fn look(&mut self) -> Sight {
        let told = self.say("look");
        let text = |key: &str| told[key].as_str().map(str::to_owned);
        Sight {
            state: text("state"),
            law: text("law"),
            commanded: told["commanded"].as_bool().unwrap_or(false),
            force: told["force"].as_f64().unwrap_or(0.0),
        }
    }
}

impl Drop for Deputy {
    fn drop(&mut self) {
        // It ends with its input.
        self.input = None;
        // It may be gone already.
        let _ = self.child.wait();
    }
}

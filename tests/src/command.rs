//! `ferntast` run to its end, and what it recorded.

use std::{path::Path, time::Duration};

use ferntast_bag::BagReader;
use ferntast_bus::Received;
use ferntast_msgs::{Message, topics::Topic};
use serde_json::Value;

use crate::{Ended, Process, Session};

/// How long anything may take on a machine that is busy.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// Runs `ferntast` with these arguments to its end.
pub fn run(session: &Session, arguments: &[&str]) -> Ended {
    Process::spawn(session.ferntast(arguments)).wait(PATIENCE)
}

/// Runs `ferntast` with these arguments; it has to refuse its input: exit
/// code 2, nothing on stdout, a few lines on stderr with all of these words.
///
/// # Panics
///
/// It does not.
pub fn refused(session: &Session, arguments: &[&str], words: &[&str]) {
    let ended = run(session, arguments);
    assert_eq!(ended.status.code(), Some(2), "{ended:#?}");
    assert_eq!(ended.stdout, "", "{ended:#?}");
    for word in words {
        assert!(ended.stderr.contains(word), "no {word:?} in {ended:#?}");
    }
    let panicked = ended.stderr.contains("panicked");
    assert!(!panicked && ended.stderr.lines().count() <= 6, "{ended:#?}");
}

/// An experiment on the second joint of a session recorded as `first`, by the
/// model that its servo believes in.
pub const JOINT_2: &str = include_str!("joint_2.toml");

/// Records a session in virtual time, and writes [`JOINT_2`] as `joint.toml`.
///
/// # Panics
///
/// It cannot.
pub fn experiment_on_joint_2(session: &Session) {
    let arguments = ["lockstep", "--duration", "40", "--seed", "3"];
    run(session, &[&arguments[..], &["--record", "first"]].concat()).success();
    std::fs::write(session.folder().join("joint.toml"), JOINT_2)
        .unwrap_or_else(|error| panic!("joint.toml: {error}"));
}

/// The number at `path`, as in `servo.rate_hz`, of a JSON object.
///
/// # Panics
///
/// There is none.
pub fn number(json: &Value, path: &str) -> f64 {
    path.split('.')
        .fold(json, |value, key| &value[key])
        .as_f64()
        .unwrap_or_else(|| panic!("no number {path} in {json:#}"))
}

/// Every message of `topic` in the recording at `path`.
///
/// # Panics
///
/// It cannot be read.
pub fn messages<M: Message>(path: &Path, topic: Topic<M>) -> Vec<Received<M>> {
    let reader = BagReader::open(path).unwrap_or_else(|error| panic!("{error}"));
    let messages = reader
        .messages::<M>(&topic.name)
        .unwrap_or_else(|error| panic!("{error}"));
    messages
        .map(|message| {
            let message = message.unwrap_or_else(|error| panic!("{}: {error}", topic.name));
            Received {
                message: message.message,
                received: message.log_time,
                source: 0,
            }
        })
        .collect()
}

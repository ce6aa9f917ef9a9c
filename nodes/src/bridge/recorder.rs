//! The recorder: writes every topic into a rosbag2 directory, from the start
//! of the session or when `/recorder/command` says so.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
};

use chrono::DateTime;
use ferntast_bag::BagOptions;
use ferntast_bus::{Bus, Depth, McapBus, SharedMemoryBus};
use ferntast_config::Loaded;
use ferntast_lab::experiment::RECORD;
use ferntast_msgs::{
    Text, Time,
    sample::{Fault, Level, RecorderAction, RecorderStatusSample},
    topics,
};

use super::{
    forwarder::{Forwarder, Forwarding, Stamp},
    forwarding_loop::ForwardingLoop,
};
use crate::process::{NodeError, ProcessContext};

/// Name of the node.
pub const NAME: &str = "recorder";

/// How often it tells what it does \[ns\].
const STATUS_NANOS: i64 = 500_000_000;

/// Options of a recording that tell what it was made of: `mode` is `session`
/// or `lockstep`; scenario, arm and link are kept as JSON.
pub fn bag_options(loaded: &Loaded, mode: &str) -> BagOptions {
    let own = [
        ("mode", mode.to_owned()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    let entries = own.into_iter().chain(loaded.entries());
    let record: BTreeMap<String, String> = entries
        .map(|(key, value)| (key.to_owned(), value))
        .collect();
    BagOptions {
        custom: [(RECORD.to_owned(), record)].into(),
        ..BagOptions::default()
    }
}

/// Opens a recording for writing, with what is needed to run it again.
///
/// # Errors
///
/// The folder exists, cannot be made, or the disk is full.
pub fn create(folder: &Path, options: BagOptions) -> Result<McapBus, NodeError> {
    McapBus::create_with(folder, options).map_err(|error| NodeError::Bag {
        path: folder.to_owned(),
        reason: error.to_string(),
    })
}

/// Folder of the recorder's `generation`: one that died leaves its own behind.
pub fn folder(bag: &Path, generation: u32) -> PathBuf {
    if generation == 0 {
        return bag.to_owned();
    }
    let mut name = bag.file_name().unwrap_or_default().to_owned();
    name.push(format!("_restart_{generation}"));
    bag.with_file_name(name)
}

/// The folder that a command names: relative, and not up; without a name one
/// named after the time.
fn asked_for(label: &str, now: Time) -> Option<PathBuf> {
    if label.is_empty() {
        let time = DateTime::from_timestamp_nanos(now.nanos());
        return Some(PathBuf::from(format!(
            "recordings/{}",
            time.format("%Y-%m-%d_%H-%M-%S")
        )));
    }
    let path = Path::new(label);
    let within = path
        .components()
        .all(|part| matches!(part, Component::Normal(_)));
    within.then(|| path.to_owned())
}

/// A recording that is being written.
struct Recording {
    folder: PathBuf,
    bag: McapBus,
}

fn begin(
    process: &ProcessContext,
    forwarding: &mut ForwardingLoop,
    folder: PathBuf,
) -> Result<Recording, NodeError> {
    let options = bag_options(&process.session.loaded, "session");
    let bag = create(&folder, options)?;
    let to = Bus::Mcap(bag.clone());
    let mut forwarder = Forwarder::default();
    let joints = process.session.joints();
    forwarder.add_topics(&process.bus, &to, Stamp::Received, &joints, |topic| {
        Forwarding::Every {
            queue: SharedMemoryBus::max_queue(topic.delivery),
        }
    })?;
    // What waits already comes first; the recording is whole from here on.
    if forwarder.forward(process.clock.now()).failed > 0 {
        return Err(NodeError::Bag {
            path: folder,
            reason: "the first messages could not be written: is the disk full?".to_owned(),
        });
    }
    forwarder.forget_losses();
    forwarding.begin(forwarder);
    Ok(Recording { folder, bag })
}

fn finish(recording: Recording) -> Result<(), NodeError> {
    let Recording { folder, bag } = recording;
    bag.finish()
        .map(|_| ())
        .map_err(|error| NodeError::Broken(format!("{}: {error}", folder.display())))
}

/// Runs the recorder until it is told to stop; closes the recording.
///
/// # Errors
///
/// The session's recording cannot be made, a topic not opened; a recording
/// cannot be closed.
pub fn run(process: &ProcessContext) -> Result<(), NodeError> {
    let bus = &process.bus;
    let mut commands =
        bus.subscriber(topics::RECORDER_COMMAND, Depth::Queue(topics::EVENT_QUEUE))?;
    let mut statuses = bus.publisher(topics::RECORDER_STATUS)?;
    let mut forwarding = ForwardingLoop::new(process)?;
    let mut recording = match &process.session.bag {
        Some(bag) => Some(begin(
            process,
            &mut forwarding,
            folder(bag, process.generation),
        )?),
        None => None,
    };
    let mut status = RecorderStatusSample::initial(process.clock.now());
    let mut trouble = Text::<96>::EMPTY;
    let mut due = Time::INVALID;
    process.run(|wake| {
        let now = wake.now;
        while let Some(received) = commands.next(now) {
            let command = received.message;
            let outcome = match command.action {
                RecorderAction::START if recording.is_none() => {
                    match asked_for(command.label.as_str(), now) {
                        Some(folder) => begin(process, &mut forwarding, folder)
                            .map(|begun| recording = Some(begun))
                            .map_err(Text::display),
                        None => Err(Text::new(
                            "/recorder/command: the folder must be relative, without ..",
                        )),
                    }
                }
                RecorderAction::STOP => match recording.take() {
                    Some(ended) => {
                        forwarding.begin(Forwarder::default());
                        finish(ended).map_err(Text::display)
                    }
                    None => Ok(()),
                },
                _ => Ok(()),
            };
            trouble = outcome.err().unwrap_or_default();
            due = now;
        }
        forwarding.round(now, wake, |health, failed| {
            if health.lost > 0 {
                health.raise(Fault::RecordingLost, Level::WARN);
            }
            if failed > 0 || !trouble.is_empty() {
                health.raise(Fault::RecordingFailed, Level::ERROR);
                health.message = trouble;
            }
        });
        if let Some(recording) = &recording {
            status.folder = Text::new(&recording.folder.to_string_lossy());
            status.messages = forwarding.forwarded();
        }
        if now >= due {
            due = now.plus_nanos(STATUS_NANOS);
            status.stamp = now;
            status.recording = u8::from(recording.is_some());
            // What cannot be said now is said half a second later.
            let _ = statuses.publish(now, &status);
        }
    });
    let failed = forwarding.end(process.clock.now());
    recording.map_or(Ok(()), finish)?;
    match failed {
        0 => Ok(()),
        failed => Err(NodeError::Broken(format!(
            "{failed} messages could not be written into the recording: is the disk full?"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_below_the_sessions_own() {
        let now = Time::from_nanos(1_111_658_400_000_000_000);
        let named = |label| asked_for(label, now).map(|path| path.display().to_string());
        assert_eq!(named(""), Some("recordings/2005-03-24_10-00-00".to_owned()));
        assert_eq!(named("recordings/x"), Some("recordings/x".to_owned()));
        for label in ["/tmp/x", "../x", "a/../../x"] {
            assert_eq!(named(label), None, "{label}");
        }
    }
}

//! The recorder: writes every topic into a rosbag2 directory.

use std::path::{Path, PathBuf};

use ferntast_bus::{Bus, McapBus, SharedMemoryBus, mcap::BagOptions};
use ferntast_msgs::sample::{Fault, Level};

use crate::{
    carry::{Carrier, Carry, Stamp},
    pace,
    process::{ProcessError, Surroundings},
    relay::Relay,
};

/// The recorder looks this often \[ns\].
const PERIOD_NANOS: i64 = 10_000_000;

/// Opens a recording for writing, with what is needed to run it again.
///
/// # Errors
///
/// The folder exists, cannot be made, or the disk is full.
pub fn create(folder: &Path, options: BagOptions) -> Result<McapBus, ProcessError> {
    McapBus::create_with(folder, options).map_err(|error| ProcessError::Bag {
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

/// Runs the recorder until it is told to stop; closes the recording.
///
/// # Errors
///
/// The recording cannot be made, a topic not opened; the recording cannot be closed.
pub fn run(around: &Surroundings) -> Result<(), ProcessError> {
    let bag = around.context.bag.as_deref().ok_or(ProcessError::NoBag)?;
    let path = folder(bag, around.generation);
    let recording = create(
        &path,
        super::lockstep::bag_options(&around.context.loaded, "session"),
    )?;
    let to = Bus::Mcap(recording.clone());
    let mut carrier = Carrier::default();
    carrier.add_topics(&around.bus, &to, Stamp::Received, |_, delivery| {
        Carry::Every {
            queue: SharedMemoryBus::max_queue(delivery),
        }
    })?;
    let mut relay = Relay::new(around, PERIOD_NANOS)?;
    relay.begin(carrier);
    pace::run(around.clock, PERIOD_NANOS, around.stop, |wake| {
        relay.round(wake.now, wake, |health, failed| {
            if health.lost > 0 {
                health.raise(Fault::RecordingLost, Level::WARN);
            }
            if failed > 0 {
                health.raise(Fault::RecordingFailed, Level::ERROR);
            }
        });
    });
    relay.end(around.clock.now());
    recording
        .finish()
        .map(|_| ())
        .map_err(|error| ProcessError::Broken(format!("{}: {error}", path.display())))
}

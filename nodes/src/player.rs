//! The player: puts a recording back on the topics with its timing.

use std::sync::atomic::{AtomicBool, Ordering};

use ferntast_bus::{Bus, McapBus, mcap};
use ferntast_msgs::Time;

use crate::{
    carry::{Carrier, Carry, Stamp},
    pace,
    process::{PERIOD_NANOS, ProcessError, Surroundings},
    relay::Relay,
};

/// Opens `McapBus` readers on the recording with the lanes to play it.
fn open(
    around: &Surroundings,
    path: &std::path::Path,
) -> Result<(Carrier, Time, Time), ProcessError> {
    let bad = |reason: String| ProcessError::Bag {
        path: path.to_owned(),
        reason,
    };
    let info = mcap::info(path).map_err(|error| bad(error.to_string()))?;
    let (Some(start), Some(end)) = (info.start, info.end) else {
        return Err(bad("it holds no message".to_owned()));
    };
    let recording = McapBus::open(path).map_err(|error| bad(error.to_string()))?;
    let except = &around.context.play.except;
    let mut carrier = Carrier::default();
    carrier.add_topics(&Bus::Mcap(recording), &around.bus, Stamp::Round, |topic| {
        let recorded = info.topics.iter().any(|own| own.name == topic.name);
        if recorded && !except.iter().any(|name| name == topic.name) {
            Carry::Every { queue: 512 }
        } else {
            Carry::Not
        }
    })?;
    Ok((carrier, start, end))
}

/// Plays until the end of the recording, or until it is told to stop.
///
/// # Errors
///
/// The recording or a topic cannot be opened.
pub fn run(around: &Surroundings) -> Result<(), ProcessError> {
    let path = around.context.bag.as_deref().ok_or(ProcessError::NoBag)?;
    let rate = around.context.play.rate;
    let mut relay = Relay::new(around, PERIOD_NANOS)?;
    loop {
        let (carrier, start, end) = open(around, path)?;
        relay.begin(carrier);
        let begun = around.clock.now();
        let done = AtomicBool::new(false);
        pace::run_while(
            around.clock,
            PERIOD_NANOS,
            || !around.stop.load(Ordering::Relaxed) && !done.load(Ordering::Relaxed),
            |wake| {
                let at = start.plus_seconds(wake.now.seconds_since(begun) * rate);
                relay.round(at, wake, |_, _| {});
                done.store(at > end, Ordering::Relaxed);
            },
        );
        if around.stop.load(Ordering::Relaxed) || !around.context.play.repeat {
            return Ok(());
        }
    }
}

//! The player: puts a recording back on the topics with its timing.

use std::sync::atomic::Ordering;

use ferntast_bus::{Bus, McapBus, mcap};
use ferntast_msgs::{Time, sample::Faults, topics};

use crate::{
    carry::{Carrier, Carry, Stamp},
    node::{InputWatch, NodeHealth},
    pace,
    process::{PERIOD_NANOS, ProcessError, Surroundings},
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
    carrier.add_topics(
        &Bus::Mcap(recording),
        &around.bus,
        Stamp::Round,
        |topic, _| {
            let recorded = info.topics.iter().any(|own| own.name == topic);
            if recorded && !except.iter().any(|name| name == topic) {
                Carry::Every { queue: 512 }
            } else {
                Carry::Not
            }
        },
    )?;
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
    let mut meter = around.meter(PERIOD_NANOS, Faults::default());
    let mut diagnostics = around.bus.publisher(topics::DIAGNOSTICS)?;
    loop {
        let (mut carrier, start, end) = open(around, path)?;
        let begun = around.clock.now();
        let done = std::sync::atomic::AtomicBool::new(false);
        let mut watch = InputWatch::default();
        let mut failed = 0;
        pace::run_while(
            around.clock,
            PERIOD_NANOS,
            || !around.stop.load(Ordering::Relaxed) && !done.load(Ordering::Relaxed),
            |now, late, missed| {
                let at = start.plus_seconds(now.seconds_since(begun) * rate);
                failed += carrier.carry(at).failed;
                let mut health = NodeHealth {
                    lost: failed,
                    ..NodeHealth::default()
                };
                watch.note(|each| carrier.inputs(each), &mut health);
                if let Some(sample) = meter.step(now, late, missed, &health) {
                    let _ = diagnostics.publish(now, &sample);
                }
                done.store(at > end, Ordering::Relaxed);
            },
        );
        if around.stop.load(Ordering::Relaxed) || !around.context.play.repeat {
            return Ok(());
        }
    }
}

//! The player: puts a recording back on the topics with its timing. What the table of topics
//! has not it puts onto ROS 2 itself, as bytes ([`super::others`]).

use std::sync::atomic::{AtomicBool, Ordering};

use ferntast_bag::BagReader;
use ferntast_bus::{Bus, McapBus};
use ferntast_msgs::Time;

use super::{
    forwarder::{Forwarder, Forwarding, Stamp},
    forwarding_loop::ForwardingLoop,
    others::{self, Others, Sorted},
};
use crate::process::{NodeError, ProcessContext, periodic};

/// Name of the node.
pub const NAME: &str = "player";

/// How long who waits on ROS 2 has to find what the player publishes there itself \[ns\].
const DISCOVERY_NANOS: i64 = 1_000_000_000;

/// Opens `McapBus` readers on the recording with the routes to play it.
fn open(
    process: &ProcessContext,
    path: &std::path::Path,
    sorted: &Sorted,
) -> Result<(Forwarder, Time, Time), NodeError> {
    let bad = |reason: String| NodeError::Bag {
        path: path.to_owned(),
        reason,
    };
    let info = ferntast_bag::info(path).map_err(|error| bad(error.to_string()))?;
    let (Some(start), Some(end)) = (info.start, info.end) else {
        return Err(bad("it holds no message".to_owned()));
    };
    let recording = McapBus::open(path).map_err(|error| bad(error.to_string()))?;
    let except = &process.session.play.except;
    let recording = Bus::Mcap(recording);
    let joints = process.session.joints();
    let mut forwarder = Forwarder::default();
    forwarder.add_topics(&recording, &process.bus, Stamp::Round, &joints, |topic| {
        let recorded = info.topics.iter().any(|own| topic.name == *own.name);
        if recorded && !sorted.has(&topic.name) && !except.iter().any(|name| topic.name == **name) {
            Forwarding::Every { queue: 512 }
        } else {
            Forwarding::Not
        }
    })?;
    Ok((forwarder, start, end))
}

/// Plays until the end of the recording, or until it is told to stop.
///
/// # Errors
///
/// The recording or a topic cannot be opened.
pub fn run(process: &ProcessContext) -> Result<(), NodeError> {
    let path = process.session.bag.as_deref().ok_or(NodeError::NoBag)?;
    let rate = process.session.play.rate;
    let bad = |reason: String| NodeError::Bag {
        path: path.to_owned(),
        reason,
    };
    let bag = BagReader::open(path).map_err(|error| bad(error.to_string()))?;
    let section = &process.session.loaded.scenario.gateway;
    let except = &process.session.play.except;
    let sorted = others::sort(&bag, &process.session.joints(), except, section.middleware);
    let sorted = sorted.map_err(|error| bad(error.to_string()))?;
    let mut others = None;
    if !sorted.raw.is_empty() {
        let ros = others::open_ros(section)?;
        others = Some(Others::new(bag, &ros, &sorted.raw)?);
        process
            .clock
            .sleep_until(process.clock.now().plus_nanos(DISCOVERY_NANOS));
    }
    let mut forwarding = ForwardingLoop::new(process)?;
    loop {
        let (forwarder, start, end) = open(process, path, &sorted)?;
        forwarding.begin(forwarder);
        if let Some(others) = &mut others {
            others.begin();
        }
        let begun = process.clock.now();
        let done = AtomicBool::new(false);
        periodic::run_while(
            process.clock,
            process.period_nanos,
            || !process.stop.load(Ordering::Relaxed) && !done.load(Ordering::Relaxed),
            |wake| {
                let at = start.plus_seconds(wake.now.seconds_since(begun) * rate);
                if let Some(others) = &mut others {
                    let failed = others.publish(at);
                    forwarding.failed(failed);
                }
                forwarding.round(at, wake, |_, _| {});
                done.store(at > end, Ordering::Relaxed);
            },
        );
        if process.stop.load(Ordering::Relaxed) || !process.session.play.repeat {
            return Ok(());
        }
    }
}

//! A node as a process of its own.

use std::sync::{Arc, atomic::AtomicBool};

use ferntast_bus::{
    Bus, SharedMemoryBus, SharedMemoryConfig,
    frames::{FrameReceiver, FrameSender, LinkDirection, LinkEndpoint, ZenohLink, ZenohLinkConfig},
};
use ferntast_msgs::sample::{Fault, Faults};

use super::{Build, Make, NodeRow};
use crate::process::{Clock, NodeError, ProcessContext, SessionContext, periodic};

/// Runs the node of `row` until `stop` is set; `generation` says how often it
/// was started before.
///
/// # Errors
///
/// What keeps it from running.
pub fn run(
    row: &NodeRow,
    session: &SessionContext,
    generation: u32,
    stop: &AtomicBool,
) -> Result<(), NodeError> {
    let context = ProcessContext {
        session,
        bus: Bus::SharedMemory(SharedMemoryBus::open(&SharedMemoryConfig {
            session: session.session.clone(),
        })?),
        clock: session.clock(),
        stop,
        name: row.name,
        period_nanos: row.period_nanos,
        generation,
    };
    // Threads that are started later inherit the priority: frames of the link
    // are received and stamped no later than the loop runs.
    let standing = match row.realtime {
        true => request_realtime(row.name),
        false => Faults::default(),
    };
    let make = match row.make {
        Make::Service(run) => return run(&context),
        Make::Step { make, .. } => make,
    };
    let mut node = make(Build {
        session,
        bus: &context.bus,
        virtual_time: false,
        open_link: &mut |sends| open_link(session, context.clock, sends),
        meter: context.meter(standing),
    })?;
    context.run(|wake| node.tick(wake.now, wake.late_nanos, wake.missed));
    Ok(())
}

/// Asks for real-time priority; what stands against it is printed, and is a
/// standing fault.
fn request_realtime(name: &str) -> Faults {
    let mut standing = Faults::default();
    if let Err(error) = periodic::request_realtime() {
        standing.set(Fault::NoRealtime);
        eprintln!(
            "node {name}: no real-time priority ({error}); it runs on without, wake-ups may be late. \
             `ferntast doctor` says how to get it"
        );
    }
    standing
}

/// The arm's end listens, the operator's end connects.
fn open_link(
    session: &SessionContext,
    clock: Clock,
    sends: LinkDirection,
) -> Result<(FrameSender, FrameReceiver), NodeError> {
    let endpoint = session.loaded.scenario.link.endpoint.clone();
    let link = ZenohLink::open(ZenohLinkConfig {
        session: session.session.clone(),
        endpoint: match sends {
            LinkDirection::Forward => LinkEndpoint::Connect(endpoint),
            LinkDirection::Back => LinkEndpoint::Listen(endpoint),
        },
        sends,
        clock: Arc::new(move || clock.now()),
    })?;
    Ok((link.sender, link.receiver))
}

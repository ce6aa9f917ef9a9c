//! A node as a process of its own.

use std::sync::{Arc, atomic::AtomicBool};

use ferntast_bus::{
    Bus, SharedMemoryBus, SharedMemoryConfig,
    frames::{LinkDirection, LinkEndpoint, ZenohLink, ZenohLinkConfig, check_endpoint},
};
use ferntast_msgs::sample::{Fault, Faults};

use super::{Build, Make, NodeRow};
use crate::{
    link::LinkWire,
    process::{Clock, NodeError, ProcessContext, SessionContext, link_end::link_end},
};

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
    // Before all else: whoever is needed is not to wait for its turn while it
    // starts. Threads that are started later inherit the priority: frames of the
    // link are received and stamped no later than the loop runs.
    let standing = take_priority(row);
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

/// Takes the row's priority; what stands against real time is printed, and is a
/// standing fault. A nice value that is refused changes nothing but the order
/// under overload.
fn take_priority(row: &NodeRow) -> Faults {
    let mut standing = Faults::default();
    if let Err(error) = row.priority.take()
        && row.priority.is_real_time()
    {
        let name = row.name;
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
) -> Result<LinkWire, NodeError> {
    let endpoint = session.loaded.scenario.link.endpoint.clone();
    check_endpoint(&endpoint)?;
    let end = link_end(session, sends)?;
    let link = ZenohLink::open(ZenohLinkConfig {
        session: session.session.clone(),
        endpoint: match sends {
            LinkDirection::Forward => LinkEndpoint::Connect(endpoint),
            LinkDirection::Back => LinkEndpoint::Listen(endpoint),
        },
        sends,
        tls: Some(end.tls),
        clock: Arc::new(move || clock.now()),
    })?;
    Ok(LinkWire {
        sender: link.sender,
        receiver: link.receiver,
        secure: end.secure,
        door: link.door,
    })
}

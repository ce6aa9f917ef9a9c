//! Shows every topic to Foxglove and Lichtblick over a WebSocket.
//!
//! A process of its own, as the console: no 1 kHz loop waits for those who watch.

use ferntast_bus::{Bus, FoxgloveBus, FoxgloveConfig};

use super::{
    forwarder::{Forwarder, Stamp},
    forwarding_loop::ForwardingLoop,
    gateway::goes_out,
};
use crate::process::{NodeError, ProcessContext};

/// Serves the WebSocket until it is told to stop.
///
/// # Errors
///
/// No address; one that is taken or beyond loopback; a topic that cannot be opened.
pub fn run(process: &ProcessContext) -> Result<(), NodeError> {
    let config = FoxgloveConfig {
        address: process.session.foxglove.ok_or(NodeError::NoFoxglove)?,
        name: format!("ferntast {}", process.session.session),
    };
    let foxglove = FoxgloveBus::open(&config)?;
    eprintln!(
        "foxglove: ws://{} (in Foxglove or Lichtblick: Open connection; layout: config/layouts/)",
        foxglove.address()
    );
    let section = &process.session.loaded.scenario.gateway;
    let mut forwarding = ForwardingLoop::new(process)?;
    let mut forwarder = Forwarder::default();
    let to = Bus::Foxglove(foxglove);
    let joints = process.session.joints();
    forwarder.add_topics(&process.bus, &to, Stamp::Received, &joints, |topic| {
        goes_out(topic, section)
    })?;
    forwarding.begin(forwarder);
    process.run(|wake| {
        forwarding.round(wake.now, wake, |_, _| {});
    });
    Ok(())
}

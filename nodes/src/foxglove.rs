//! Shows every topic to Foxglove and Lichtblick over a WebSocket.
//!
//! A process of its own, as the console: no 1 kHz loop waits for those who watch.

use ferntast_bus::{Bus, FoxgloveBus, FoxgloveConfig};

use crate::{
    carry::{Carrier, Stamp},
    gateway::goes_out,
    pace,
    process::{PERIOD_NANOS, ProcessError, Surroundings},
    relay::Relay,
};

/// Serves the WebSocket until it is told to stop.
///
/// # Errors
///
/// No address; one that is taken or beyond loopback; a topic that cannot be opened.
pub fn run(around: &Surroundings) -> Result<(), ProcessError> {
    let config = FoxgloveConfig {
        address: around.context.foxglove.ok_or(ProcessError::NoFoxglove)?,
        name: format!("ferntast {}", around.context.session),
    };
    let foxglove = FoxgloveBus::open(&config)?;
    eprintln!(
        "foxglove: ws://{} (in Foxglove or Lichtblick: Open connection; layout: config/layouts/)",
        foxglove.address()
    );
    let section = &around.context.loaded.scenario.gateway;
    let mut relay = Relay::new(around, PERIOD_NANOS)?;
    let mut carrier = Carrier::default();
    let to = Bus::Foxglove(foxglove);
    carrier.add_topics(&around.bus, &to, Stamp::Received, |topic| {
        goes_out(topic, section)
    })?;
    relay.begin(carrier);
    pace::run(around.clock, PERIOD_NANOS, around.stop, |wake| {
        relay.round(wake.now, wake, |_, _| {});
    });
    Ok(())
}

//! What a node's process works with.

use std::sync::atomic::AtomicBool;

use ferntast_bus::Bus;
use ferntast_msgs::sample::Faults;

use super::{
    Clock, SessionContext,
    periodic::{self, Wake},
};
use crate::node::HealthMeter;

/// What a node's process works with.
pub struct ProcessContext<'a> {
    /// The session.
    pub session: &'a SessionContext,
    /// The host's bus.
    pub bus: Bus,
    /// The session's clock.
    pub clock: Clock,
    /// Set when it is time to stop.
    pub stop: &'a AtomicBool,
    /// The node.
    pub name: &'static str,
    /// From one step of the node to the next \[ns\].
    pub period_nanos: i64,
    /// How often it was started before.
    pub generation: u32,
}

impl ProcessContext<'_> {
    /// A meter for the node's loop; `standing` holds for as long as it runs.
    pub fn meter(&self, standing: Faults) -> HealthMeter {
        HealthMeter::new(self.name, std::process::id(), self.period_nanos, standing)
    }

    /// Calls `tick` every period of the node until it is time to stop.
    pub fn run(&self, tick: impl FnMut(Wake)) {
        periodic::run(self.clock, self.period_nanos, self.stop, tick);
    }
}

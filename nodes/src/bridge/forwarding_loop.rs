//! What gateway, recorder and player are: a forwarder whose rounds are reported on
//! `/diagnostics`.

use ferntast_bus::{CreateError, Publisher};
use ferntast_msgs::{
    Time,
    sample::{Faults, HealthSample},
    topics,
};

use super::forwarder::Forwarder;
use crate::{
    node::{HealthMeter, InputWatch, NodeHealth},
    process::{ProcessContext, periodic::Wake},
};

/// A forwarder, and how it is doing.
pub struct ForwardingLoop {
    forwarder: Forwarder,
    watch: InputWatch,
    /// Messages that went over.
    forwarded: u64,
    /// Messages that could not be sent on.
    failed: u64,
    meter: HealthMeter,
    diagnostics: Publisher<HealthSample>,
}

impl ForwardingLoop {
    /// A loop that forwards nothing yet.
    ///
    /// # Errors
    ///
    /// `/diagnostics` cannot be opened.
    pub fn new(process: &ProcessContext) -> Result<ForwardingLoop, CreateError> {
        Ok(ForwardingLoop {
            forwarder: Forwarder::default(),
            watch: InputWatch::default(),
            forwarded: 0,
            failed: 0,
            meter: process.meter(Faults::default()),
            diagnostics: process.bus.publisher(topics::DIAGNOSTICS)?,
        })
    }

    /// Forwards by `forwarder` from now on, and counts from zero.
    pub fn begin(&mut self, forwarder: Forwarder) {
        self.forwarder = forwarder;
        self.watch = InputWatch::default();
        self.forwarded = 0;
        self.failed = 0;
    }

    /// Messages that went over since then.
    pub fn forwarded(&self) -> u64 {
        self.forwarded
    }

    /// So many messages more could not be sent on, by another way.
    pub fn failed(&mut self, messages: u64) {
        self.failed += messages;
    }

    /// One round: forwards what is visible at `at`, and reports how it went.
    /// `judge` may raise faults; it is given the health and the number of
    /// messages that could not be sent on.
    pub fn round(&mut self, at: Time, wake: Wake, judge: impl FnOnce(&mut NodeHealth, u64)) {
        let forwarded = self.forwarder.forward(at);
        self.forwarded += forwarded.messages;
        self.failed += forwarded.failed;
        let mut health = NodeHealth {
            lost: self.failed,
            ..NodeHealth::default()
        };
        // What was refused is told when the health is, and counted until then.
        if self.meter.is_due(wake.now) {
            self.watch
                .note(|each| self.forwarder.inputs(each), &mut health);
        }
        judge(&mut health, self.failed);
        let sample = self
            .meter
            .step(wake.now, wake.late_nanos, wake.missed, &health);
        if let Some(sample) = sample {
            // What cannot be said now is said a tenth of a second later.
            let _ = self.diagnostics.publish(wake.now, &sample);
        }
    }

    /// Forwards what is visible at `now`, for the last time, and closes both
    /// sides. Gives the number of messages that could not be sent on.
    pub fn end(mut self, now: Time) -> u64 {
        self.failed + self.forwarder.forward(now).failed
    }
}

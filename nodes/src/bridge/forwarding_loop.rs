//! What gateway, recorder and player are: a carrier whose rounds are told on
//! `/diagnostics`.

use ferntast_bus::{CreateError, Publisher};
use ferntast_msgs::{
    Time,
    sample::{Faults, HealthSample},
    topics,
};

use super::forwarder::Carrier;
use crate::{
    node::{HealthMeter, InputWatch, NodeHealth},
    process::{ProcessContext, periodic::Wake},
};

/// A carrier, and how it is doing.
pub struct Relay {
    carrier: Carrier,
    watch: InputWatch,
    /// Messages that went over.
    carried: u64,
    /// Messages that could not be sent on.
    failed: u64,
    meter: HealthMeter,
    diagnostics: Publisher<HealthSample>,
}

impl Relay {
    /// A relay that carries nothing yet.
    ///
    /// # Errors
    ///
    /// `/diagnostics` cannot be opened.
    pub fn new(process: &ProcessContext) -> Result<Relay, CreateError> {
        Ok(Relay {
            carrier: Carrier::default(),
            watch: InputWatch::default(),
            carried: 0,
            failed: 0,
            meter: process.meter(Faults::default()),
            diagnostics: process.bus.publisher(topics::DIAGNOSTICS)?,
        })
    }

    /// Carries by `carrier` from now on, and counts anew.
    pub fn begin(&mut self, carrier: Carrier) {
        self.carrier = carrier;
        self.watch = InputWatch::default();
        self.carried = 0;
        self.failed = 0;
    }

    /// Messages that went over since it began to carry what it carries.
    pub fn carried(&self) -> u64 {
        self.carried
    }

    /// One round: carries what is visible at `at`, and tells how it went.
    /// `judge` may raise faults; it is given the health and the number of
    /// messages that could not be sent on.
    pub fn round(&mut self, at: Time, wake: Wake, judge: impl FnOnce(&mut NodeHealth, u64)) {
        let carried = self.carrier.carry(at);
        self.carried += carried.messages;
        self.failed += carried.failed;
        let mut health = NodeHealth {
            lost: self.failed,
            ..NodeHealth::default()
        };
        self.watch
            .note(|each| self.carrier.inputs(each), &mut health);
        judge(&mut health, self.failed);
        let sample = self
            .meter
            .step(wake.now, wake.late_nanos, wake.missed, &health);
        if let Some(sample) = sample {
            // What cannot be said now is said a tenth of a second later.
            let _ = self.diagnostics.publish(wake.now, &sample);
        }
    }

    /// Carries what is visible at `now`, for the last time, and closes both sides.
    pub fn end(mut self, now: Time) {
        self.carrier.carry(now);
    }
}

//! An arm that is not measured is not moved.

use super::{
    super::{facts::Facts, log::Log, seen::Seen},
    Invariant,
};

/// Beyond the watchdog, for the step in which it is seen \[steps\].
const BEYOND: i64 = 3;

/// No longer than the servo's watchdog allows after the last valid measurement the
/// drives have no torque, and the servo is not enabled.
#[derive(Default)]
pub struct MeasurementWatched {
    last: i64,
}

impl Invariant for MeasurementWatched {
    fn name(&self) -> &'static str {
        "measurement_watched"
    }

    fn step(&mut self, seen: &Seen, _: &Log, facts: &Facts) -> Option<String> {
        if seen
            .measured
            .is_some_and(|own| own.iter().all(|value| value.is_finite()))
        {
            self.last = seen.tick;
        }
        let silent = seen.tick - self.last;
        // A servo that was held up is patient for the time that it was.
        let running = seen.tick - seen.arm_side_stalled > 6;
        let torque = seen.torque?;
        let driven = torque.iter().any(|torque| *torque != 0.0);
        (silent > facts.measurement_watchdog + BEYOND && running && driven)
            .then(|| format!("{torque:.2?} Nm {silent} ms after the last valid measurement"))
    }
}

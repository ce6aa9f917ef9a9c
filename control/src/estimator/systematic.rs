//! What is wrong with a force all the time, and so does not average out: zero and
//! gain of each torque sensor, and the contour's turn.
//!
//! Each is a standard uncertainty times the force's derivative with respect to it;
//! they are independent and add up in squares (GUM, JCGM 100:2008, equation (10)).

use ferntast_model::{MAX_JOINTS, parameters};

parameters! {
    /// How well the parameters behind a force are known: standard uncertainties.
    /// None is taken into account where nothing is said.
    #[derive(Copy)]
    pub struct Uncertainty {
        /// Zero of a torque sensor, before it was zeroed on line \[Nm\].
        pub torque_zero: f64 [0.0..=10.0, "Nm"] = 0.0,
        /// Gain of a torque sensor, as a share of it \[-\].
        pub torque_gain: f64 [0.0..=0.5, "-"] = 0.0,
        /// Direction of an edge of the contour \[rad\].
        pub contour_turn: f64 [0.0..=0.5, "rad"] = 0.0,
    }
}

/// How many errors there are at most: a zero and a gain of each joint's sensor, one turn.
pub(super) const ERRORS: usize = 2 * MAX_JOINTS + 1;

/// Errors of F_N and of F_T \[N\], one standard uncertainty each.
pub(super) type SplitErrors = [[f64; 2]; ERRORS];

/// Errors of a force on the tip \[N\] by the torque sensors.
#[derive(Clone, Copy, Debug)]
pub(super) struct SensorErrors<V> {
    errors: [V; ERRORS - 1],
    count: usize,
}

impl<V: Copy> SensorErrors<V> {
    /// What standard uncertainties `zeros` \[Nm\] and `gain` \[-\] of the torque sensors
    /// make of the force, where the contact makes `torque` \[Nm\]; `force` is what an error of
    /// one joint's torque alone makes. Slowly sliding in weightlessness the sensors feel the
    /// contact and nothing else, so that its torque stands for theirs.
    pub(super) fn new(
        torque: &[f64],
        zeros: &[f64],
        gain: f64,
        none: V,
        force: impl Fn(usize, f64) -> V,
    ) -> Self {
        let mut errors = [none; ERRORS - 1];
        let joints = torque.len().min(zeros.len());
        let zeros = (0..joints).map(|joint| force(joint, zeros[joint]));
        let gains = (0..joints).map(|joint| force(joint, gain * torque[joint]));
        for (place, error) in errors.iter_mut().zip(zeros.chain(gains)) {
            *place = error;
        }
        Self {
            errors,
            count: 2 * joints,
        }
    }

    /// The same of F_N and F_T: what `split` makes of an error of the force. `turned` is what
    /// a surface that is turned adds.
    pub(super) fn split(&self, split: impl Fn(&V) -> [f64; 2], turned: [f64; 2]) -> SplitErrors {
        let mut errors = [[0.0; 2]; ERRORS];
        let each = self.errors.iter().take(self.count).map(split);
        for (place, error) in errors.iter_mut().zip(each.chain([turned])) {
            *place = error;
        }
        errors
    }
}

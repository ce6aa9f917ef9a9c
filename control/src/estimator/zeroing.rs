//! The torque sensors' zeros, found on line while the tip is free.
//!
//! Free of contact equation (5) leaves zero: what it does leave, −τ_zero, is the
//! zero error of the sensors seen in the contact's torque, as the form in use has
//! it. Its mean is taken off, in contact as it was found before.
//!
//! A contact must not be taken for a zero. So nothing is learned near a feature of
//! the contour; nothing, once a zero is known, from a force that would count as
//! contact (`contact_off`) on whatever it is that the tip runs into; and never more
//! than [`LARGEST_SHARE`] of a sensor's range in all. A force that comes to
//! `contact_off` within a time t therefore moves the zero by t/`zeroing_time` of
//! that force's torque at most. What stays below `contact_off` for long, away from
//! the contour, cannot be told from a zero, and is learned within that largest share.

use super::EstimatorParameters;
use ferntast_model::Joints;

/// Largest zero, as a share of the sensor's range \[-\].
pub(super) const LARGEST_SHARE: f64 = 0.025;

/// How far the tip stays away from what it may touch, in `contact_distance`s: as
/// much again as makes a contact is left for a contour that is not where it is
/// believed to be.
pub(super) const CLEARANCE: f64 = 2.0;

/// The zeros of the torque sensors, as torques of the contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Zeroing {
    /// Largest zero of each joint \[Nm\].
    largest: Joints<f64>,
    /// Mean of the contact's torque without contact \[Nm\].
    zero: Joints<f64>,
    /// Mean square of what it is off that mean \[Nm²\].
    scatter: Joints<f64>,
    /// Time that went into the mean, up to its memory \[s\].
    learned: f64,
}

impl Zeroing {
    /// Nothing is known of sensors of these ranges \[Nm\].
    pub(super) fn new(ranges: Joints<f64>) -> Self {
        let none = ranges.map(|_| 0.0);
        Self {
            largest: ranges.map(|range| range * LARGEST_SHARE),
            zero: none,
            scatter: none,
            learned: 0.0,
        }
    }

    /// What is to be taken off the contact's torque \[Nm\].
    pub(super) fn zero(&self) -> Joints<f64> {
        self.zero
    }

    /// Standard error of each zero \[Nm\], for samples alike within `alike` \[s\]:
    /// `unlearned` \[Nm\] before anything was learned, and no more than that after.
    pub(super) fn standard_error(&self, alike: f64, unlearned: f64) -> Joints<f64> {
        let independent = self.learned / alike;
        if independent < 2.0 {
            return self.zero.map(|_| unlearned);
        }
        self.scatter
            .map(|square| (square / (independent - 1.0)).sqrt().min(unlearned))
    }

    /// Learns from `torque` \[Nm\], the contact's as the form in use has it, over `dt`
    /// \[s\], with the tip `free`: further than [`CLEARANCE`] from all that it may touch.
    /// `force` \[N\] is how large what is left of it at the tip is with the zero taken off.
    pub(super) fn learn(
        &mut self,
        parameters: &EstimatorParameters,
        dt: f64,
        free: bool,
        torque: &Joints<f64>,
        force: f64,
    ) {
        let memory = parameters.zeroing_time;
        if memory <= 0.0 || !free {
            return;
        }
        let plausible = (0..torque.len()).all(|own| torque[own].abs() <= self.largest[own]);
        let quiet = self.learned < memory || force < parameters.contact_off;
        if !(plausible && quiet) {
            return;
        }
        self.learned = (self.learned + dt).min(memory);
        // The plain mean at first, then one that forgets.
        let share = (dt / self.learned).min(1.0);
        for (joint, torque) in torque.iter().enumerate() {
            let off = torque - self.zero[joint];
            self.zero[joint] += off * share;
            self.scatter[joint] += (off * off - self.scatter[joint]) * share;
        }
    }
}

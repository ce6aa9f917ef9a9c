//! What comes up suddenly although nothing is touched.

use ferntast_model::{Joints, MAX_JOINTS};
use nalgebra::{SMatrix, SVector};

/// Over which time of motion it is averaged [s].
const LONG: f64 = 1.0;
/// After which time it is known [s].
const KNOWN: f64 = 0.2;

/// Torques of all joints that an arm may have.
type Padded = SVector<f64, MAX_JOINTS>;

/// Covariance of the torques that come up suddenly where nothing is touched: noise of the sensors,
/// which inertias make large where it is differentiated, and what the links' model has wrong.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    /// [N² m²]
    covariance: SMatrix<f64, MAX_JOINTS, MAX_JOINTS>,
    /// For how long it was seen, as far as that is not enough [s].
    seen: f64,
    /// Standard deviation that every joint has [Nm].
    least: f64,
}

impl Noise {
    /// Of which nothing is known but that every joint has `least` \[Nm\].
    pub(super) fn new(least: f64) -> Noise {
        Noise {
            covariance: SMatrix::zeros(),
            seen: 0.0,
            least,
        }
    }

    /// Whether `sudden` torques \[Nm\], which came up `passed` \[s\] after the last ones, are beyond
    /// it by more than `deviations`; takes them in. An arm at rest has less of it than one
    /// that is `moving`: it tells what there is at least, and nothing beyond.
    ///
    /// By their distance in standard deviations, of all joints together (Mahalanobis), whose
    /// square is the number of joints on average where nothing is touched. What is beyond counts
    /// as what is just within: a contact that begins hardly makes the next one look like noise,
    /// and an arm that got noisier is known as such within a moment.
    pub(super) fn is_beyond(
        &mut self,
        deviations: f64,
        sudden: &Joints<f64>,
        passed: f64,
        moving: bool,
    ) -> bool {
        let limit = squared_limit(deviations, sudden);
        let sudden = padded(sudden);
        if self.seen < KNOWN {
            self.seen += passed;
            self.take_in(&sudden, passed / self.seen, 1.0);
            return false;
        }
        if !moving {
            return false;
        }
        let distance = self.squared_distance(&sudden, None);
        self.take_in(&sudden, passed / LONG, (limit / distance).min(1.0));
        distance > limit
    }

    /// The same of an arm that something presses with `pressed` \[Nm\] already: whether another
    /// thing comes up across that. Nothing is taken in.
    pub(super) fn is_beyond_across(
        &self,
        deviations: f64,
        sudden: &Joints<f64>,
        pressed: &Joints<f64>,
    ) -> bool {
        let limit = squared_limit(deviations, sudden);
        let across = Some(padded(pressed));
        self.seen >= KNOWN && self.squared_distance(&padded(sudden), across.as_ref()) > limit
    }

    fn take_in(&mut self, sudden: &Padded, share: f64, counts: f64) {
        let squares = sudden * sudden.transpose() * counts;
        self.covariance += (squares - self.covariance) * share.min(1.0);
    }

    /// Of `sudden`, or of what of it is across `pressed`.
    fn squared_distance(&self, sudden: &Padded, pressed: Option<&Padded>) -> f64 {
        let least = SMatrix::identity() * (self.least * self.least);
        // Positive definite, as `least` is, unless something is not a number.
        let Some(factor) = (self.covariance + least).cholesky() else {
            return 0.0;
        };
        let weighed = factor.solve(sudden);
        let whole = sudden.dot(&weighed);
        let along = pressed.map_or(0.0, |pressed| {
            let size = pressed.dot(&factor.solve(pressed));
            pressed.dot(&weighed).powi(2) / size.max(f64::MIN_POSITIVE)
        });
        whole - along
    }
}

/// Squared distance of `deviations` beyond what there is on average.
fn squared_limit(deviations: f64, sudden: &Joints<f64>) -> f64 {
    deviations * deviations + sudden.len() as f64
}

/// The torques of an arm with fewer joints, and zeros.
fn padded(torques: &Joints<f64>) -> Padded {
    Padded::from_fn(|joint, _| torques.get(joint).copied().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: f64 = 1e-3;

    /// Torques of two joints, through all combinations of signs, with covariance
    /// [[1, 0.9], [0.9, 1]] Nm² times `size`².
    fn torques(size: f64) -> impl Iterator<Item = Joints<f64>> {
        let root = 0.9_f64.sqrt();
        let own = 0.1_f64.sqrt();
        (0_u32..).map(move |k| {
            let sign = |bit: u32| if k >> bit & 1 == 0 { size } else { -size };
            let both = root * sign(0);
            [both + own * sign(1), both + own * sign(2)].into()
        })
    }

    fn learnt(size: f64) -> Noise {
        let mut noise = Noise::new(1e-3);
        for torque in torques(size).take(1000) {
            assert!(!noise.is_beyond(5.0, &torque, TICK, true));
        }
        noise
    }

    #[test]
    fn distances_are_those_of_the_covariance() {
        let noise = learnt(1.0);
        let squared = |first: f64, second: f64| {
            let mut padded = SVector::zeros();
            (padded[0], padded[1]) = (first, second);
            noise.squared_distance(&padded, None)
        };
        // Along the axes of the ellipse: variances of 1.9 and 0.1 Nm².
        assert!((squared(1.0, 1.0) / (2.0 / 1.9) - 1.0).abs() < 0.05);
        assert!((squared(1.0, -1.0) / (2.0 / 0.1) - 1.0).abs() < 0.05);
    }

    #[test]
    fn what_one_joint_cannot_tell_both_can() {
        let noise = learnt(1.0);
        let beyond = |torque: [f64; 2]| noise.clone().is_beyond(5.0, &torque.into(), TICK, true);
        assert!(!beyond([2.0, 2.0]));
        assert!(beyond([2.0, -2.0]));
    }

    #[test]
    fn of_an_arm_that_is_pressed_only_what_comes_across_counts() {
        let noise = learnt(1.0);
        let pressed = [20.0, 0.0].into();
        let beyond = |torque: [f64; 2]| noise.is_beyond_across(5.0, &torque.into(), &pressed);
        assert!(!beyond([50.0, 0.0]) && !beyond([-50.0, 0.0]));
        // The other joint has a variance of 1 Nm² then.
        assert!(beyond([0.0, 5.5]) && beyond([30.0, -5.5]));
        assert!(!beyond([0.0, 5.0]));
    }

    #[test]
    fn rest_hides_nothing_of_what_motion_showed() {
        let mut noise = learnt(1.0);
        for _ in 0..10_000 {
            assert!(!noise.is_beyond(5.0, &[1e-3, 0.0].into(), TICK, false));
        }
        assert!(!noise.is_beyond(5.0, &[1.0, 1.0].into(), TICK, true));
    }

    #[test]
    fn nothing_is_beyond_what_is_not_known() {
        let mut noise = Noise::new(1e-3);
        assert!(!noise.is_beyond(5.0, &[100.0, 0.0].into(), TICK, true));
    }

    #[test]
    fn a_contact_hardly_counts_and_an_arm_that_got_noisier_is_known_soon() {
        let mut noise = learnt(1.0);
        let contact = [8.0, -8.0].into();
        for _ in 0..10 {
            assert!(noise.is_beyond(5.0, &contact, TICK, true));
        }
        let mut noise = learnt(1.0);
        let beyond = torques(10.0)
            .take(2000)
            .map(|own| noise.is_beyond(5.0, &own, TICK, true));
        let last = beyond.enumerate().filter(|(_, own)| *own).last();
        let last = last.map_or(0, |(k, _)| k);
        assert!((10..=500).contains(&last), "{last} ms");
    }
}

//! Limits of the force on the hand.

use crate::planted::{Planted, Rule};

/// How long a force on a hand counts \[s\], wherever it passes: what came back over the link and
/// is reflected, what the master gave and a device or an arm renders. One that is older is none.
pub const FORCE_LIFE: f64 = 0.025;

/// A force, and whether it was limited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitedForce {
    /// \[N\]
    pub force: [f64; 3],
    /// Its magnitude or its rate would have been more.
    pub limited: bool,
}

/// Limits magnitude and rate of a force; keeps its direction.
#[derive(Clone, Copy, Debug)]
pub struct ForceLimiter {
    magnitude: f64,
    rate: f64,
    force: [f64; 3],
    pub(super) planted: Planted,
}

impl ForceLimiter {
    /// At most `magnitude` \[N\], changing by at most `rate` \[N/s\].
    pub fn new(magnitude: f64, rate: f64) -> Self {
        ForceLimiter {
            magnitude,
            rate,
            force: [0.0; 3],
            planted: Planted::NONE,
        }
    }

    /// The force nearest to `wanted` \[N\] that is allowed after `dt` \[s\].
    /// A force that is not finite counts as none.
    pub fn step(&mut self, dt: f64, wanted: [f64; 3]) -> LimitedForce {
        let finite = wanted.iter().all(|value| value.is_finite());
        let wanted = if finite { wanted } else { [0.0; 3] };
        let magnitude = match self.planted.lacks(Rule::HandForceLimit) {
            true => f64::INFINITY,
            false => self.magnitude,
        };
        let (bounded, too_strong) = shorten(wanted, magnitude);
        let change: [f64; 3] = std::array::from_fn(|axis| bounded[axis] - self.force[axis]);
        let rate = match self.planted.lacks(Rule::HandForceRate) {
            true => f64::INFINITY,
            false => self.rate * dt,
        };
        let (change, too_fast) = shorten(change, rate);
        self.force = std::array::from_fn(|axis| self.force[axis] + change[axis]);
        LimitedForce {
            force: self.force,
            limited: too_strong || too_fast || !finite,
        }
    }

    /// No force, at once: letting go is safe.
    pub fn stop(&mut self) -> LimitedForce {
        self.force = [0.0; 3];
        LimitedForce::default()
    }
}

fn shorten(vector: [f64; 3], limit: f64) -> ([f64; 3], bool) {
    let [x, y, z] = vector;
    let length = x.hypot(y).hypot(z);
    if length <= limit {
        return (vector, false);
    }
    // Divided before it is multiplied: no overflow.
    (vector.map(|value| value / length * limit), true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn limits_hold_whatever_is_wanted(
            wanted in proptest::collection::vec(proptest::array::uniform3(any::<f64>()), 1..50),
        ) {
            let mut limiter = ForceLimiter::new(10.0, 1000.0);
            let mut before = [0.0; 3];
            for force in wanted {
                let now = limiter.step(1e-3, force).force;
                let norm = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
                prop_assert!(norm(now) <= 10.0 + 1e-9);
                let change = std::array::from_fn(|axis| now[axis] - before[axis]);
                prop_assert!(norm(change) <= 1.0 + 1e-9);
                before = now;
            }
        }
    }

    #[test]
    fn a_force_within_limits_passes_unchanged() {
        let mut limiter = ForceLimiter::new(10.0, 1000.0);
        let mut force = LimitedForce::default();
        for _ in 0..10 {
            force = limiter.step(1e-3, [3.0, -4.0, 0.0]);
        }
        assert!((force.force[0] - 3.0).abs() < 1e-12 && (force.force[1] + 4.0).abs() < 1e-12);
        assert!(!force.limited);
        for _ in 0..100 {
            force = limiter.step(1e-3, [30.0, -40.0, 0.0]);
        }
        assert!((force.force[0] - 6.0).abs() < 1e-9 && (force.force[1] + 8.0).abs() < 1e-9);
        assert!(force.limited);
    }
}

//! Letting go of what a paused joint presses against.
//!
//! A hold keeps the motor where it is, and the friction of the gear keeps what the
//! joint presses with, for good. So right after the pause, and for half a second, and once
//! more where the arm is enabled but has no command yet, the
//! place of the hold gives way, against the torque that the joint carries beyond its own
//! weight, while that is not small (an arm that was stopped rings, so that it may be for a
//! moment), and for a little way at most: a sensor that is wrong moves the arm no further. Giving way in the direction in which the surroundings push puts no
//! energy into them.

use super::{Setpoint, config::ReleaseConfig};

/// So long after the pause it is over [s].
const LASTS: f64 = 0.5;

/// The way out of a contact, of one joint.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Release {
    /// Way that may still be gone \[rad\].
    left: f64,
    /// Time in which it may \[s\].
    time: f64,
}

impl Release {
    /// Begins, at a pause.
    pub fn begin(config: &ReleaseConfig) -> Release {
        Release {
            left: config.distance,
            time: LASTS,
        }
    }

    /// One step of `dt` \[s\] from the hold at `hold` \[rad\] under the torque `external`
    /// \[Nm\] that the joint carries beyond its own weight: where to go, if it gives way.
    pub fn step(
        &mut self,
        config: &ReleaseConfig,
        dt: f64,
        hold: f64,
        external: f64,
    ) -> Option<Setpoint> {
        // A torque that is not finite releases nothing.
        let presses = external.abs() > config.torque;
        self.time -= dt;
        if self.left <= 0.0 || self.time <= 0.0 || !presses {
            return None;
        }
        let way = (config.speed * dt).min(self.left);
        self.left -= way;
        Some(Setpoint {
            position: hold - way.copysign(external),
            velocity: -config.speed.copysign(external),
            acceleration: 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring that the joint leans on with `torque` at first; where it ends.
    fn end(config: &ReleaseConfig, torque: f64, stiffness: f64) -> (f64, f64) {
        let mut release = Release::begin(config);
        let (mut hold, mut external) = (0.0, torque);
        for _ in 0..2000 {
            if let Some(setpoint) = release.step(config, 1e-3, hold, external) {
                hold = setpoint.position;
                external = torque + stiffness * hold;
            }
        }
        (hold, external)
    }

    #[test]
    fn it_gives_way_until_little_is_left_and_no_further_than_allowed() {
        let config = ReleaseConfig::default();
        for torque in [10.0, -10.0] {
            let (hold, external) = end(&config, torque, 2000.0);
            assert!(external.abs() <= config.torque, "{external} Nm");
            assert!(
                external * torque > 0.0,
                "it pushes the other way: {external} Nm"
            );
            // Down the spring of 2000 Nm/rad, to within a step.
            let way = (10.0 - config.torque) / 2000.0;
            assert!((hold.abs() - way).abs() < 0.16e-3, "{hold} rad");
            // A sensor that says the same wherever the joint is.
            let (hold, _) = end(&config, torque, 0.0);
            assert!((hold.abs() - config.distance).abs() < 1e-9, "{hold} rad");
        }
        // Not after a while.
        let mut release = Release::begin(&config);
        assert!((0..500).all(|_| release.step(&config, 1e-3, 0.0, 0.0).is_none()));
        assert_eq!(release.step(&config, 1e-3, 0.0, 10.0), None);
        // A moment without torque ends nothing.
        let mut release = Release::begin(&config);
        assert!(release.step(&config, 1e-3, 0.0, 10.0).is_some());
        assert!(release.step(&config, 1e-3, 0.0, 0.0).is_none());
        assert!(release.step(&config, 1e-3, 0.0, 10.0).is_some());
        assert_eq!(end(&config, 0.9 * config.torque, 0.0).0, 0.0);
        assert_eq!(end(&config, f64::NAN, 0.0).0, 0.0);
    }
}

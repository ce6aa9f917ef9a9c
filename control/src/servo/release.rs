//! Letting go of what a paused joint presses against.
//!
//! A hold keeps the motor where it is, and the friction of the gear keeps what the
//! joint presses with, for good. So right after the pause, and for half a second, and once
//! more where the arm is enabled but has no command yet, the
//! place of the hold gives way, against the torque that the joint carries beyond its own
//! weight, while that is not small (an arm that was stopped rings, so that it may be for a
//! moment, and to and fro costs nothing of the way), and to a little from where it began at
//! most: a sensor that is wrong moves the arm no further. A joint that stays behind it
//! is not led on: nobody measures it, or more holds it than friction. Giving way in the
//! direction in which the surroundings push puts no energy into them.

use super::{Setpoint, config::ReleaseConfig};

/// So long after the pause it is over [s].
const LASTS: f64 = 0.5;

/// The way out of a contact, of one joint.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Release {
    /// Where it is, from where it began \[rad\].
    gone: f64,
    /// Time in which it may \[s\].
    time: f64,
}

impl Release {
    /// Begins, at a pause.
    pub fn begin() -> Release {
        Release {
            gone: 0.0,
            time: LASTS,
        }
    }

    /// One step of `dt` \[s\] from the hold at `hold` \[rad\] under the torque `external`
    /// \[Nm\] that the joint carries beyond its own weight, while the joint is at `position`
    /// \[rad\] and may stay behind by `reach` \[rad\]: where to go, if it gives way.
    pub fn step(
        &mut self,
        config: &ReleaseConfig,
        dt: f64,
        hold: f64,
        [position, reach]: [f64; 2],
        external: f64,
    ) -> Option<Setpoint> {
        // A torque that is not finite releases nothing.
        let presses = external.abs() > config.torque;
        self.time -= dt;
        let direction = -external.signum();
        let way = (config.speed * dt).min(config.distance - direction * self.gone);
        let follows = direction * (hold - position) < reach;
        if self.time <= 0.0 || !presses || !follows || way <= 0.0 {
            return None;
        }
        self.gone += direction * way;
        Some(Setpoint {
            position: hold + direction * way,
            velocity: direction * config.speed,
            acceleration: 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring that the joint leans on with `torque` at first; where it ends.
    fn end(config: &ReleaseConfig, torque: f64, stiffness: f64) -> (f64, f64) {
        let mut release = Release::begin();
        let (mut hold, mut external) = (0.0, torque);
        for _ in 0..2000 {
            if let Some(setpoint) = release.step(config, 1e-3, hold, [hold, 1e-3], external) {
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
        assert_eq!(end(&config, 0.9 * config.torque, 0.0).0, 0.0);
        assert_eq!(end(&config, f64::NAN, 0.0).0, 0.0);
    }

    /// One step from a hold at zero.
    fn gives_way(release: &mut Release, position: f64, external: f64) -> bool {
        let config = ReleaseConfig::default();
        let step = release.step(&config, 1e-3, 0.0, [position, 1e-3], external);
        step.is_some()
    }

    #[test]
    fn it_ends_after_a_while_but_not_by_a_moment_without_torque_nor_by_ringing() {
        let mut release = Release::begin();
        assert!((0..499).all(|_| !gives_way(&mut release, 0.0, 0.0)));
        assert!(!gives_way(&mut release, 0.0, 10.0));
        let mut release = Release::begin();
        assert!(gives_way(&mut release, 0.0, 10.0));
        assert!(!gives_way(&mut release, 0.0, 0.0));
        assert!(gives_way(&mut release, 0.0, 10.0));
        // 0.3 s of it: 45 mrad to and fro.
        let mut release = Release::begin();
        for period in 0..15 {
            let torque = if period % 2 == 0 { 10.0 } else { -10.0 };
            assert!((0..20).all(|_| gives_way(&mut release, 0.0, torque)));
        }
    }

    #[test]
    fn a_joint_that_stays_behind_is_not_led_on() {
        for external in [10.0_f64, -10.0] {
            let behind = |way: f64| way * external.signum();
            let mut release = Release::begin();
            assert!(gives_way(&mut release, behind(0.9e-3), external));
            assert!(!gives_way(&mut release, behind(1.1e-3), external));
            assert!(gives_way(&mut release, -behind(1.1e-3), external));
        }
    }
}

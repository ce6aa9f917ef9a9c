//! A servo that begins to follow.
//!
//! After `enable` or `resume` a servo comes to its first command on a slow ramp
//! ([`approach_speed`](crate::servo::ServoConfig::approach_speed)). A command that ran ahead of
//! that would stay ahead, by as much as it may, and would meet what is in the way with all of
//! the servo's spring behind it.

use nalgebra::Vector3;

/// A tip that stays within this [m],
const STANDS: f64 = 0.2e-3;
/// for so long, stands: its servo does not follow [s].
const STOOD: f64 = 0.1;
/// Shares of the largest lead beyond which a servo that begins to follow takes over, and below
/// which it has [-].
const BEGUN: f64 = 0.5;
const DONE: f64 = 0.1;
/// The tip may be so long on its way: there are servos that never come nearer [s].
const PATIENCE: f64 = 1.0;

/// Whether the servo still comes to its command.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TakingOver {
    /// Where the tip stands [m].
    place: Option<Vector3<f64>>,
    /// For how long [s].
    stands: f64,
    /// For how long it is on its way to the command [s].
    comes: Option<f64>,
}

impl TakingOver {
    /// After `dt` \[s\] with the command `lead` \[m\] ahead of the tip, which is at `free_tip`
    /// \[m\], or `None` where it touches something, which keeps it back; it may lead by `leash`
    /// \[m\].
    pub fn step(
        &mut self,
        dt: f64,
        lead: f64,
        free_tip: Option<&Vector3<f64>>,
        leash: f64,
    ) -> bool {
        let Some(tip) = free_tip else {
            *self = TakingOver::default();
            return false;
        };
        let place = self.place.filter(|own| (tip - own).norm() < STANDS);
        self.stands = place.map_or(0.0, |_| self.stands + dt);
        self.place = place.or(Some(*tip));
        let stands = self.stands > STOOD;
        self.comes = match self.comes {
            None if lead > BEGUN * leash && stands => Some(0.0),
            Some(since) if lead > DONE * leash && since < PATIENCE => {
                Some(since + if stands { 0.0 } else { dt })
            }
            _ => None,
        };
        self.comes.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-3;
    const LEASH: f64 = 3e-3;

    /// For how long a command waits that is 3 mm ahead of a tip that stands for `stands` \[s\]
    /// and then comes to it with `speed` \[m/s\]: while it stands and while it comes \[s\].
    fn waits(stands: f64, speed: f64) -> [f64; 2] {
        let mut own = TakingOver::default();
        let mut waited = [0.0; 2];
        let mut lead = LEASH;
        for step in 0..10_000 {
            let comes = f64::from(step) * DT >= stands;
            let speed = if comes { speed } else { 0.0 };
            let tip = Vector3::new(-lead, 0.0, 0.0);
            if own.step(DT, lead, Some(&tip), LEASH) {
                waited[usize::from(comes)] += DT;
            }
            lead = (lead - speed * DT).max(0.0);
        }
        waited
    }

    #[test]
    fn a_command_waits_until_a_servo_on_its_ramp_has_come() {
        let [stands, comes] = waits(0.5, 0.02);
        assert!((0.39..0.41).contains(&stands), "{stands} s");
        // From 3 mm to a tenth of that, with 20 mm/s.
        assert!((0.134..0.137).contains(&comes), "{comes} s");
        // Not for one that hardly comes at all.
        let [_, comes] = waits(0.5, 0.0025);
        assert!((1.0..1.1).contains(&comes), "{comes} s");
    }

    #[test]
    fn a_servo_that_follows_is_not_waited_for() {
        assert_eq!(waits(0.09, 0.02), [0.0; 2]);
    }

    #[test]
    fn what_touches_something_is_kept_back_by_that() {
        let mut own = TakingOver::default();
        let step = |own: &mut TakingOver| own.step(DT, LEASH, Some(&Vector3::zeros()), LEASH);
        let waits = |own: &mut TakingOver| (0..200).any(|_| step(own));
        assert!(waits(&mut own));
        assert!(!own.step(DT, LEASH, None, LEASH));
        assert!(!step(&mut own));
        assert!(waits(&mut own));
    }
}

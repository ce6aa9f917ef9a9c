//! How a tool turns with the hand.
//!
//! Not where a hand's orientation is counts, but how it changes: the tool turns about the same axes
//! of the base frame by as much, from where it was when the arm was armed,
//! R = R_hand R_hand,0⁻¹ R_tool,0. So nothing turns at arming, and after a pause the tool goes to
//! where it belongs, as the tip does, unless the hand turned further than the tool could have
//! followed. A hand that says nothing of how
//! it is turned holds the tool as it is, and where it never said so as at home; so does one that
//! is somewhere else at once, as no hand turns: what it does from there on counts. The tool
//! turns no faster than [`SPEED`].

use super::tip::Turn;
use crate::orientation::Orientation;
use crate::seconds;
use nalgebra::UnitQuaternion;

/// So fast a tool turns at most [rad/s].
const SPEED: f64 = 2.0;
/// A hand does not turn faster [rad/s],
const FASTEST_HAND: f64 = 30.0;
/// but for this much [rad].
const SLACK: f64 = 0.15;
/// Longest time between two commands that counts [s].
const LONGEST: f64 = 0.02;
/// Time to the first command [s].
const FIRST: f64 = 1e-3;

/// What a tool is to do.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Turning {
    /// To be as at home.
    #[default]
    Home,
    /// To stay like that.
    Held(UnitQuaternion<f64>),
    /// To turn with the hand.
    Follows {
        /// The rotation from the hand to the tool that is kept, in the base frame.
        from_hand: UnitQuaternion<f64>,
        /// How the hand is turned, as it said last.
        hand: Orientation,
    },
}

impl Turning {
    /// After a command that came `passed` \[s\] after the one before, of a hand that is turned so;
    /// `tool` tells how the tool is where it was led to, if it can be turned.
    pub(super) fn next(
        self,
        passed: f64,
        hand: Option<&Orientation>,
        tool: impl FnOnce() -> Option<UnitQuaternion<f64>>,
    ) -> Turning {
        let begin = |hand: &Orientation, tool: UnitQuaternion<f64>| Turning::Follows {
            from_hand: hand.rotation().inverse() * tool,
            hand: *hand,
        };
        match (self, hand) {
            (Turning::Follows { from_hand, hand }, Some(now))
                if now.angle_to(&hand) <= FASTEST_HAND * passed + SLACK =>
            {
                let hand = *now;
                Turning::Follows { from_hand, hand }
            }
            (Turning::Held(tool), Some(hand)) => begin(hand, tool),
            (_, Some(hand)) => tool().map_or(Turning::Home, |tool| begin(hand, tool)),
            (Turning::Follows { .. }, None) => tool().map_or(Turning::Home, Turning::Held),
            (held, None) => held,
        }
    }

    /// The same after a pause of `pause` \[s\] with a hand that is turned so: what the tool could
    /// have followed meanwhile is no jump.
    pub(super) fn resumed(self, pause: f64, hand: Option<&Orientation>) -> Turning {
        match (self, hand) {
            (Turning::Follows { from_hand, hand }, Some(now))
                if now.angle_to(&hand) <= SPEED * pause + SLACK =>
            {
                let hand = *now;
                Turning::Follows { from_hand, hand }
            }
            (own, _) => own,
        }
    }

    /// What is asked of the tool `passed` \[s\] after the command before; `None`: as at home.
    pub(super) fn turn(&self, passed: f64) -> Option<Turn> {
        let to = match self {
            Turning::Home => return None,
            Turning::Held(tool) => *tool,
            Turning::Follows { from_hand, hand } => hand.rotation() * from_hand,
        };
        let most = SPEED * passed;
        Some(Turn { to, most })
    }
}

/// Time that counts between commands of these stamps \[s\].
pub(super) fn passed(before_ns: Option<i64>, stamp_ns: i64) -> f64 {
    before_ns.map_or(FIRST, |before_ns| {
        seconds(stamp_ns.saturating_sub(before_ns)).clamp(0.0, LONGEST)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn about_z(angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(Vector3::z() * angle)
    }

    fn hand(angle: f64) -> Orientation {
        Orientation::given(about_z(angle).coords.into()).unwrap()
    }

    fn tool() -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(Vector3::new(0.7, -2.0, 0.4))
    }

    fn off(turning: Turning, from: UnitQuaternion<f64>) -> f64 {
        turning.turn(1e-3).unwrap().to.angle_to(&from)
    }

    #[test]
    fn nothing_turns_at_the_beginning_and_then_by_as_much_as_the_hand() {
        let mut turning = Turning::default().next(1e-3, Some(&hand(2.0)), || Some(tool()));
        assert!(off(turning, tool()) < 1e-9);
        for step in 1..=100 {
            let angle = 2.0 + 0.01 * f64::from(step);
            turning = turning.next(1e-3, Some(&hand(angle)), || None);
        }
        assert!(off(turning, about_z(1.0) * tool()) < 1e-9);
        assert_eq!(turning.turn(2e-3).unwrap().most, 2e-3 * SPEED);
    }

    #[test]
    fn a_hand_that_says_nothing_or_jumps_turns_nothing() {
        let home = Turning::default();
        assert!(home.next(1e-3, None, || Some(tool())).turn(1e-3).is_none());
        let follows = home.next(1e-3, Some(&hand(0.5)), || Some(tool()));
        let silent = follows.next(1e-3, None, || Some(tool()));
        assert!(off(silent, tool()) < 1e-9);
        // It comes back otherwise turned, and turns on.
        let back = silent.next(1e-3, Some(&hand(1.5)), || None);
        assert!(off(back, tool()) < 1e-9);
        let on = back.next(1e-3, Some(&hand(1.6)), || None);
        assert!(off(on, about_z(0.1) * tool()) < 1e-9);
        let jumped = on.next(1e-3, Some(&hand(-1.0)), || Some(tool()));
        assert!(off(jumped, tool()) < 1e-9);
        // Over a pause it may turn as far as the tool would have followed.
        let now = hand(0.2);
        let resumed = |pause| {
            let resumed = jumped.resumed(pause, Some(&now));
            resumed.next(1e-3, Some(&now), || Some(tool()))
        };
        assert!(off(resumed(0.6), about_z(1.2) * tool()) < 1e-9);
        assert!(off(resumed(0.5), tool()) < 1e-9);
        // An arm that cannot turn its tool.
        let none = home.next(1e-3, Some(&hand(0.5)), || None);
        assert!(none.turn(1e-3).is_none());
    }
}

//! The hand that the mouse moves.
//!
//! The pointer does not move the master itself: it pulls a hand with mass and
//! damping by a spring. So the force on the hand is felt as a distance between
//! pointer and hand, steps of the mouse become motion, and a pointer far behind
//! a wall presses no harder than the spring drawn out to its leash.

/// What a hand does under the pull of its target and a force on it.
pub trait GripModel: Send {
    /// At rest at `position` \[m\].
    fn rest_at(&mut self, position: [f64; 3]);

    /// Moves on by `dt` \[s\] towards `target` \[m\] under `force` \[N\]; gives
    /// the position \[m\].
    fn step(&mut self, dt: f64, target: [f64; 3], force: [f64; 3]) -> [f64; 3];
}

/// Where the arm brings its tip for a hand: x_tip = x_0 + s x_hand, from the
/// leader's base frame to the follower's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandMapping {
    /// x_0: the tip when the hand is in the middle \[m\].
    pub offset: [f64; 3],
    /// s: motion of the tip by motion of the hand \[-\].
    pub scale: f64,
}

impl HandMapping {
    /// The hand that belongs to a tip \[m\].
    pub fn at_hand(&self, tip: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| (tip[axis] - self.offset[axis]) / self.scale)
    }
}

/// Longest step of the model; after a longer pause it goes on from there \[s\].
const LONGEST_STEP: f64 = 0.02;

/// A hand on the master, while a page holds it.
pub struct PageHand {
    model: Box<dyn GripModel>,
    /// Farthest that the hand goes from the middle along each axis \[m\].
    reach: [f64; 3],
    /// Farthest that the target is from the hand \[m\]: so much the spring is
    /// drawn out, however far away the pointer is.
    leash: f64,
    /// Where the hand is \[m\], while it is held.
    at: Option<[f64; 3]>,
}

impl PageHand {
    /// A hand that nobody holds.
    pub fn new(model: Box<dyn GripModel>, reach: [f64; 3], leash: f64) -> PageHand {
        PageHand {
            model,
            reach,
            leash,
            at: None,
        }
    }

    /// Moves on by `dt` \[s\]. `wanted` is where the page wants the hand,
    /// `None` while it does not hold it; `at` is where the master is, from which
    /// the hand begins; `force` is on the hand. Gives where the hand is, while
    /// it is held. Lengths \[m\], leader base frame; force \[N\].
    pub fn step(
        &mut self,
        dt: f64,
        wanted: Option<[f64; 3]>,
        at: [f64; 3],
        force: [f64; 3],
    ) -> Option<[f64; 3]> {
        let Some(wanted) = wanted else {
            self.at = None;
            return None;
        };
        let reach = self.reach;
        let inside =
            |point: [f64; 3]| [0, 1, 2].map(|axis| point[axis].clamp(-reach[axis], reach[axis]));
        let from = match self.at {
            Some(at) => at,
            None => {
                let begin = inside(at);
                self.model.rest_at(begin);
                begin
            }
        };
        let wanted = inside(wanted);
        let way = [0, 1, 2].map(|axis| wanted[axis] - from[axis]);
        let length = way[0].hypot(way[1]).hypot(way[2]);
        let share = (self.leash / length.max(1e-9)).min(1.0);
        let target = [0, 1, 2].map(|axis| from[axis] + share * way[axis]);
        let now = inside(self.model.step(dt.clamp(0.0, LONGEST_STEP), target, force));
        self.at = Some(now);
        Some(now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of an arm that moves in a plane.
    const REACH: [f64; 3] = [0.06, 0.06, 0.0];

    /// Follows its target at once, gives way by a millimetre a newton.
    struct Stiff;

    impl GripModel for Stiff {
        fn rest_at(&mut self, _: [f64; 3]) {}
        fn step(&mut self, _: f64, target: [f64; 3], force: [f64; 3]) -> [f64; 3] {
            [0, 1, 2].map(|axis| target[axis] + 1e-3 * force[axis])
        }
    }

    #[test]
    fn a_tip_has_its_hand() {
        let mapping = HandMapping {
            offset: [0.35, 0.0, 0.5],
            scale: 2.0,
        };
        let [x, y, z] = mapping.at_hand([0.38, -0.02, 0.46]);
        assert!((x - 0.015).abs() < 1e-15 && (y + 0.01).abs() < 1e-15);
        assert!((z + 0.02).abs() < 1e-15);
    }

    #[test]
    fn it_begins_where_the_master_is_and_is_pulled_no_farther_than_its_leash() {
        let mut hand = PageHand::new(Box::new(Stiff), REACH, 0.001);
        let mut last = [0.02, -0.01, 0.0];
        for step in 0..200 {
            let now = hand
                .step(0.004, Some([-0.5, 0.04, 0.1]), [0.02, -0.01, 0.0], [0.0; 3])
                .unwrap();
            let way = (now[0] - last[0]).hypot(now[1] - last[1]);
            assert!(way < 0.001 + 1e-12, "{way} m in step {step}");
            last = now;
        }
        assert!((last[0] + 0.06).abs() < 1e-12 && (last[1] - 0.04).abs() < 1e-12);
        assert_eq!(last[2], 0.0, "it does not leave the plane");
    }

    #[test]
    fn a_force_moves_it_and_nobody_holds_it_when_nobody_does() {
        let mut hand = PageHand::new(Box::new(Stiff), REACH, 0.1);
        assert_eq!(hand.step(0.004, None, [0.0; 3], [0.0; 3]), None);
        let at = hand
            .step(
                0.004,
                Some([0.01, 0.0, 0.0]),
                [0.01, 0.0, 0.0],
                [-3.0, 2.0, 0.0],
            )
            .unwrap();
        assert!((at[0] - 0.007).abs() < 1e-12 && (at[1] - 0.002).abs() < 1e-12);
        assert_eq!(hand.step(0.004, None, [0.0; 3], [0.0; 3]), None);
    }

    /// Stays where it was put.
    struct Still([f64; 3]);

    impl GripModel for Still {
        fn rest_at(&mut self, position: [f64; 3]) {
            self.0 = position;
        }
        fn step(&mut self, _: f64, _: [f64; 3], _: [f64; 3]) -> [f64; 3] {
            self.0
        }
    }

    #[test]
    fn taken_anew_it_begins_anew_wherever_it_was_before() {
        let mut hand = PageHand::new(Box::new(Still([0.0; 3])), REACH, 0.1);
        let at = hand.step(0.004, Some([0.01, 0.0, 0.0]), [0.01, 0.0, 0.0], [0.0; 3]);
        assert_eq!(at, Some([0.01, 0.0, 0.0]));
        assert_eq!(hand.step(0.004, None, [0.0; 3], [0.0; 3]), None);
        let at = hand
            .step(0.004, Some([0.05, 0.0, 0.0]), [-0.03, 0.0, 0.0], [0.0; 3])
            .unwrap();
        assert_eq!(at, [-0.03, 0.0, 0.0]);
    }
}

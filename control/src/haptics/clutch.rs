//! The clutch: the hand moves, the arm stays.
//!
//! Between hand and arm there is a way, first of none. Opened, the clutch holds what the arm is led
//! by where it is; closed again, it takes for the way what then lies between the two, so that
//! neither opening nor closing leads the arm anywhere. Both happen at a measurement of the hand.
//! Of the hand's orientation nothing has to be kept: while the clutch is open the arm is told of
//! none, and a tool turns from where it is once it is told again.

/// In this time the force on the hand fades in after the clutch was closed [s].
const FORCE_RAMP: f64 = 0.2;

/// The clutch of a hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clutch {
    open: bool,
    /// Where the arm is held, leader base frame [m].
    held: Option<[f64; 3]>,
    /// From the hand to what the arm is led by [m]; before the clutch was used, none at all.
    way: Option<[f64; 3]>,
    /// What the arm was led by last \[m\].
    led: Option<[f64; 3]>,
    /// Share of the force that the hand feels, 0 … 1.
    share: f64,
}

impl Default for Clutch {
    fn default() -> Self {
        Clutch {
            open: false,
            held: None,
            way: None,
            led: None,
            share: 1.0,
        }
    }
}

impl Clutch {
    /// Opens or closes it, with the next measurement of the hand.
    pub(super) fn set_open(&mut self, open: bool) {
        self.open = open;
    }

    /// Whether the arm stays: until it is led again.
    pub(super) fn is_open(&self) -> bool {
        self.open || self.held.is_some()
    }

    /// What the arm is led by \[m\] with the hand at `hand` \[m\], both leader base frame.
    pub(super) fn lead(&mut self, hand: [f64; 3]) -> [f64; 3] {
        match (self.open, self.held) {
            (true, None) => self.held = Some(self.by_way(hand)),
            (false, Some(held)) => {
                self.way = Some(sum(held, hand.map(|own| -own)));
                self.held = None;
            }
            (true, Some(_)) | (false, None) => {}
        }
        let led = self.held.unwrap_or_else(|| self.by_way(hand));
        self.led = Some(led);
        led
    }

    /// The next hand is another one: where a clutch was in use, it is closed on that one.
    pub(super) fn hand_over(&mut self) {
        if self.way.is_some() || self.held.is_some() {
            self.held = self.led;
        }
        self.open = false;
    }

    fn by_way(&self, hand: [f64; 3]) -> [f64; 3] {
        self.way.map_or(hand, |way| sum(hand, way))
    }

    /// Share of a force that the hand feels after `dt` \[s\]: none while the clutch is open.
    pub(super) fn share(&mut self, dt: f64) -> f64 {
        self.share = match self.is_open() {
            true => 0.0,
            false => (self.share + dt / FORCE_RAMP).min(1.0),
        };
        self.share
    }
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn without_a_clutch_the_hand_leads_as_it_is() {
        let mut clutch = Clutch::default();
        for hand in [[0.1, -0.0, 1e-300], [-0.3, f64::MIN_POSITIVE, 0.2]] {
            assert_eq!(clutch.lead(hand).map(f64::to_bits), hand.map(f64::to_bits));
            assert_eq!(clutch.share(1e-3), 1.0);
        }
    }

    #[test]
    fn another_hand_takes_over_where_the_arm_is() {
        let mut clutch = Clutch::default();
        assert_eq!(clutch.lead([0.1, 0.0, 0.0]), [0.1, 0.0, 0.0]);
        // Never used, it takes the other hand as it is.
        clutch.hand_over();
        assert_eq!(clutch.lead([0.2, 0.0, 0.0]), [0.2, 0.0, 0.0]);
        clutch.set_open(true);
        clutch.lead([0.3, 0.0, 0.0]);
        clutch.lead([0.4, 0.0, 0.0]);
        clutch.hand_over();
        let led = [[-0.1, 0.0, 0.0], [-0.05, 0.0, 0.0]].map(|hand| clutch.lead(hand)[0]);
        assert!(
            (led[0] - 0.3).abs() < 1e-12 && (led[1] - 0.35).abs() < 1e-12,
            "{led:?}"
        );
        assert!(!clutch.is_open());
    }

    #[test]
    fn the_force_goes_at_once_and_comes_back_slowly() {
        let mut clutch = Clutch::default();
        clutch.set_open(true);
        assert_eq!(clutch.share(1e-3), 0.0);
        clutch.lead([0.1, 0.0, 0.0]);
        clutch.set_open(false);
        assert_eq!(clutch.share(1e-3), 0.0, "the arm is not led yet");
        clutch.lead([0.2, 0.0, 0.0]);
        for step in 1..=200 {
            let share = clutch.share(1e-3);
            assert!((share - f64::from(step) * 0.005).abs() < 1e-9, "{share}");
        }
    }

    proptest! {
        /// What the arm is led by moves with the hand where the clutch is closed, stays where it
        /// is open, and never goes by more than the hand does.
        #[test]
        fn neither_opening_nor_closing_leads_the_arm_anywhere(
            steps in proptest::collection::vec((proptest::array::uniform3(-0.01..0.01f64), any::<bool>()), 1..200),
        ) {
            let mut clutch = Clutch::default();
            let (mut hand, mut led) = ([0.0; 3], [0.0; 3]);
            let mut was_open = false;
            for (step, toggles) in steps {
                let open = was_open != toggles;
                clutch.set_open(open);
                hand = sum(hand, step);
                let now = clutch.lead(hand);
                for axis in 0..3 {
                    let moved = now[axis] - led[axis];
                    let wanted = match (was_open, open) {
                        (true, _) => 0.0,
                        (false, _) => step[axis],
                    };
                    prop_assert!((moved - wanted).abs() < 1e-12, "{moved} where {wanted}");
                }
                led = now;
                was_open = open;
            }
        }
    }
}

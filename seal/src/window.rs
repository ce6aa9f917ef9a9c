//! Which numbers were taken before (the sliding window of RFC 4303, section 3.4.3).

/// How far back numbers are remembered: two seconds at 500 Hz. What is older is
/// refused.
pub const WINDOW: u32 = 1024;
const WORDS: usize = (WINDOW / 64) as usize;

/// Numbers that were taken under one key. Numbers wrap (RFC 1982); no more than
/// 2³¹ are ever used under one.
#[derive(Clone, Debug, Default)]
pub struct ReplayWindow {
    highest: Option<u32>,
    /// Bit number mod [`WINDOW`]: taken.
    taken: [u64; WORDS],
}

impl ReplayWindow {
    /// Whether `number` may still be taken.
    pub fn is_new(&self, number: u32) -> bool {
        let Some(highest) = self.highest else {
            return true;
        };
        let behind = highest.wrapping_sub(number);
        if behind as i32 >= 0 {
            behind < WINDOW && !self.bit(number)
        } else {
            true
        }
    }

    /// Takes `number`, of a frame whose seal is right.
    pub fn take(&mut self, number: u32) {
        match self.highest {
            None => self.highest = Some(number),
            Some(highest) => {
                let ahead = number.wrapping_sub(highest);
                if ahead as i32 > 0 {
                    for step in 1..=ahead.min(WINDOW) {
                        let passed = highest.wrapping_add(step);
                        self.taken[place(passed)] &= !mask(passed);
                    }
                    self.highest = Some(number);
                }
            }
        }
        self.taken[place(number)] |= mask(number);
    }

    fn bit(&self, number: u32) -> bool {
        self.taken[place(number)] & mask(number) != 0
    }
}

fn place(number: u32) -> usize {
    (number % WINDOW / 64) as usize
}

fn mask(number: u32) -> u64 {
    1 << (number % 64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        /// Against a set of all numbers taken.
        #[test]
        fn no_number_is_taken_twice(
            start: u32,
            steps in proptest::collection::vec(-1500..1500i64, 1..400),
        ) {
            let mut window = ReplayWindow::default();
            let mut taken = BTreeSet::new();
            let (mut at, mut highest) = (0_i64, None::<i64>);
            for step in steps {
                at += step;
                let number = start.wrapping_add(at as u32);
                let may = highest.is_none_or(|own| own - at < i64::from(WINDOW));
                let expected = may && !taken.contains(&at);
                prop_assert_eq!(window.is_new(number), expected);
                if expected {
                    window.take(number);
                    taken.insert(at);
                    highest = Some(highest.map_or(at, |own| own.max(at)));
                }
            }
        }
    }
}

//! Whether a key is held, from the characters that a terminal gives. Pure.
//!
//! A terminal tells no release. A key that is held repeats: after a pause of a quarter to two
//! thirds of a second, then every 30 to 50 ms. Held is a key that has begun to repeat, for as long as
//! the repetitions come.

use ferntast_msgs::Time;

/// A key whose next character takes longer is released \[s\]. With the time in which the servo
/// brings a slow arm to rest that is within 100 ms.
pub const RELEASED: f64 = 0.06;

/// Listens to the characters.
#[derive(Clone, Copy, Debug, Default)]
pub struct HeldKey {
    last: Option<Time>,
    /// The last two came one shortly after the other.
    repeats: bool,
}

impl HeldKey {
    /// A character came at `now`.
    pub fn character(&mut self, now: Time) {
        self.repeats = self.is_recent(now);
        self.last = Some(now);
    }

    /// Whether the key is held at `now`.
    pub fn is_held(&self, now: Time) -> bool {
        self.repeats && self.is_recent(now)
    }

    fn is_recent(&self, now: Time) -> bool {
        self.last
            .is_some_and(|last| now.seconds_since(last) <= RELEASED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: i64) -> Time {
        Time::from_nanos(1_700_000_000_000_000_000 + ms * 1_000_000)
    }

    #[test]
    fn a_key_is_held_while_it_repeats() {
        let mut key = HeldKey::default();
        assert!(!key.is_held(at(0)));
        // Pressed, the pause before it repeats, every 33 ms from then on.
        key.character(at(0));
        assert!(!key.is_held(at(1)));
        key.character(at(500));
        assert!(!key.is_held(at(501)), "pressed twice is not held");
        for ms in (533..2000).step_by(33) {
            key.character(at(ms));
            assert!(key.is_held(at(ms)) && key.is_held(at(ms + 32)));
        }
        let last = 1985;
        assert!(key.is_held(at(last + 59)));
        assert!(!key.is_held(at(last + 61)));
        key.character(at(last + 3000));
        assert!(!key.is_held(at(last + 3000)), "a single one begins nothing");
    }
}

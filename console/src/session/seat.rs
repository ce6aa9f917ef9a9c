//! Who operates, and whether the hand is held: one operator, many watchers.
//!
//! Pure: time is an argument. A page has to say again and again that it is
//! alive, from the loop in which it draws: a page that is hidden, frozen or
//! gone stops saying so, and the hand is let go. So it is when nobody has
//! touched the page for a while.

use ferntast_msgs::Time;
use serde::Serialize;

/// Silence of the operator's page after which the hand is let go \[s\].
pub const BEAT_LIFE: f64 = 0.25;
/// Time without a touch after which the hand is let go \[s\].
pub const TOUCH_LIFE: f64 = 20.0;
/// Silence after which the seat is free \[s\].
pub const SEAT_LIFE: f64 = 3.0;

/// Why the hand was let go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LetGo {
    /// The operator wanted it.
    Wanted,
    /// The page was silent: hidden, frozen, closed.
    Silent,
    /// Nobody touched the page.
    Idle,
}

/// Another page operates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("another page operates this session; this one watches until that one gives it up")]
pub struct Taken;

/// The operator's seat.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seat {
    operator: Option<u64>,
    beat: Time,
    touch: Time,
    /// Where the operator wants the hand, leader base frame \[m\]; `None` while
    /// the hand is not held.
    target: Option<[f64; 2]>,
    let_go: Option<LetGo>,
}

impl Seat {
    /// Page `page` wants to operate.
    ///
    /// # Errors
    ///
    /// [`Taken`].
    pub fn sit(&mut self, page: u64, now: Time) -> Result<(), Taken> {
        self.age(now);
        match self.operator {
            Some(other) if other != page => Err(Taken),
            Some(_) => Ok(()),
            None => {
                *self = Seat {
                    operator: Some(page),
                    beat: now,
                    touch: now,
                    ..Seat::default()
                };
                Ok(())
            }
        }
    }

    /// Page `page` operates no longer, if it did.
    pub fn leave(&mut self, page: u64) {
        if self.operator == Some(page) {
            *self = Seat {
                let_go: self.target.map(|_| LetGo::Wanted).or(self.let_go),
                ..Seat::default()
            };
        }
    }

    /// Whether `page` operates.
    pub fn is(&self, page: u64) -> bool {
        self.operator == Some(page)
    }

    /// Who operates.
    pub fn operator(&self) -> Option<u64> {
        self.operator
    }

    /// Page `page` is alive.
    pub fn beat(&mut self, page: u64, now: Time) {
        if self.is(page) {
            self.beat = now;
        }
    }

    /// The operator touched the page.
    pub fn touched(&mut self, page: u64, now: Time) {
        if self.is(page) {
            self.beat = now;
            self.touch = now;
        }
    }

    /// The operator's hand takes the master, or moves it to `target` \[m\].
    /// What is not finite is no target.
    pub fn hold(&mut self, page: u64, now: Time, target: [f64; 2]) {
        if self.is(page) && target.iter().all(|value| value.is_finite()) {
            self.beat = now;
            self.touch = now;
            self.target = Some(target);
            self.let_go = None;
        }
    }

    /// The operator's hand lets go.
    pub fn let_go(&mut self, page: u64) {
        if self.is(page) && self.target.take().is_some() {
            self.let_go = Some(LetGo::Wanted);
        }
    }

    /// Lets go for those who cannot any more.
    pub fn age(&mut self, now: Time) {
        if self.operator.is_none() {
            return;
        }
        let silence = now.seconds_since(self.beat);
        let reason = if silence > BEAT_LIFE {
            Some(LetGo::Silent)
        } else if now.seconds_since(self.touch) > TOUCH_LIFE {
            Some(LetGo::Idle)
        } else {
            None
        };
        if reason.is_some() && self.target.take().is_some() {
            self.let_go = reason;
        }
        if silence > SEAT_LIFE {
            self.operator = None;
        }
    }

    /// Where the hand is wanted \[m\], while it is held.
    pub fn target(&self) -> Option<[f64; 2]> {
        self.target
    }

    /// Why it was let go the last time; `None` while it is held.
    pub fn reason(&self) -> Option<LetGo> {
        self.let_go
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> Time {
        Time::from_nanos(1_000_000_000_000 + (seconds * 1e9) as i64)
    }

    #[test]
    fn one_page_operates() {
        let mut seat = Seat::default();
        seat.sit(1, at(0.0)).unwrap();
        assert_eq!(seat.sit(2, at(0.1)), Err(Taken));
        seat.hold(2, at(0.1), [0.01, 0.0]);
        assert_eq!(seat.target(), None, "a watcher moves nothing");
        seat.leave(2);
        assert!(seat.is(1));
        seat.leave(1);
        seat.sit(2, at(0.2)).unwrap();
        assert!(seat.is(2));
    }

    #[test]
    fn a_page_that_is_silent_lets_go_and_then_loses_the_seat() {
        let mut seat = Seat::default();
        seat.sit(1, at(0.0)).unwrap();
        seat.hold(1, at(0.0), [0.01, 0.02]);
        for step in 1..=20 {
            seat.beat(1, at(f64::from(step) * 0.1));
            seat.age(at(f64::from(step) * 0.1 + 0.09));
        }
        assert_eq!(seat.target(), Some([0.01, 0.02]));
        seat.age(at(2.0 + BEAT_LIFE + 0.01));
        assert_eq!((seat.target(), seat.reason()), (None, Some(LetGo::Silent)));
        assert_eq!(seat.sit(2, at(2.5)), Err(Taken));
        seat.sit(2, at(2.0 + SEAT_LIFE + 0.01)).unwrap();
    }

    #[test]
    fn a_page_that_nobody_touches_lets_go() {
        let mut seat = Seat::default();
        seat.sit(1, at(0.0)).unwrap();
        seat.hold(1, at(0.0), [0.0; 2]);
        let mut last = 0.0;
        for step in 1..=300 {
            let now = f64::from(step) * 0.1;
            seat.beat(1, at(now));
            seat.age(at(now));
            if seat.target().is_some() {
                last = now;
            }
        }
        assert!((last - TOUCH_LIFE).abs() < 0.11, "{last}");
        assert_eq!(seat.reason(), Some(LetGo::Idle));
        assert!(seat.is(1), "it may take the hand again");
    }

    #[test]
    fn what_is_no_number_moves_nothing() {
        let mut seat = Seat::default();
        seat.sit(1, at(0.0)).unwrap();
        seat.hold(1, at(0.0), [f64::NAN, 0.0]);
        seat.hold(1, at(0.0), [0.0, f64::INFINITY]);
        assert_eq!(seat.target(), None);
    }
}

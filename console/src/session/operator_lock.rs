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
/// Silence after which the lock is free \[s\].
pub const LOCK_LIFE: f64 = 3.0;

/// Why the hand was let go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Release {
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

/// The operator's lock.
#[derive(Clone, Copy, Debug, Default)]
pub struct OperatorLock {
    operator: Option<u64>,
    beat: Time,
    touch: Time,
    /// Where the operator wants the hand, leader base frame \[m\]; `None` while
    /// the hand is not held.
    target: Option<[f64; 3]>,
    let_go: Option<Release>,
}

impl OperatorLock {
    /// Page `page` wants to operate.
    ///
    /// # Errors
    ///
    /// [`Taken`].
    pub fn take(&mut self, page: u64, now: Time) -> Result<(), Taken> {
        self.age(now);
        match self.operator {
            Some(other) if other != page => Err(Taken),
            Some(_) => Ok(()),
            None => {
                *self = OperatorLock {
                    operator: Some(page),
                    beat: now,
                    touch: now,
                    ..OperatorLock::default()
                };
                Ok(())
            }
        }
    }

    /// Page `page` operates no longer, if it did.
    pub fn leave(&mut self, page: u64) {
        if self.operator == Some(page) {
            *self = OperatorLock {
                let_go: self.target.map(|_| Release::Wanted).or(self.let_go),
                ..OperatorLock::default()
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
    pub fn hold(&mut self, page: u64, now: Time, target: [f64; 3]) {
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
            self.let_go = Some(Release::Wanted);
        }
    }

    /// Lets go for those who cannot any more.
    pub fn age(&mut self, now: Time) {
        if self.operator.is_none() {
            return;
        }
        let silence = now.seconds_since(self.beat);
        let reason = if silence > BEAT_LIFE {
            Some(Release::Silent)
        } else if now.seconds_since(self.touch) > TOUCH_LIFE {
            Some(Release::Idle)
        } else {
            None
        };
        if reason.is_some() && self.target.take().is_some() {
            self.let_go = reason;
        }
        if silence > LOCK_LIFE {
            self.operator = None;
        }
    }

    /// Where the hand is wanted \[m\], while it is held.
    pub fn target(&self) -> Option<[f64; 3]> {
        self.target
    }

    /// Why it was let go the last time; `None` while it is held.
    pub fn reason(&self) -> Option<Release> {
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
        let mut lock = OperatorLock::default();
        lock.take(1, at(0.0)).unwrap();
        assert_eq!(lock.take(2, at(0.1)), Err(Taken));
        lock.hold(2, at(0.1), [0.01, 0.0, 0.0]);
        assert_eq!(lock.target(), None, "a watcher moves nothing");
        lock.leave(2);
        assert!(lock.is(1));
        lock.leave(1);
        lock.take(2, at(0.2)).unwrap();
        assert!(lock.is(2));
    }

    #[test]
    fn a_page_that_is_silent_lets_go_and_then_loses_the_lock() {
        let mut lock = OperatorLock::default();
        lock.take(1, at(0.0)).unwrap();
        lock.hold(1, at(0.0), [0.01, 0.02, 0.03]);
        for step in 1..=20 {
            lock.beat(1, at(f64::from(step) * 0.1));
            lock.age(at(f64::from(step) * 0.1 + 0.09));
        }
        assert_eq!(lock.target(), Some([0.01, 0.02, 0.03]));
        lock.age(at(2.0 + BEAT_LIFE + 0.01));
        assert_eq!(
            (lock.target(), lock.reason()),
            (None, Some(Release::Silent))
        );
        assert_eq!(lock.take(2, at(2.5)), Err(Taken));
        lock.take(2, at(2.0 + LOCK_LIFE + 0.01)).unwrap();
    }

    #[test]
    fn a_page_that_nobody_touches_lets_go() {
        let mut lock = OperatorLock::default();
        lock.take(1, at(0.0)).unwrap();
        lock.hold(1, at(0.0), [0.0; 3]);
        let mut last = 0.0;
        for step in 1..=300 {
            let now = f64::from(step) * 0.1;
            lock.beat(1, at(now));
            lock.age(at(now));
            if lock.target().is_some() {
                last = now;
            }
        }
        assert!((last - TOUCH_LIFE).abs() < 0.11, "{last}");
        assert_eq!(lock.reason(), Some(Release::Idle));
        assert!(lock.is(1), "it may take the hand again");
    }

    #[test]
    fn what_is_no_number_moves_nothing() {
        let mut lock = OperatorLock::default();
        lock.take(1, at(0.0)).unwrap();
        lock.hold(1, at(0.0), [f64::NAN, 0.0, 0.0]);
        lock.hold(1, at(0.0), [0.0, 0.0, f64::INFINITY]);
        assert_eq!(lock.target(), None);
    }
}

//! The fastest speed that the estimates rest on.

/// The largest speed of the rows of the last one to two memories of the estimator: what it was
/// told before, it has forgotten.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fastest {
    /// Length of a window \[s\].
    memory: f64,
    /// When this window began \[s\].
    since: f64,
    /// Largest speed in this window and in the one before \[rad/s\].
    now: f64,
    before: f64,
}

impl Fastest {
    pub(super) fn new(memory: f64) -> Self {
        Self {
            memory,
            since: f64::NEG_INFINITY,
            now: 0.0,
            before: 0.0,
        }
    }

    /// Takes in the `speed` \[rad/s\] of a row at `time` \[s\].
    pub(super) fn see(&mut self, time: f64, speed: f64) {
        if !(0.0..self.memory).contains(&(time - self.since)) {
            self.since = time;
            self.before = self.now;
            self.now = 0.0;
        }
        self.now = self.now.max(speed);
    }

    /// The fastest speed \[rad/s\]; `None` before there was any.
    pub(super) fn seen(&self) -> Option<f64> {
        let seen = self.now.max(self.before);
        (seen > 0.0).then_some(seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_counts_for_one_memory_at_least_and_for_two_at_most() {
        let mut fastest = Fastest::new(10.0);
        assert_eq!(fastest.seen(), None);
        for tenth in 0..400 {
            let time = 0.1 * f64::from(tenth);
            let quick = (50..60).contains(&tenth);
            fastest.see(time, if quick { 0.5 } else { 0.1 });
            let seen = fastest.seen().unwrap();
            match tenth {
                50..=159 => assert_eq!(seen, 0.5, "{time} s"),
                262.. => assert_eq!(seen, 0.1, "{time} s"),
                _ => {}
            }
        }
    }
}

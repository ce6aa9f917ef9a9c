//! How long a device was in each state, and why.

use std::collections::BTreeMap;

use ferntast_msgs::{Time, sample::OperatingStateSample};
use serde::Serialize;

/// The time that a device spent in one state for one reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateTime {
    /// The state.
    pub state: String,
    /// Why it was in it.
    pub reason: String,
    /// How long, all times together \[s\].
    pub seconds: f64,
    /// How often it was entered.
    pub times: u32,
}

/// Adds up the time between an operating state and the next one. There are so few reasons
/// that it does not grow with the session.
#[derive(Debug, Default)]
pub struct StateTimes {
    /// By state and reason: seconds and entries.
    spent: BTreeMap<(String, String), (f64, u32)>,
    now: Option<(String, String)>,
    since: Time,
}

impl StateTimes {
    /// A device told its state.
    pub fn note(&mut self, sample: &OperatingStateSample) {
        let state = sample.state.name().unwrap_or("UNKNOWN").to_owned();
        let now = (state, sample.reason.to_string());
        if self.now.as_ref() == Some(&now) {
            return;
        }
        self.count_until(sample.stamp);
        self.spent.entry(now.clone()).or_default().1 += 1;
        self.now = Some(now);
        self.since = sample.stamp;
    }

    /// Forgets all but the state that the device is in: what counts begins at `now`.
    pub fn begin(&mut self, now: Time) {
        self.spent.clear();
        if let Some(own) = &self.now {
            self.spent.insert(own.clone(), (0.0, 1));
        }
        self.since = now;
    }

    /// Counts the time until `now`, after which the device is not looked at any more.
    pub fn end(&mut self, now: Time) {
        self.count_until(now);
        self.since = now;
    }

    fn count_until(&mut self, now: Time) {
        if let Some(own) = &self.now
            && let Some((seconds, _)) = self.spent.get_mut(own)
        {
            // A stamp from before what counts began adds nothing.
            *seconds += now.seconds_since(self.since).max(0.0);
        }
    }

    /// What was spent, the longest first.
    pub fn spent(&self) -> Vec<StateTime> {
        let times = self
            .spent
            .iter()
            .map(|((state, reason), (seconds, times))| StateTime {
                state: state.clone(),
                reason: reason.clone(),
                seconds: *seconds,
                times: *times,
            });
        let mut times: Vec<StateTime> = times.collect();
        times.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        times
    }

    /// Time in `state`, for all reasons \[s\].
    pub fn seconds_in(&self, state: &str) -> f64 {
        let own = self.spent.iter().filter(|((own, _), _)| own == state);
        own.map(|(_, (seconds, _))| seconds).sum()
    }
}

#[cfg(test)]
mod tests {
    use ferntast_msgs::sample::OperatingState;

    use super::*;

    fn at(seconds: f64) -> Time {
        Time::from_nanos(1_000_000_000_000 + (seconds * 1e9) as i64)
    }

    fn note(times: &mut StateTimes, seconds: f64, state: OperatingState, reason: &str) {
        times.note(&OperatingStateSample::new(at(seconds), state, reason));
    }

    #[test]
    fn each_state_has_its_time_and_the_reason() {
        let mut times = StateTimes::default();
        note(&mut times, 0.0, OperatingState::DISABLED, "started");
        note(&mut times, 2.0, OperatingState::ENABLED, "enable");
        times.begin(at(2.5));
        for tenth in 0..70 {
            note(
                &mut times,
                2.5 + f64::from(tenth) * 0.1,
                OperatingState::ENABLED,
                "enable",
            );
        }
        for begin in [10.0, 20.0] {
            note(&mut times, begin, OperatingState::PAUSED, "silent");
            note(&mut times, begin + 1.5, OperatingState::ENABLED, "resume");
        }
        times.end(at(25.0));
        let spent = times.spent();
        let told: Vec<_> = spent
            .iter()
            .map(|own| (own.state.as_str(), own.reason.as_str(), own.times))
            .collect();
        assert_eq!(
            told,
            [
                ("ENABLED", "resume", 2),
                ("ENABLED", "enable", 1),
                ("PAUSED", "silent", 2)
            ]
        );
        let seconds: Vec<f64> = spent.iter().map(|own| own.seconds).collect();
        for (own, expected) in seconds.iter().zip([12.0, 7.5, 3.0]) {
            assert!((own - expected).abs() < 1e-6, "{seconds:?}");
        }
        assert!((times.seconds_in("ENABLED") - 19.5).abs() < 1e-6);
        assert_eq!(times.seconds_in("FAULT"), 0.0);
    }
}

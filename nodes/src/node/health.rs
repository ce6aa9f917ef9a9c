//! How a node is doing.

use ferntast_msgs::{
    Text, Time,
    sample::{Fault, Faults, HealthSample, Level},
};

/// How often a node's health is published \[ns\]: a sample has the faults since the one before.
pub(crate) const HEALTH_PERIOD_NANOS: i64 = 100_000_000;
/// Over how long rate and lateness are taken \[ns\].
const WINDOW_NANOS: i64 = 1_000_000_000;

/// What a step has to say of its node's health.
#[derive(Clone, Copy, Debug)]
pub struct NodeHealth {
    /// Faults that are active in this step.
    pub faults: Faults,
    /// Severity.
    pub level: Level,
    /// Age of the main input \[s\]; NaN without one.
    pub input_age: f64,
    /// Messages refused since the start.
    pub refused: u64,
    /// Messages lost since the start.
    pub lost: u64,
    /// What the node has to say, for people.
    pub message: Text<96>,
}

impl Default for NodeHealth {
    fn default() -> Self {
        NodeHealth {
            faults: Faults::default(),
            level: Level::OK,
            input_age: f64::NAN,
            refused: 0,
            lost: 0,
            message: Text::EMPTY,
        }
    }
}

impl NodeHealth {
    /// Raises `fault` at severity `level` (never lowers the severity).
    pub fn raise(&mut self, fault: Fault, level: Level) {
        self.faults.set(fault);
        self.level = self.level.max(level);
    }
}

/// Turns what the steps say and how the loop runs into [`HealthSample`]s.
#[derive(Debug)]
pub struct HealthMeter {
    node: Text<24>,
    process: u32,
    period_nanos: i64,
    standing_faults: Faults,
    next: Time,
    window_start: Time,
    steps: u64,
    /// Wake-up lateness of the steps in the window, as counts per microsecond.
    lateness: [u32; LATENESS_BINS],
    rate: f64,
    lateness_p99: f64,
    missed: u64,
    faults: Faults,
    level: Level,
}

const LATENESS_BINS: usize = 2000;

impl HealthMeter {
    /// A meter for `node` that steps every `period_nanos` \[ns\];
    /// `standing_faults` hold for as long as the node runs.
    pub fn new(node: &str, process: u32, period_nanos: i64, standing_faults: Faults) -> Self {
        HealthMeter {
            node: Text::new(node),
            process,
            period_nanos,
            standing_faults,
            next: Time::INVALID,
            window_start: Time::INVALID,
            steps: 0,
            lateness: [0; LATENESS_BINS],
            rate: 0.0,
            lateness_p99: 0.0,
            missed: 0,
            faults: standing_faults,
            level: Level::OK,
        }
    }

    /// Whether a step at `now` gives a sample.
    pub fn is_due(&self, now: Time) -> bool {
        !self.window_start.is_valid() || now >= self.next
    }

    /// Notes a step at `now` that began `late_nanos` \[ns\] after it was due
    /// and skipped `missed` periods. Gives a sample when one is due.
    pub fn step(
        &mut self,
        now: Time,
        late_nanos: i64,
        missed: u64,
        health: &NodeHealth,
    ) -> Option<HealthSample> {
        if !self.window_start.is_valid() {
            self.window_start = now;
            self.next = now;
            self.rate = 1e9 / self.period_nanos as f64;
        }
        self.steps += 1;
        self.missed += missed;
        let bin = (late_nanos.max(0) / 1000) as usize;
        self.lateness[bin.min(LATENESS_BINS - 1)] += 1;
        self.faults.0 |= health.faults.0;
        self.faults.set_if(Fault::DeadlineMissed, missed > 0);
        self.level = self.level.max(health.level);

        if now.nanos_since(self.window_start) >= WINDOW_NANOS {
            let window = now.seconds_since(self.window_start);
            self.rate = (self.steps - 1) as f64 / window;
            self.lateness_p99 = self.percentile(0.99);
            self.lateness.fill(0);
            self.window_start = now;
            self.steps = 1;
        }
        if !self.is_due(now) {
            return None;
        }
        self.next = now.plus_nanos(HEALTH_PERIOD_NANOS);
        let sample = HealthSample {
            stamp: now,
            rate: self.rate,
            lateness_p99: self.lateness_p99,
            input_age: health.input_age,
            missed: self.missed,
            refused: health.refused,
            lost: health.lost,
            faults: self.faults,
            node: self.node,
            message: match health.message.is_empty() {
                // Who reads a warning reads of what.
                true => {
                    let fault = self.faults.iter().next();
                    fault.map_or(Text::EMPTY, |fault| Text::new(fault.name()))
                }
                false => health.message,
            },
            process: self.process,
            level: self.level,
            reserved: [0; 3],
        };
        self.faults = self.standing_faults;
        self.level = Level::OK;
        Some(sample)
    }

    /// Steps missed since the start.
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// Lateness \[s\] below which the share `share` of the window's steps lies.
    fn percentile(&self, share: f64) -> f64 {
        let total: u64 = self.lateness.iter().map(|&count| u64::from(count)).sum();
        let wanted = (total as f64 * share).ceil() as u64;
        let mut seen = 0;
        for (micros, &count) in self.lateness.iter().enumerate() {
            seen += u64::from(count);
            if seen >= wanted {
                return micros as f64 * 1e-6;
            }
        }
        LATENESS_BINS as f64 * 1e-6
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rate_and_lateness_are_those_of_the_steps() {
        let mut meter = HealthMeter::new("servo", 7, 1_000_000, Faults::default());
        let start = Time::from_nanos(1_000_000_000_000);
        let mut last = None;
        for step in 0..=2000_i64 {
            let late = if step % 50 == 0 { 300_000 } else { 10_000 };
            let now = start.plus_nanos(step * 1_000_000);
            if let Some(sample) = meter.step(now, late, 0, &NodeHealth::default()) {
                last = Some(sample);
            }
        }
        let last = last.expect("2 s of steps give samples");
        assert!((last.rate - 1000.0).abs() < 0.5, "{}", last.rate);
        // 2 % of the steps are 300 µs late, so the 99th percentile is.
        assert!((last.lateness_p99 - 300e-6).abs() < 2e-6);
        assert_eq!(last.missed, 0);
    }

    #[test]
    fn a_fault_between_two_samples_is_not_lost() {
        let mut meter = HealthMeter::new("servo", 7, 1_000_000, Faults::default());
        let start = Time::from_nanos(1_000_000_000_000);
        let mut faulty = NodeHealth::default();
        faulty.raise(Fault::CommandInvalid, Level::WARN);
        let mut reported = 0;
        for step in 0..300_i64 {
            let health = if step == 150 {
                faulty
            } else {
                NodeHealth::default()
            };
            let now = start.plus_nanos(step * 1_000_000);
            if let Some(sample) = meter.step(now, 0, 0, &health)
                && sample.faults.has(Fault::CommandInvalid)
            {
                assert_eq!(sample.level, Level::WARN);
                assert_eq!(sample.message.as_str(), Fault::CommandInvalid.name());
                reported += 1;
            }
        }
        assert_eq!(reported, 1);
    }
}

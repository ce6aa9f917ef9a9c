//! What of an arm is implausible, from what was seen of it. Pure.

use std::fmt;

use ferntast_model::Joints;
use serde::Serialize;

use super::{
    expected::{Expected, Torque},
    finding::{Finding, Severity},
    joint::{self, JointReport},
    record::Record,
    timing::Timing,
};
use crate::driver::Reading;

/// A word of the driver that was said for less than this share of the time is a hiccup \[-\].
const HICCUP: f64 = 0.05;

/// What was seen, and what is implausible about it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// What the arm's file calls it.
    pub arm: String,
    /// What stood between it and us.
    pub driver: String,
    /// How long it was looked \[s\].
    pub seconds: f64,
    /// Readings.
    pub readings: usize,
    /// Their times.
    #[serde(flatten)]
    pub timing: Timing,
    /// Its joints; none where nothing was read.
    pub joints: Vec<JointReport>,
    /// What is implausible, the worst first.
    pub findings: Vec<Finding>,
    /// Nothing is wrong.
    pub ok: bool,
}

/// Judges what was seen.
pub fn judge(expected: &Expected, record: &Record, arm: &str, driver: &str) -> Report {
    let mut findings = Vec::new();
    for (words, seconds) in &record.words {
        let severity = match *seconds > HICCUP * record.seconds {
            true => Severity::Wrong,
            false => Severity::Doubtful,
        };
        let told = format!("the driver says for {seconds:.1} s: {words}");
        findings.push(Finding::new(severity, "driver", told));
    }
    let timing = Timing::of(record);
    let mut joints = Vec::new();
    if record.seen.is_empty() {
        let words = "nothing was read: the arm would not be moved";
        findings.push(Finding::new(Severity::Wrong, "silent", words));
    } else {
        timing.judge(expected, &mut findings);
        torque_there(expected, record, &mut findings);
        let each = 0..expected.joints.len();
        joints = each
            .map(|number| joint::look(expected, record, number, &mut findings))
            .collect();
    }
    findings.sort_by_key(|own| std::cmp::Reverse(own.severity));
    let mut report = Report {
        arm: arm.to_owned(),
        driver: driver.to_owned(),
        seconds: record.seconds,
        readings: record.seen.len(),
        timing,
        joints,
        findings,
        ok: true,
    };
    report.conclude();
    report
}

/// Contact forces need the torque that the arm's file says it measures.
fn torque_there(expected: &Expected, record: &Record, findings: &mut Vec<Finding>) {
    let has = |value: fn(&Reading) -> Option<Joints<f64>>| {
        record.seen.iter().any(|own| value(&own.reading).is_some())
    };
    let (there, words) = match expected.torque {
        Torque::Joint => (
            has(|own| own.joint_torque),
            "no joint torques come, and the arm's file says that it has sensors: set torque_sensors = false in [arm], or let the driver give them",
        ),
        Torque::Motor => (
            has(|own| own.motor_torque),
            "no motor torques come, and the arm has no other: contact forces cannot be told",
        ),
    };
    if !there {
        findings.push(Finding::new(Severity::Wrong, "torque_missing", words));
    }
}

impl Report {
    /// Adds what was found elsewhere.
    pub fn with(mut self, more: Vec<Finding>) -> Report {
        self.findings.extend(more);
        self.findings
            .sort_by_key(|own| std::cmp::Reverse(own.severity));
        self.conclude();
        self
    }

    fn conclude(&mut self) {
        let mut findings = self.findings.iter();
        self.ok = findings.all(|own| own.severity != Severity::Wrong);
    }
}

/// A number with so many decimals, without the sign of one that is zero then.
fn unsigned_zero(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if !rest.contains(|c| ('1'..='9').contains(&c)) => rest.to_owned(),
        _ => text,
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), |own| unsigned_zero(own, 2));
        let timing = &self.timing;
        writeln!(
            f,
            "{} behind {}: {} readings in {:.1} s, {:.0} Hz; gaps {} ms (99 %), {} ms at most; delay {} ms (99 %)",
            self.arm,
            self.driver,
            self.readings,
            self.seconds,
            timing.rate_hz,
            number(timing.gap_p99_ms),
            number(timing.longest_gap_ms),
            number(timing.delay_p99_ms),
        )?;
        if !self.joints.is_empty() {
            let width = self.joints.iter().map(|own| own.name.len()).max();
            let width = width.unwrap_or(0).max(5);
            writeln!(
                f,
                "\n{:width$}  {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n{:width$}  {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
                "joint",
                "position",
                "travel",
                "speed",
                "Δq/∫q̇dt",
                "torque",
                "weight",
                "",
                "[rad, m]",
                "[rad, m]",
                "[rad/s]",
                "[-]",
                "[Nm, N]",
                "[Nm, N]"
            )?;
            for own in &self.joints {
                writeln!(
                    f,
                    "{:width$}  {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
                    own.name,
                    unsigned_zero(own.position, 4),
                    unsigned_zero(own.travel, 4),
                    unsigned_zero(own.speed, 4),
                    number(own.change_per_velocity),
                    number(own.torque),
                    unsigned_zero(own.weight, 2)
                )?;
            }
        }
        writeln!(f)?;
        for finding in &self.findings {
            writeln!(f, "{finding}")?;
        }
        match self.ok {
            true => write!(f, "nothing is wrong"),
            false => write!(f, "put right what is WRONG before this arm is moved"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::unsigned_zero;

    #[test]
    fn zero_has_no_sign() {
        let told = [-0.000_04, -0.0, -0.000_06, 1.5].map(|own| unsigned_zero(own, 4));
        assert_eq!(told, ["0.0000", "0.0000", "-0.0001", "1.5000"]);
    }
}

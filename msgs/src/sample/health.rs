//! How a node is doing.

use std::str::FromStr;

use ferntast_derive::sample;

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{
        diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
        std_msgs::Header,
    },
};

use super::{Fault, Faults, Named, checks, codes::codes};

/// What stands before the node in the name of its status.
const NAME_PREFIX: &str = "ferntast: ";

codes! {
    /// Severity, as in `diagnostic_msgs/msg/DiagnosticStatus`.
    pub struct Level known "0 (ok), 1 (warning), 2 (error), 3 (stale)" {
        /// All is well.
        OK = 0 "ok",
        /// Something to look at; work goes on.
        WARN = 1 "warning",
        /// Work is stopped or wrong.
        ERROR = 2 "error",
        /// Nothing was heard of it.
        STALE = 3 "stale",
    }
}

/// How a node is doing: rate, misses, age of its input, faults.
/// One `diagnostic_msgs/msg/DiagnosticStatus` in a `DiagnosticArray` on the
/// wire.
#[sample]
pub struct HealthSample {
    /// When it was published.
    pub stamp: Time,
    /// Steps a second, measured over the last second \[Hz\].
    pub rate: f64,
    /// How late the loop woke up at the 99th percentile of the last second \[s\].
    pub lateness_p99: f64,
    /// Age of the node's main input at the last step \[s\]; NaN without one.
    pub input_age: f64,
    /// Deadlines missed since the start.
    pub missed: u64,
    /// Messages refused since the start.
    pub refused: u64,
    /// Messages lost since the start.
    pub lost: u64,
    /// Faults that are active, or were since the last message.
    #[field(bytes = 8)]
    pub faults: Faults,
    /// The node.
    pub node: Text<24>,
    /// What it has to say, for people.
    pub message: Text<96>,
    /// Operating-system process; 0 in lockstep.
    pub process: u32,
    /// Severity.
    pub level: Level,
}

impl HealthSample {
    /// A node that is well and has done nothing yet.
    pub fn new(stamp: Time, node: &str) -> HealthSample {
        HealthSample {
            stamp,
            rate: 0.0,
            lateness_p99: 0.0,
            input_age: f64::NAN,
            missed: 0,
            refused: 0,
            lost: 0,
            faults: Faults::default(),
            node: Text::new(node),
            message: Text::EMPTY,
            process: 0,
            level: Level::OK,
            reserved: [0; 3],
        }
    }
}

impl Message for HealthSample {
    type Ros = DiagnosticArray;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> DiagnosticArray {
        // `{}` writes the shortest digits that read back as the same number.
        let mut values = vec![
            KeyValue::new("rate [Hz]", self.rate.to_string()),
            KeyValue::new("lateness p99 [s]", self.lateness_p99.to_string()),
            KeyValue::new("input age [s]", self.input_age.to_string()),
            KeyValue::new("missed", self.missed.to_string()),
            KeyValue::new("refused", self.refused.to_string()),
            KeyValue::new("lost", self.lost.to_string()),
            KeyValue::new("process", self.process.to_string()),
        ];
        let fault = |fault: Fault| KeyValue::new("fault", fault.name());
        values.extend(self.faults.iter().map(fault));
        DiagnosticArray {
            header: Header::new(self.stamp, ""),
            status: vec![DiagnosticStatus {
                level: self.level.0,
                name: format!("{NAME_PREFIX}{}", self.node),
                message: self.message.as_str().to_owned(),
                hardware_id: self.node.as_str().to_owned(),
                values,
            }],
        }
    }

    /// Takes the message of one node of ours. Keys that are not known do not
    /// count, so that later versions may add some.
    fn from_ros(ros: &DiagnosticArray) -> Result<HealthSample, InvalidMessage> {
        let [status] = ros.status.as_slice() else {
            return Err(InvalidMessage::WrongLength {
                field: "status",
                found: ros.status.len(),
                expected: 1,
            });
        };
        let Some(node) = status.name.strip_prefix(NAME_PREFIX) else {
            return Err(checks::unknown(
                "status.name",
                &status.name,
                "ferntast: <node>",
            ));
        };
        let values = &status.values;
        let sample = HealthSample {
            stamp: ros.header.time(),
            rate: value(values, "rate [Hz]")?,
            lateness_p99: value(values, "lateness p99 [s]")?,
            input_age: value(values, "input age [s]")?,
            missed: value(values, "missed")?,
            refused: value(values, "refused")?,
            lost: value(values, "lost")?,
            faults: faults(values)?,
            node: Text::new(node),
            message: Text::new(&status.message),
            process: value(values, "process")?,
            level: Level(status.level),
            reserved: [0; 3],
        };
        sample.check()?;
        Ok(sample)
    }

    /// NaN is valid for the age of the input: the node has none.
    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite("rate [Hz]", &[self.rate])?;
        checks::finite("lateness p99 [s]", &[self.lateness_p99])?;
        checks::number("input age [s]", self.input_age, true, false)?;
        if self.faults != self.faults.iter().collect() {
            let bits = format!("{:#x}", self.faults.0);
            return Err(checks::unknown("fault", bits, Fault::KNOWN));
        }
        Named::check(self.level, "status.level")
    }
}

/// The number under `key`.
fn value<T: FromStr>(values: &[KeyValue], key: &'static str) -> Result<T, InvalidMessage> {
    let entry = values.iter().find(|entry| entry.key == key);
    let text = entry.map_or("(missing)", |entry| &entry.value);
    text.parse()
        .map_err(|_| checks::unknown(key, text, "a number"))
}

/// The faults among `values`.
fn faults(values: &[KeyValue]) -> Result<Faults, InvalidMessage> {
    let fault = |entry: &KeyValue| {
        Fault::from_name(&entry.value)
            .ok_or_else(|| checks::unknown("fault", &entry.value, Fault::KNOWN))
    };
    let entries = values.iter().filter(|entry| entry.key == "fault");
    entries.map(fault).collect()
}

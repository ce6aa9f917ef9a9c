//! The twin of one joint: samples in, rows out.

use std::collections::VecDeque;

use ferntast_identification::twin::{Flag, Twin, TwinOutput, TwinSample};
use ferntast_msgs::{
    Text, Time,
    sample::{JointFields, JointSample, TwinParametersSample},
};

use super::align::{Aligned, Alignment};
use super::assess::{Assessing, Assessor};
use super::goes_with::GoesWith;
use super::open::TwinModel;
use super::report;

/// Between two messages on `/twin/parameters`, of the samples' own time \[s\].
const PARAMETERS_EVERY: f64 = 0.1;
/// Rows that may wait to be published: a step publishes one.
const MAX_READY: usize = 256;

/// A row that is to be published.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) stamp: Time,
    pub(super) own: TwinOutput,
}

/// The twin of a joint.
pub(super) struct JointTwin {
    pub(super) twin: Twin,
    /// Its joint, from 0.
    pub(super) joint: usize,
    name: Text<32>,
    takes_joint_torque: bool,
    takes_temperature: bool,
    alignment: Alignment,
    /// Stamp of the first sample: the twin's times count from it.
    origin: Option<Time>,
    rows: Vec<TwinOutput>,
    ready: VecDeque<TwinOutput>,
    lost: u64,
    pub(super) assessor: Assessor,
    goes_with: GoesWith,
    parameters_due: f64,
    /// What it said last, and in words: empty while all is well.
    pub(super) said: Option<TwinParametersSample>,
    pub(super) words: Text<96>,
    /// What is wrong with the newest samples.
    pub(super) flag: Option<Flag>,
}

impl JointTwin {
    /// A twin of `model`; `assessing` says where the lab works.
    pub(super) fn new(model: TwinModel, assessing: Assessing) -> Self {
        let name = model.joints.get(model.joint).unwrap_or_default();
        Self {
            name: Text::new(name),
            twin: model.twin,
            joint: model.joint,
            takes_joint_torque: model.joint_torque,
            takes_temperature: model.temperature,
            alignment: Alignment::new(model.joint),
            origin: None,
            rows: Vec::new(),
            ready: VecDeque::new(),
            lost: 0,
            assessor: Assessor::new(assessing),
            goes_with: GoesWith::default(),
            parameters_due: f64::NEG_INFINITY,
            said: None,
            words: Text::EMPTY,
            flag: None,
        }
    }

    /// Its joint's name.
    pub(super) fn name(&self) -> &str {
        self.name.as_str()
    }

    /// Rows and positions that were lost.
    pub(super) fn lost(&self) -> u64 {
        self.lost + self.alignment.dropped()
    }

    /// Whether it waits for its first sample though it needs a temperature.
    pub(super) fn waits(&self) -> bool {
        self.takes_temperature && self.origin.is_none()
    }

    /// A step begins.
    pub(super) fn begin(&mut self) {
        self.flag = None;
    }

    /// Takes `/follower/measured_js`, in the order of the arm's joints; `None` where it is of
    /// others.
    pub(super) fn measured(&mut self, sample: Option<&JointSample>) {
        let needed = match self.takes_joint_torque {
            true => JointFields::POSITION.with(JointFields::EFFORT),
            false => JointFields::POSITION,
        };
        match sample {
            Some(sample) if sample.fields.has(needed) => self.alignment.measured(sample),
            _ => self.flag = Some(Flag::NotFinite),
        }
    }

    /// Takes `/follower/motor_js`, and the joint's `temperature` now \[°C\].
    pub(super) fn motors<'a>(
        &mut self,
        samples: impl Iterator<Item = &'a JointSample>,
        temperature: Option<f64>,
    ) {
        let mut aligned = Vec::new();
        for sample in samples {
            if sample.fields.has(JointFields::EFFORT) {
                self.alignment.motor(sample, |own| aligned.push(own));
            }
        }
        let temperature = temperature.filter(|_| self.takes_temperature);
        // A model with a temperature needs one from the first sample on.
        if self.takes_temperature && temperature.is_none() {
            return;
        }
        let mut flag = None;
        for own in aligned {
            flag = self.push(own, temperature).or(flag);
        }
        self.flag = flag.or(self.flag);
    }

    /// Takes a sample; gives what is wrong with it.
    fn push(&mut self, aligned: Aligned, temperature: Option<f64>) -> Option<Flag> {
        let origin = *self.origin.get_or_insert(aligned.stamp);
        let sample = TwinSample {
            time: aligned.stamp.seconds_since(origin),
            position: aligned.position,
            motor_torque: aligned.motor_torque,
            joint_torque: self.takes_joint_torque.then_some(aligned.joint_torque),
            temperature,
        };
        let flag = self.twin.push(&sample, &mut self.rows);
        for row in self.rows.drain(..) {
            self.assessor.note(row.time, row.slides);
            if row.slides {
                self.goes_with.note(&row);
            }
            self.ready.push_back(row);
            if self.ready.len() > MAX_READY {
                self.ready.pop_front();
                self.lost += 1;
            }
            let newest = self.ready.back().map_or(0.0, |row| row.time);
            self.assessor.step(&self.twin, newest);
        }
        flag
    }

    /// The oldest row that waits.
    pub(super) fn front(&self) -> Option<Row> {
        let (own, origin) = (self.ready.front()?.clone(), self.origin?);
        let stamp = origin.plus_nanos((own.time * 1e9).round() as i64);
        Some(Row { stamp, own })
    }

    /// It was published.
    pub(super) fn pop(&mut self) {
        self.ready.pop_front();
    }

    /// What it says at `row`, when it is time to.
    pub(super) fn says(&mut self, row: &Row) -> Option<TwinParametersSample> {
        // Time may jump back, as where a recording begins again.
        let early = self.parameters_due - row.own.time;
        if early > 0.0 && early <= 2.0 * PARAMETERS_EVERY {
            return None;
        }
        self.parameters_due = row.own.time + PARAMETERS_EVERY;
        let (sample, words) = report::of(
            &self.twin,
            self.name.as_str(),
            row.stamp,
            self.assessor.newest(),
            self.goes_with.name(),
        );
        self.said = Some(sample);
        self.words = words;
        self.said
    }
}

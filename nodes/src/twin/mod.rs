//! The twin of a joint as a node: the model of an experiment of the lab, held
//! against the arm while it moves, live or played back.
//!
//! It commands nothing and is no part of the control path: its step allocates
//! (it keeps what came in for the lab), and its process has no real-time
//! priority. Everything but the thread on which the lab works in a live
//! process is a function of the samples and their stamps, so that a recording
//! played back gives what was given live.

mod align;
mod assess;
mod goes_with;
mod open;
mod report;
#[cfg(test)]
mod tests;

pub use assess::Assessing;
pub use open::{TwinModel, TwinOpenError, open};
pub use report::{ChangeSummary, ParameterSummary, TwinSummary};

use std::collections::VecDeque;

use ferntast_identification::twin::{Flag, Twin, TwinOutput, TwinSample};
use ferntast_msgs::{
    Text, Time,
    sample::{
        Fault, JointFields, JointNames, JointSample, Level, TemperatureSample,
        TwinParametersSample, TwinVerdict,
    },
};

use crate::{
    graph::Build,
    node::{Newest, Node, Ticking, ports},
    process::NodeError,
};

use align::{Aligned, Alignment};
use assess::Assessor;
use goes_with::GoesWith;

/// No measurement for this long \[s\] is a fault.
const MEASUREMENT_WATCHDOG: f64 = 0.1;
/// Between two messages on `/twin/parameters`, of the samples' own time \[s\].
const PARAMETERS_EVERY: f64 = 0.1;
/// Rows that may wait to be published: a step publishes one.
const MAX_READY: usize = 256;

ports! {
    /// The twin's topics.
    TwinPorts for TwinNode;
    /// What the twin takes.
    input TwinInput {
        measured_js: Batch<JointSample> = FOLLOWER_MEASURED_JS,
        motor_js: Batch<JointSample> = FOLLOWER_MOTOR_JS,
        temperature: PerJoint<Newest<TemperatureSample>> = FOLLOWER_JOINT_TEMPERATURE,
    }
    /// What the twin gives.
    output TwinNodeOutput {
        predicted: JointSample = TWIN_MOTOR_JS,
        residual: JointSample = TWIN_RESIDUAL_JS,
        parameters: TwinParametersSample = TWIN_PARAMETERS,
    }
}

/// Name of the node.
pub const NAME: &str = "twin";

/// The node of the graph.
///
/// # Errors
///
/// No experiment is named, or it cannot be followed; a topic that cannot be
/// opened.
pub fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let path = build.session.twin.as_deref().ok_or(NodeError::NoTwin)?;
    let joints = build.session.joints();
    let model = open(path, joints).map_err(NodeError::own)?;
    let assessing = match build.virtual_time {
        true => Assessing::Inline,
        false => Assessing::OnThread,
    };
    let ports = TwinPorts::connect(build.bus, &joints)?;
    build.join(TwinNode::new(model, assessing), ports)
}

/// The twin of a joint.
pub struct TwinNode {
    twin: Twin,
    joints: JointNames,
    joint: usize,
    takes_joint_torque: bool,
    takes_temperature: bool,
    alignment: Alignment,
    /// Stamp of the first sample: the twin's times count from it.
    origin: Option<Time>,
    heard: Option<Time>,
    rows: Vec<TwinOutput>,
    ready: VecDeque<TwinOutput>,
    lost: u64,
    assessor: Assessor,
    goes_with: GoesWith,
    parameters_due: f64,
    said: Option<TwinParametersSample>,
    words: Text<96>,
}

impl TwinNode {
    /// A twin of `model`; `assessing` says where the lab works.
    pub fn new(model: TwinModel, assessing: Assessing) -> Self {
        Self {
            twin: model.twin,
            joints: model.joints,
            joint: model.joint,
            takes_joint_torque: model.joint_torque,
            takes_temperature: model.temperature,
            alignment: Alignment::new(model.joint),
            origin: None,
            heard: None,
            rows: Vec::new(),
            ready: VecDeque::new(),
            lost: 0,
            assessor: Assessor::new(assessing),
            goes_with: GoesWith::default(),
            parameters_due: f64::NEG_INFINITY,
            said: None,
            words: Text::EMPTY,
        }
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
            self.assessor.step(&self.twin, row_time(&self.ready));
        }
        flag
    }

    fn publish(&mut self, output: &mut TwinNodeOutput) {
        let (Some(row), Some(origin)) = (self.ready.pop_front(), self.origin) else {
            return;
        };
        let stamp = origin.plus_nanos((row.time * 1e9).round() as i64);
        let joint_sample = |effort: f64| {
            let mut sample = JointSample::zero(self.joints, stamp);
            for (values, value) in [
                (&mut sample.position, row.position),
                (&mut sample.velocity, row.velocity),
                (&mut sample.effort, effort),
            ] {
                if let Some(place) = values.get_mut(self.joint) {
                    *place = value;
                }
            }
            sample
        };
        output.predicted = Some(joint_sample(row.predicted));
        if row.slides {
            output.residual = Some(joint_sample(row.measured - row.predicted));
        }
        // Time may jump back, as where a recording begins again.
        let early = self.parameters_due - row.time;
        if early <= 0.0 || early > 2.0 * PARAMETERS_EVERY {
            self.parameters_due = row.time + PARAMETERS_EVERY;
            let (sample, words) = report::of(
                &self.twin,
                self.joints.get(self.joint).unwrap_or_default(),
                stamp,
                self.assessor.newest(),
                self.goes_with.name(),
            );
            output.parameters = Some(sample);
            self.said = Some(sample);
            self.words = words;
        }
    }
}

/// Time of the newest row \[s\].
fn row_time(ready: &VecDeque<TwinOutput>) -> f64 {
    ready.back().map_or(0.0, |row| row.time)
}

impl Node for TwinNode {
    type Input = TwinInput;
    type Output = TwinNodeOutput;

    fn step(&mut self, now: Time, input: &TwinInput, output: &mut TwinNodeOutput) {
        let temperature = input
            .temperature
            .get(self.joint)
            .and_then(|newest| newest.message)
            .map(|message| message.temperature)
            .filter(|_| self.takes_temperature);
        let needed = match self.takes_joint_torque {
            true => JointFields::POSITION.with(JointFields::EFFORT),
            false => JointFields::POSITION,
        };
        let mut flags = [None; 2];
        for sample in input.measured_js.iter() {
            self.heard = Some(now);
            match sample.in_order_of(&self.joints) {
                Some(sample) if sample.fields.has(needed) => self.alignment.measured(&sample),
                _ => flags[0] = Some(Flag::NotFinite),
            }
        }
        let mut aligned = Vec::new();
        for sample in input.motor_js.iter() {
            if sample.fields.has(JointFields::EFFORT) {
                self.alignment.motor(sample, |own| aligned.push(own));
            }
        }
        // A model with a temperature needs one from the first sample on.
        if !self.takes_temperature || temperature.is_some() {
            for own in aligned {
                flags[1] = self.push(own, temperature).or(flags[1]);
            }
        }
        self.publish(output);
        self.tell(now, flags[1].or(flags[0]), output);
    }
}

impl TwinNode {
    /// Says on `/diagnostics` how it is.
    fn tell(&self, now: Time, flag: Option<Flag>, output: &mut TwinNodeOutput) {
        let health = &mut output.health;
        health.lost += self.lost + self.alignment.dropped();
        let silence = self.heard.map(|heard| now.seconds_since(heard));
        health.input_age = silence.unwrap_or(f64::NAN);
        if silence.is_none_or(|silence| silence > MEASUREMENT_WATCHDOG) {
            health.raise(Fault::MeasurementSilent, Level::WARN);
            health.message = Text::new("no /follower/measured_js: is the arm running?");
            return;
        }
        if self.takes_temperature && self.origin.is_none() {
            health.message = Text::new("waits for temperature and motor torque");
        }
        if let Some(said) = &self.said {
            if said.out_of_band == 1 {
                health.raise(Fault::ResidualOutOfBand, Level::WARN);
            }
            if [TwinVerdict::MISSING, TwinVerdict::UNEXPLAINED].contains(&said.verdict) {
                health.raise(Fault::ModelIncomplete, Level::WARN);
            }
            health.message = self.words;
        }
        let (fault, words) = match flag {
            None => return,
            Some(Flag::Gap) => {
                health.message = Text::new("time jumped: the twin's filters start over");
                return;
            }
            Some(Flag::NotFinite) => (
                Fault::MeasurementInvalid,
                "/follower/measured_js lacks position or effort, they are no numbers, or of other joints",
            ),
            Some(Flag::TimeBackwards) => (
                Fault::MeasurementInvalid,
                "/follower/measured_js: its stamps do not advance",
            ),
            Some(Flag::PositionStuck) => (
                Fault::MeasurementInvalid,
                "the position stays the same while the motor torque changes: check the encoder",
            ),
            Some(Flag::JointTorqueStuck) => (
                Fault::TorqueStuck,
                "the joint turns, but its torque stays the same: check its torque sensor",
            ),
        };
        health.raise(fault, Level::WARN);
        health.message = Text::new(words);
    }
}

//! Twins of joints as a node: models of experiments of the lab, one for a joint at most,
//! held against the arm while it moves, live or played back.
//!
//! It commands nothing and is no part of the control path: its step allocates
//! (it keeps what came in for the lab), and its process has no real-time
//! priority. Everything but the thread on which the lab works in a live
//! process is a function of the samples and their stamps, so that a recording
//! played back gives what was given live.

mod align;
mod assess;
mod goes_with;
mod joint;
mod last_words;
mod open;
mod report;
#[cfg(test)]
mod tests;

pub use assess::Assessing;
pub use last_words::LastWords;
pub use open::{TwinModel, TwinOpenError, open, open_all};
pub use report::{ChangeSummary, ParameterSummary, TwinSummary};

use ferntast_identification::twin::Flag;
use ferntast_msgs::{
    Text, Time,
    sample::{
        Fault, JointNames, JointSample, Level, TemperatureSample, TwinParametersSample, TwinVerdict,
    },
};

use crate::{
    graph::Build,
    node::{Newest, Node, NodeHealth, Ticking, ports},
    process::NodeError,
};

use joint::{JointTwin, Row};

/// No measurement for this long \[s\] is a fault.
const MEASUREMENT_WATCHDOG: f64 = 0.1;

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
/// No experiment is named, or one cannot be followed; a topic that cannot be
/// opened.
pub fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let paths = &build.session.twins;
    if paths.is_empty() {
        return Err(NodeError::NoTwin);
    }
    let joints = build.session.joints();
    let models = open_all(paths, joints).map_err(NodeError::own)?;
    let assessing = match build.virtual_time {
        true => Assessing::Inline,
        false => Assessing::OnThread,
    };
    let ports = TwinPorts::connect(build.bus, &joints)?;
    build.join(TwinNode::new(joints, models, assessing), ports)
}

/// The twins of an arm's joints.
pub struct TwinNode {
    joints: JointNames,
    twins: Vec<JointTwin>,
    heard: Option<Time>,
}

impl TwinNode {
    /// Twins of `models`, of an arm of those joints; `assessing` says where the lab works.
    pub fn new(joints: JointNames, models: Vec<TwinModel>, assessing: Assessing) -> Self {
        let twins = models.into_iter();
        Self {
            joints,
            twins: twins.map(|own| JointTwin::new(own, assessing)).collect(),
            heard: None,
        }
    }

    /// Publishes the oldest rows that wait, of one stamp, and what one of their twins says.
    fn publish(&mut self, output: &mut TwinNodeOutput) {
        let stamps = self.twins.iter().filter_map(|own| own.front());
        let Some(stamp) = stamps.map(|row| row.stamp).min() else {
            return;
        };
        let zero = JointSample::zero(self.joints, stamp);
        let (mut predicted, mut residual, mut slides) = (zero, zero, false);
        for own in &mut self.twins {
            let Some(row) = own.front().filter(|row| row.stamp == stamp) else {
                continue;
            };
            own.pop();
            set(&mut predicted, own.joint, &row, row.own.predicted);
            if row.own.slides {
                slides = true;
                let left = row.own.measured - row.own.predicted;
                set(&mut residual, own.joint, &row, left);
            }
            // One message a step: another twin says its own with its next row.
            if output.parameters.is_none() {
                output.parameters = own.says(&row);
            }
        }
        output.predicted = Some(predicted);
        output.residual = slides.then_some(residual);
    }
}

/// A joint's row in a message, with that effort \[Nm\].
fn set(sample: &mut JointSample, joint: usize, row: &Row, effort: f64) {
    for (values, value) in [
        (&mut sample.position, row.own.position),
        (&mut sample.velocity, row.own.velocity),
        (&mut sample.effort, effort),
    ] {
        if let Some(place) = values.get_mut(joint) {
            *place = value;
        }
    }
}

impl Node for TwinNode {
    type Input = TwinInput;
    type Output = TwinNodeOutput;

    fn step(&mut self, now: Time, input: &TwinInput, output: &mut TwinNodeOutput) {
        self.twins.iter_mut().for_each(JointTwin::begin);
        for sample in input.measured_js.iter() {
            self.heard = Some(now);
            let sample = sample.in_order_of(&self.joints);
            for own in &mut self.twins {
                own.measured(sample.as_deref());
            }
        }
        for own in &mut self.twins {
            let temperature = input
                .temperature
                .get(own.joint)
                .and_then(|newest| newest.message)
                .map(|message| message.temperature);
            own.motors(input.motor_js.iter(), temperature);
        }
        self.publish(output);
        self.tell(now, output);
    }
}

impl TwinNode {
    /// Says on `/diagnostics` how they are.
    fn tell(&self, now: Time, output: &mut TwinNodeOutput) {
        let health = &mut output.health;
        health.lost += self.twins.iter().map(JointTwin::lost).sum::<u64>();
        let silence = self.heard.map(|heard| now.seconds_since(heard));
        health.input_age = silence.unwrap_or(f64::NAN);
        if silence.is_none_or(|silence| silence > MEASUREMENT_WATCHDOG) {
            health.raise(Fault::MeasurementSilent, Level::WARN);
            health.message = Text::new("no /follower/measured_js: is the arm running?");
            return;
        }
        let mut message = Text::EMPTY;
        for own in &self.twins {
            let words = tell(own, health);
            if words.is_empty() {
                continue;
            }
            message = match (self.twins.len(), message.is_empty()) {
                (1, _) => words,
                (_, true) => Text::display(format_args!("{}: {words}", own.name())),
                (_, false) => Text::display(format_args!("{message}; {}: {words}", own.name())),
            };
        }
        health.message = message;
    }
}

/// How a twin is: raises its faults and gives what there is to say.
fn tell(own: &JointTwin, health: &mut NodeHealth) -> Text<96> {
    let mut words = match own.waits() {
        true => Text::new("waits for temperature and motor torque"),
        false => Text::EMPTY,
    };
    if let Some(said) = &own.said {
        if said.out_of_band == 1 {
            health.raise(Fault::ResidualOutOfBand, Level::WARN);
        }
        if [TwinVerdict::MISSING, TwinVerdict::UNEXPLAINED].contains(&said.verdict) {
            health.raise(Fault::ModelIncomplete, Level::WARN);
        }
        words = own.words;
    }
    let (fault, told) = match own.flag {
        None => return words,
        Some(Flag::Gap) => return Text::new("time jumped: the twin's filters start over"),
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
    Text::new(told)
}

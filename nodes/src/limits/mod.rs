//! Warns while the arm is still within its limits: a joint near the end of its
//! range, a joint torque near the end of its sensor's, a joint that gets hot.
//!
//! Servo and estimator act on limits, and say so once they are reached; an
//! operator who hears of them before can turn back. What is near stands on
//! `/diagnostics` with the margin that is left. The node commands nothing.

#[cfg(test)]
mod tests;

use ferntast_config::{Believed, LimitsSection};
use ferntast_model::joint::JointParameters;
use ferntast_msgs::{
    Text, Time,
    sample::{JointNames, JointSample, Level, TemperatureSample},
};

use crate::{
    graph::Build,
    node::{Newest, Node, Ticking, ports},
    process::NodeError,
};

/// Measurements older than this \[s\] say nothing of where the arm is.
const MEASUREMENT_LIFE: f64 = 0.1;

ports! {
    /// Topics of the node.
    LimitsPorts for LimitsNode;
    /// What it takes.
    input LimitsInput {
        measured_js: Newest<JointSample> = FOLLOWER_MEASURED_JS,
        temperature: PerJoint<Newest<TemperatureSample>> = FOLLOWER_JOINT_TEMPERATURE,
    }
    /// What it publishes: its health alone.
    output LimitsOutput {}
}

/// The node of the graph.
///
/// # Errors
///
/// A topic that cannot be opened.
pub fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    // Run by hand it may have no section of the scenario.
    let section = loaded.scenario.limits.unwrap_or_default();
    let node = LimitsNode::new(&loaded.arm.model, section);
    let ports = LimitsPorts::connect(build.bus, &build.session.joints())?;
    build.join(node, ports)
}

/// Watches the arm's measurements against its limits.
pub struct LimitsNode {
    names: JointNames,
    joints: Vec<JointParameters>,
    section: LimitsSection,
}

impl LimitsNode {
    /// A node that knows the arm's limits from `model`.
    pub fn new(model: &Believed, section: LimitsSection) -> LimitsNode {
        LimitsNode {
            names: model.joint_names(),
            joints: model.joints().to_vec(),
            section,
        }
    }

    /// What is near at the joint of that place and name, the worst last.
    fn near(
        &self,
        index: usize,
        name: &str,
        sample: Option<&JointSample>,
        temperature: Option<f64>,
    ) -> [Option<Text<96>>; 3] {
        let limits = &self.joints[index];
        let of = |values: Option<&[f64]>| values.and_then(|own| own.get(index)).copied();
        let position = of(sample.map(|own| own.position.as_slice()));
        let torque = of(sample.map(|own| own.effort.as_slice()));
        let hot = temperature.filter(|own| *own > self.section.temperature);
        let range = limits.torque_sensor_range;
        let strained = torque.filter(|own| own.abs() > self.section.torque_share * range);
        let margin = position.map(|own| {
            let lower = own - limits.position_lower;
            let upper = limits.position_upper - own;
            lower.min(upper)
        });
        let margin = margin.filter(|own| *own < self.section.position_margin);
        [
            hot.map(|own| Text::display(format_args!("{name} is at {own:.0} °C"))),
            strained.map(|own| {
                let own = own.abs();
                Text::display(format_args!(
                    "{name} bears {own:.1} Nm, its sensor's range is {range:.1} Nm"
                ))
            }),
            margin.map(|own| {
                Text::display(format_args!(
                    "{name} is {own:.2} rad from the end of its range"
                ))
            }),
        ]
    }
}

impl Node for LimitsNode {
    type Input = LimitsInput;
    type Output = LimitsOutput;

    fn step(&mut self, now: Time, input: &LimitsInput, output: &mut LimitsOutput) {
        let health = &mut output.health;
        let silence = input.measured_js.silence(now);
        if silence.is_finite() {
            health.input_age = silence;
        }
        let sample = input
            .measured_js
            .message
            .as_ref()
            .filter(|_| silence <= MEASUREMENT_LIFE)
            .and_then(|own| own.in_order_of(&self.names));
        for (index, name) in self.names.iter().enumerate() {
            let temperature = input.temperature.get(index).and_then(|own| own.message);
            let temperature = temperature.map(|own| own.temperature);
            for words in self
                .near(index, name, sample.as_deref(), temperature)
                .into_iter()
                .flatten()
            {
                health.level = health.level.max(Level::WARN);
                health.message = words;
            }
        }
    }
}

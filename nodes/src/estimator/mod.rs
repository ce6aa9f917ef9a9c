//! The contact-force estimator as a node.

mod by_motors;
mod either;

use by_motors::ByMotors;
use either::{Estimator, Told};
use ferntast_config::Believed;
use ferntast_control::estimator::{EstimatorParameters, Form, JointMeasurement};
use ferntast_control::servo::TakeOverConfig;
use ferntast_model::{JointCount, Joints, ParameterError};
use ferntast_msgs::{
    Text, Time,
    sample::{
        ContactStateSample, Fault, Frame, FrictionStatusSample, JointFields, JointNames,
        JointSample, Level, PoseSample, TemperatureSample, TransformsSample, WrenchSample,
    },
};

use crate::{
    graph::Build,
    node::{Newest, Node, NodeHealth, Ticking, ports},
    process::NodeError,
};

/// No measurement for this long \[s\] is a fault.
const MEASUREMENT_WATCHDOG: f64 = 0.010;
/// From one set of transforms to the next \[ns\]: 50 Hz, for the eye.
const TRANSFORMS_PERIOD_NANOS: i64 = 20_000_000;

ports! {
    /// The estimator's topics.
    EstimatorPorts for EstimatorNode;
    /// What the estimator takes.
    input EstimatorInput {
        measured_js: Newest<JointSample> = FOLLOWER_MEASURED_JS,
        motor_js: Newest<JointSample> = FOLLOWER_MOTOR_JS,
        friction: PerJoint<Newest<FrictionStatusSample>> = FOLLOWER_JOINT_FRICTION,
        temperature: PerJoint<Newest<TemperatureSample>> = FOLLOWER_JOINT_TEMPERATURE,
    }
    /// What the estimator gives.
    output EstimatorOutput {
        measured_cp: PoseSample = FOLLOWER_MEASURED_CP,
        measured_cf: WrenchSample = FOLLOWER_MEASURED_CF,
        contact_cf: WrenchSample = FOLLOWER_CONTACT_CF,
        contact_state: ContactStateSample = FOLLOWER_CONTACT_STATE,
        transforms: TransformsSample = TF,
    }
}

/// The node of the graph.
///
/// # Errors
///
/// A parameter out of its bounds, a topic that cannot be opened.
pub fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    let (arm, servo) = (&loaded.arm, &loaded.scenario.servo);
    let node = EstimatorNode::new(&arm.model, &arm.estimator, servo.take_over)?;
    let ports = EstimatorPorts::connect(build.bus, &build.session.joints())?;
    build.join(node, ports)
}

/// The contact-force estimator.
pub struct EstimatorNode {
    joints: JointNames,
    estimator: Estimator,
    /// Joint torques, where no sensor tells them.
    by_motors: Option<ByMotors>,
    last: Option<Time>,
    transforms_due: Time,
}

impl EstimatorNode {
    /// An estimator that believes in `model`; by motor currents it takes over what the servo
    /// takes over of friction, within the bounds `take_over`.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds.
    pub fn new(
        model: &Believed,
        parameters: &EstimatorParameters,
        take_over: TakeOverConfig,
    ) -> Result<EstimatorNode, ParameterError> {
        let by_motors = (parameters.form == Form::MotorCurrent)
            .then(|| ByMotors::new(model.joints(), parameters, take_over));
        Ok(EstimatorNode {
            joints: model.joint_names(),
            by_motors: by_motors.transpose()?,
            estimator: Estimator::new(model, parameters)?,
            last: None,
            transforms_due: Time::INVALID,
        })
    }
}

impl Node for EstimatorNode {
    type Input = EstimatorInput;
    type Output = EstimatorOutput;

    fn step(&mut self, now: Time, input: &EstimatorInput, output: &mut EstimatorOutput) {
        let silence = input.measured_js.silence(now);
        output.health.input_age = if silence.is_finite() {
            silence
        } else {
            f64::NAN
        };
        if silence > MEASUREMENT_WATCHDOG {
            output.health.raise(Fault::MeasurementSilent, Level::WARN);
            output.health.message = Text::new("no /follower/measured_js: is the arm running?");
        }
        let Some(measured) = input.measured_js.fresh() else {
            return;
        };
        // Time passes by the stamps, so that playback at any speed gives the same.
        let stamp = measured.stamp;
        let passed = self.last.map(|last| stamp.seconds_since(last));
        self.last = Some(stamp);
        let Some(dt) = passed.filter(|&dt| dt > 0.0) else {
            return;
        };
        let measured = measured.in_order_of(&self.joints);
        let joints = self.estimator.joints();
        let estimate = match &mut self.by_motors {
            None => {
                let measured = measured.as_deref();
                let measurement = JointMeasurement {
                    motor_position: positions(joints, measured),
                    joint_torque: efforts(joints, measured),
                };
                self.estimator.step(dt, &measurement)
            }
            Some(by_motors) => {
                by_motors.hear(input);
                let motor = input.motor_js.message.as_ref();
                let motor = motor.and_then(|own| own.in_order_of(&self.joints));
                let torque = by_motors.step(dt, joints, measured.as_deref(), motor.as_deref());
                self.estimator.step_by_motors(dt, &torque)
            }
        };
        self.judge(&estimate, &mut output.health);
        publish(stamp, &estimate, output);
        // By the stamps too, that played back it is the same; a jump back starts over.
        let due = self.transforms_due;
        if stamp >= due || due.seconds_since(stamp) > 1e-9 * TRANSFORMS_PERIOD_NANOS as f64 {
            self.transforms_due = stamp.plus_nanos(TRANSFORMS_PERIOD_NANOS);
            output.transforms = Some(self.estimator.transforms(stamp, &estimate));
        }
    }
}

/// Positions of so many joints \[rad\]; no numbers where `sample` lacks them: the estimator
/// takes that for what it is, no measurement.
fn positions(joints: JointCount, sample: Option<&JointSample>) -> Joints<f64> {
    let sample = sample.filter(|own| own.fields.has(JointFields::POSITION));
    sample.map_or(Joints::filled(joints, f64::NAN), |own| {
        Joints::from_places(joints, own.position)
    })
}

/// Torques of so many joints \[Nm\]; no numbers where `sample` lacks them.
fn efforts(joints: JointCount, sample: Option<&JointSample>) -> Joints<f64> {
    let sample = sample.filter(|own| own.fields.has(JointFields::EFFORT));
    sample.map_or(Joints::filled(joints, f64::NAN), |own| {
        Joints::from_places(joints, own.effort)
    })
}

impl EstimatorNode {
    /// Reports what makes an estimate unusable, with a reason for people: the
    /// last one that holds.
    fn judge(&self, estimate: &Told, health: &mut NodeHealth) {
        let [corner, singular, saturated, invalid] = reasons(estimate);
        let tell = |health: &mut NodeHealth, (active, fault, reason)| {
            if active {
                health.raise(fault, Level::WARN);
                health.message = Text::new(reason);
            }
        };
        tell(health, corner);
        tell(health, singular);
        for (joint, stuck) in estimate.state.stuck.iter().enumerate() {
            if *stuck && let Some(joint) = self.joints.get(joint) {
                health.raise(Fault::TorqueStuck, Level::WARN);
                health.message = Text::display(format_args!(
                    "{joint} turns, but its torque stays the same: check its torque sensor"
                ));
            }
        }
        tell(health, saturated);
        tell(health, invalid);
    }
}

/// What makes an estimate unusable, of whatever joint.
fn reasons(estimate: &Told) -> [(bool, Fault, &'static str); 4] {
    [
        (
            estimate.state.corner,
            Fault::ContactAmbiguous,
            "the tip touches two surfaces: only measured_cf holds",
        ),
        (
            estimate.state.singular,
            Fault::Singular,
            match estimate.planar {
                true => "the elbow is stretched or folded: no force can be estimated; bend it",
                false => "the tip can hardly move one way: no force can be estimated; bend the arm",
            },
        ),
        (
            estimate.state.saturated,
            Fault::TorqueSaturated,
            "a torque sensor is at the end of its range: press less",
        ),
        (
            estimate.state.input_invalid,
            Fault::MeasurementInvalid,
            "/follower/measured_js lacks position or effort, they are no numbers, or of other joints",
        ),
    ]
}

fn publish(stamp: Time, estimate: &Told, output: &mut EstimatorOutput) {
    let contact = &estimate.state;
    output.measured_cp = Some(PoseSample {
        orientation: estimate.orientation,
        ..PoseSample::at(stamp, Frame::FOLLOWER_BASE, estimate.tip)
    });
    output.measured_cf = Some(WrenchSample {
        torque: estimate.torque,
        ..WrenchSample::force(stamp, Frame::FOLLOWER_BASE, estimate.force)
    });
    output.contact_cf = Some(WrenchSample::force(
        stamp,
        Frame::CONTACT,
        estimate.contact_force,
    ));
    output.contact_state = Some(ContactStateSample {
        normal_force: contact.normal_force,
        tangential_force: contact.tangential_force,
        friction_coefficient: match contact.friction.error == f64::INFINITY {
            true => f64::NAN,
            false => contact.friction.value,
        },
        friction_coefficient_error: contact.friction.error,
        in_contact: u8::from(contact.in_contact),
        touches: u8::from(contact.touches),
        valid: u8::from(contact.valid),
        near_rest: u8::from(contact.near_rest),
        edge: estimate.edge,
        ..ContactStateSample::initial(stamp)
    });
}

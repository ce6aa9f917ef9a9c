//! Joint torques of an arm without torque sensors, from its motors' currents.
//!
//! Equation (2) read the other way round, τ̂ = τ_m − J θ̈ − τ_F(θ, θ̇, τ̂), with the
//! friction that is believed or was identified, as for cheap arms in
//! arXiv 2507.06174. The gear's friction is in the estimate, so that this is as good as
//! the friction model is: [`FeedForward`] holds it and takes over what was found
//! elsewhere, as the servo's does.
//!
//! Motor positions and torques go through the same filter; the positions come out
//! with the torques, equally late. The [`ContactEstimator`](super::ContactEstimator)
//! behind it, of the form [`MotorCurrent`](super::Form::MotorCurrent), adds the same delay
//! again: both together are as late as the other forms.
//!
//! Friction at rest is whatever holds the joint, between −τ_F and +τ_F: nothing tells the
//! torque then, nor until the filters have forgotten the rest.

use super::{EstimatorParameters, JointMeasurement};
use crate::contact_torque::{DerivativeFilter, half_as_late};
use crate::servo::{FeedForward, TakeOverConfig};
use ferntast_model::joint::JointParameters;
use ferntast_model::{JointCount, Joints, ParameterError, parameters};

parameters! {
    /// How joint torques are found from motor currents: section `[estimator.motor_current]`.
    #[derive(Copy)]
    pub struct MotorCurrentParameters {
        /// A joint slower than this counts as at rest \[rad/s\].
        pub rest_speed: f64 [1e-6..=1.0, "rad/s"] = 0.005,
    }
}

/// How many times the filter's delay a rest of the joint is seen in its torque.
const REST_DELAYS: f64 = 5.0;
/// Rounds in which torque and friction under that torque are made to agree: each brings
/// them nearer by b_0T, 0.15 of the shipped arm.
const ROUNDS: usize = 12;

/// What the motors tell, joint side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorMeasurement {
    /// Motor positions θ \[rad\].
    pub position: Joints<f64>,
    /// Motor torques τ_m by the currents, equation (1) \[Nm\].
    pub torque: Joints<f64>,
}

/// Joint torques as far as the motors tell them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueFromMotor {
    /// Motor positions and joint torques, equally late.
    pub measurement: JointMeasurement,
    /// Joints that rest or turn, or did a moment ago: their friction, and so their torque,
    /// is not determined.
    pub undetermined: Joints<bool>,
}

/// One joint.
#[derive(Clone, Debug)]
struct Own {
    position: DerivativeFilter,
    torque: DerivativeFilter,
    inertia: f64,
    friction: FeedForward,
    /// τ̂ \[Nm\].
    estimate: f64,
    /// Sign of the last velocity above the speed of rest.
    direction: f64,
    /// Since the joint rested or turned \[s\].
    moving_for: f64,
}

/// Finds joint torques from motor torques. Allocates when made, never afterwards.
#[derive(Clone, Debug)]
pub struct TorqueByMotorCurrent {
    joints: Vec<Own>,
    count: JointCount,
    rest_speed: f64,
    started: bool,
}

impl TorqueByMotorCurrent {
    /// For `joints` as believed, before an estimator with these `parameters`.
    ///
    /// # Errors
    ///
    /// A number out of bounds, friction that the model does not know.
    pub fn new(
        joints: &[JointParameters],
        parameters: &EstimatorParameters,
        take_over: TakeOverConfig,
    ) -> Result<Self, ParameterError> {
        parameters
            .validate()
            .map_err(|error| error.within("estimator"))?;
        let count = JointCount::new(joints.len())?;
        let filter = half_as_late(parameters.cut_off);
        let own = |joint: &JointParameters| {
            Ok(Own {
                position: filter,
                torque: filter,
                inertia: joint.motor_inertia,
                friction: FeedForward::new(joint, take_over)?,
                estimate: 0.0,
                direction: 0.0,
                moving_for: 0.0,
            })
        };
        Ok(Self {
            joints: joints
                .iter()
                .map(own)
                .collect::<Result<_, ParameterError>>()?,
            count,
            rest_speed: parameters.motor_current.rest_speed,
            started: false,
        })
    }

    /// Friction of joint number `joint` from 0, to be told other friction and the
    /// temperature.
    pub fn friction_mut(&mut self, joint: usize) -> Option<&mut FeedForward> {
        self.joints.get_mut(joint).map(|own| &mut own.friction)
    }

    /// Takes in a measurement `dt` \[s\] after the last one. What is no number, or not of
    /// these joints, comes out as no number: the estimator behind refuses it.
    pub fn step(&mut self, dt: f64, measured: &MotorMeasurement) -> TorqueFromMotor {
        let fits = |own: &Joints<f64>| {
            own.count() == self.count && own.iter().all(|value| value.is_finite())
        };
        let passes = dt > 0.0 && dt.is_finite();
        if !(passes && fits(&measured.position) && fits(&measured.torque)) {
            self.started = false;
            let unknown = Joints::filled(self.count, f64::NAN);
            return TorqueFromMotor {
                measurement: JointMeasurement {
                    motor_position: unknown,
                    joint_torque: unknown,
                },
                undetermined: Joints::filled(self.count, true),
            };
        }
        let started = std::mem::replace(&mut self.started, true);
        let rest_speed = self.rest_speed;
        for (joint, own) in self.joints.iter_mut().enumerate() {
            let (position, torque) = (measured.position[joint], measured.torque[joint]);
            if started {
                own.position.step(position, dt);
                own.torque.step(torque, dt);
            } else {
                own.position.reset(position);
                own.torque.reset(torque);
            }
            own.friction.step(dt);
            own.estimate(dt, rest_speed);
        }
        let each = |read: fn(&Own) -> f64| Joints::from_fn(self.count, |j| read(&self.joints[j]));
        TorqueFromMotor {
            measurement: JointMeasurement {
                motor_position: each(|own| own.position.value()),
                joint_torque: each(|own| own.estimate),
            },
            undetermined: Joints::from_fn(self.count, |j| self.joints[j].is_undetermined()),
        }
    }
}

impl Own {
    fn estimate(&mut self, dt: f64, rest_speed: f64) {
        let velocity = self.position.first();
        let direction = velocity.signum();
        if velocity.abs() < rest_speed || direction != self.direction {
            self.direction = direction;
            self.moving_for = 0.0;
        } else {
            self.moving_for += dt;
        }
        let drive = self.torque.value() - self.inertia * self.position.second();
        // Nearer to rest friction fades, so that the torque does not jump when it turns.
        let fade = (velocity.abs() / rest_speed).min(1.0);
        let mut estimate = self.estimate;
        for _ in 0..ROUNDS {
            let friction = self
                .friction
                .torque(self.position.value(), velocity, estimate);
            estimate = drive - fade * friction.sliding - friction.standing;
        }
        self.estimate = if estimate.is_finite() { estimate } else { 0.0 };
    }

    fn is_undetermined(&self) -> bool {
        self.moving_for < REST_DELAYS * self.position.delay()
    }
}

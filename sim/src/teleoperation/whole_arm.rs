//! The simulated arm of two joints with the estimator that ships, before a surface.

use super::TICK;
use super::environment::{BRISTLE, Environment, SIDE, SIDE_LENGTH};
use super::follower::TrueTip;
use super::servoed::{Estimated, Servoed, TrialArm};
use crate::arm::{ArmConfig, JOINTS, SimulatedArm, SimulatedArmError, TrueSurface};
use ferntast_control::estimator::{ContactEstimator, JointMeasurement};
use ferntast_control::link::FollowerReadings;
use ferntast_control::servo::{Measurement, Servo, ServoConfig};
use ferntast_model::contact::ContactParameters;
use ferntast_model::contour::{Contour, EdgeParameters, Surface};
use ferntast_model::kinematics::Elbow;
use ferntast_model::{Joints, ParameterError, Vector2};

/// Half of the surface's length [m].
const HALF_LENGTH: f64 = 0.15;
/// The arm of a trial, as a file in `config/arms/` and the servo's section of a scenario
/// have it; its contour makes way for the trial's environment.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmUnderTrial {
    /// What it is, and what servo and estimator believe of it.
    pub arm: ArmConfig,
    /// How the servo is tuned.
    pub servo: ServoConfig,
}

/// The arm, from its motors to what the estimator says.
#[derive(Clone, Debug)]
pub(super) struct WholeArm {
    environment: Environment,
    /// Where the surface begins, base frame [m].
    origin: Vector2<f64>,
    arm: SimulatedArm,
    estimator: ContactEstimator,
    temperature: [f64; JOINTS],
}

impl WholeArm {
    /// At rest with its tip at `start` [m] before a surface that begins at `origin`, base
    /// frame [m], behind its servo; sensors draw from `seed`.
    pub(super) fn behind_servo(
        trial: &ArmUnderTrial,
        environment: Environment,
        origin: [f64; 2],
        start: [f64; 2],
        seed: u64,
    ) -> Result<Servoed<WholeArm>, ParameterError> {
        let origin = Vector2::from(origin);
        let tip = origin + Vector2::from(start);
        let mut config = trial.arm.clone();
        config.contour = contour(environment, &origin, &tip, config.contour.nominal_elbow);
        config.truth.contour = None;
        config.truth.surface.unlubricated = surface(environment);
        let model = config.model();
        let kinematics = model.arm.kinematics();
        let posture = kinematics.inverse(&tip, config.contour.nominal_elbow);
        let posture = posture.map_err(|error| ParameterError::Inconsistent {
            key: "law.workspace_offset".to_owned(),
            reason: format!("the arm cannot begin there: {error}"),
        })?;
        config.truth.start_position = posture.into();
        let arm = SimulatedArm::new(&config, seed).map_err(|error| match error {
            SimulatedArmError::Parameter(error) => error,
            SimulatedArmError::StartsInContact { .. } => ParameterError::Inconsistent {
                key: "law.workspace_offset".to_owned(),
                reason: error.to_string(),
            },
        })?;
        let servo = Servo::planar(&model.joint, &model.arm, &trial.servo)?;
        let own = WholeArm {
            environment,
            origin,
            arm,
            estimator: ContactEstimator::new(&model, &config.estimator)?,
            temperature: [0.0; JOINTS],
        };
        Ok(Servoed::new(own, servo))
    }
}

impl TrialArm for WholeArm {
    fn advance(&mut self, since: f64, torque: &Joints<f64>) {
        let (place, speed) = self.environment.place(since);
        self.arm.move_contour([place, 0.0], [speed, 0.0]);
        let torque = std::array::from_fn(|joint| torque.get(joint).copied().unwrap_or(0.0));
        self.arm.advance(torque, TICK);
    }

    fn measure(&mut self, now_ns: i64) -> Option<Measurement> {
        let measured = self.arm.measure();
        self.temperature = measured.temperature;
        Some(Measurement {
            stamp_ns: now_ns,
            position: measured.motor_position.into(),
            velocity: measured.motor_velocity.into(),
            torque: measured.joint_torque.into(),
        })
    }

    fn temperature(&self) -> Option<Joints<f64>> {
        Some(self.temperature.into())
    }

    fn estimate(&mut self, measured: &Measurement) -> Estimated {
        let estimate = self.estimator.step(
            TICK,
            &JointMeasurement {
                motor_position: measured.position,
                joint_torque: measured.torque,
            },
        );
        Estimated {
            tip: (!estimate.state.input_invalid).then_some([estimate.tip[0], estimate.tip[1], 0.0]),
            force: FollowerReadings::force_of(
                estimate.state.valid,
                estimate.state.touches,
                [estimate.force[0], estimate.force[1], 0.0],
            ),
        }
    }

    fn truth(&self) -> TrueTip {
        let truth = self.arm.truth();
        TrueTip {
            position: (Vector2::from(truth.tip) - self.origin).into(),
            force: truth.force,
            work: truth.contact_work,
        }
    }
}

/// The surface across x, free on the side of negative x, and what comes out of it across y.
fn contour(
    environment: Environment,
    origin: &Vector2<f64>,
    tip: &Vector2<f64>,
    nominal_elbow: Elbow,
) -> Contour {
    let (stiffness, damping) = environment.surface();
    let wall = |from: [f64; 2], to: [f64; 2]| EdgeParameters {
        surface: Surface::Unlubricated,
        from: [origin.x + from[0], origin.y + from[1]],
        to: [origin.x + to[0], origin.y + to[1]],
        contact: ContactParameters {
            stiffness: stiffness.max(1.0),
            damping,
            friction: environment.friction(),
        },
    };
    let mut edge = Vec::new();
    if stiffness > 0.0 {
        // What is in the direction of negative x is on the left of y.
        edge.push(wall([0.0, -HALF_LENGTH], [0.0, HALF_LENGTH]));
    }
    if environment.has_block() {
        // What is in the direction of negative y is on the left of negative x.
        edge.push(wall([HALF_LENGTH, SIDE], [-SIDE_LENGTH, SIDE]));
        edge.push(wall([-SIDE_LENGTH, SIDE], [-SIDE_LENGTH, HALF_LENGTH]));
    }
    Contour {
        nominal_tip: (*tip).into(),
        nominal_elbow,
        edge,
        spring: Vec::new(),
    }
}

fn surface(environment: Environment) -> TrueSurface {
    let (stiffness, damping) = environment.surface();
    TrueSurface {
        stiffness: stiffness.max(1.0),
        damping,
        friction: environment.friction(),
        tangential_stiffness: BRISTLE,
        tangential_damping: 0.0,
        wear: None,
    }
}

//! The simulated arm with the servo and the contact-force estimator that ship, before a
//! surface.
//!
//! Each of them takes what the others gave a tick ago, as nodes of a session do: from a
//! measurement to the link's end 2 ms, from its command to the drives 2 ms.

use super::TICK;
use super::environment::{BRISTLE, Environment};
use super::follower::{Follower, TipCommand, TrueTip};
use crate::arm::{ArmConfig, JOINTS, SimulatedArm, SimulatedArmError, TrueSurface};
use ferntast_control::estimator::{ContactEstimator, JointMeasurement};
use ferntast_control::link::{FollowerReadings, StampedPosition};
use ferntast_control::operating::{OperatingState, StateCommand};
use ferntast_control::servo::{Command, Measurement, Servo, ServoConfig, ServoInput, Target};
use ferntast_model::contact::ContactParameters;
use ferntast_model::contour::{Contour, EdgeParameters, Surface};
use ferntast_model::kinematics::Elbow;
use ferntast_model::{ParameterError, Vector2};

/// Half of the surface's length [m].
const HALF_LENGTH: f64 = 0.15;
/// The operator says `resume` so long after the arm paused [ns].
const RESUME_AFTER_NS: i64 = 500_000_000;

/// The arm of a trial, as a file in `config/arms/` and the servo's section of a scenario
/// have it; its contour makes way for the trial's environment.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmUnderTrial {
    /// What it is, and what servo and estimator believe of it.
    pub arm: ArmConfig,
    /// How the servo is tuned.
    pub servo: ServoConfig,
}

/// The arm, from its motors to what the link's end is told.
#[derive(Clone, Debug)]
pub(super) struct WholeArm {
    environment: Environment,
    /// Where the surface begins, base frame [m].
    origin: Vector2<f64>,
    arm: SimulatedArm,
    servo: Servo,
    estimator: ContactEstimator,
    torque: [f64; JOINTS],
    /// Of one tick ago.
    measured: Option<Measurement>,
    /// Of one tick ago.
    command: Option<Command>,
    /// When the arm was left not enabled [ns].
    stopped_ns: Option<i64>,
    state: OperatingState,
    readings: FollowerReadings,
}

impl WholeArm {
    /// At rest with its tip at `start` [m] before a surface that begins at `origin`, base
    /// frame [m]; sensors draw from `seed`.
    pub(super) fn new(
        trial: &ArmUnderTrial,
        environment: Environment,
        origin: [f64; 2],
        start: [f64; 2],
        seed: u64,
    ) -> Result<WholeArm, ParameterError> {
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
        Ok(WholeArm {
            environment,
            origin,
            arm,
            servo: Servo::new(&model.joint, Some(kinematics), &trial.servo)?,
            estimator: ContactEstimator::new(&model, &config.estimator)?,
            torque: [0.0; JOINTS],
            measured: None,
            command: None,
            stopped_ns: None,
            state: OperatingState::Disabled,
            readings: FollowerReadings {
                tip: None,
                contact_force: None,
                state: OperatingState::Disabled,
                told_to_stop: false,
            },
        })
    }

    /// What the operator says: enable at the start, and resume a while after each stop.
    fn word(&mut self, now_ns: i64) -> Option<StateCommand> {
        match self.state {
            OperatingState::Enabled => {
                self.stopped_ns = None;
                None
            }
            OperatingState::Disabled => Some(StateCommand::Enable),
            _ => {
                let since_ns = *self.stopped_ns.get_or_insert(now_ns);
                (now_ns - since_ns >= RESUME_AFTER_NS).then(|| {
                    self.stopped_ns = None;
                    StateCommand::Resume
                })
            }
        }
    }

    fn drive(&mut self, now_ns: i64) {
        let input = ServoInput {
            measurement: self.measured,
            command: self.command,
            state_command: self.measured.and_then(|_| self.word(now_ns)),
            weight: Some([0.0; JOINTS].into()),
        };
        let output = self.servo.step(now_ns, &input);
        self.state = output.state;
        let torque = &output.torque;
        self.torque = std::array::from_fn(|joint| torque.get(joint).copied().unwrap_or(0.0));
    }

    fn estimate(&mut self, measured: &Measurement) -> FollowerReadings {
        let estimate = self.estimator.step(
            TICK,
            &JointMeasurement {
                motor_position: measured.position,
                joint_torque: measured.torque,
            },
        );
        FollowerReadings {
            tip: (!estimate.input_invalid).then_some(StampedPosition {
                stamp_ns: measured.stamp_ns,
                position: [estimate.tip[0], estimate.tip[1], 0.0],
                silence: TICK,
            }),
            contact_force: FollowerReadings::force_of(
                estimate.valid,
                estimate.touches,
                [estimate.force[0], estimate.force[1], 0.0],
            ),
            state: self.state,
            told_to_stop: false,
        }
    }
}

impl Follower for WholeArm {
    fn step(&mut self, now_ns: i64, since: f64, command: Option<TipCommand>) {
        let (place, speed) = self.environment.place(since);
        self.arm.move_contour([place, 0.0], [speed, 0.0]);
        self.arm.advance(self.torque, TICK);
        self.drive(now_ns);
        if let Some(measured) = self.measured {
            self.readings = self.estimate(&measured);
        }
        let measured = self.arm.measure();
        self.measured = Some(Measurement {
            stamp_ns: now_ns,
            position: measured.motor_position.into(),
            velocity: measured.motor_velocity.into(),
            torque: measured.joint_torque.into(),
        });
        for (joint, temperature) in measured.temperature.into_iter().enumerate() {
            self.servo.set_temperature(joint, temperature);
        }
        if let Some(command) = command {
            self.command = Some(Command {
                stamp_ns: command.made_ns,
                target: Target::Tip(command.position),
            });
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

    fn readings(&self) -> FollowerReadings {
        self.readings
    }
}

/// The surface across x, free on the side of negative x.
fn contour(
    environment: Environment,
    origin: &Vector2<f64>,
    tip: &Vector2<f64>,
    nominal_elbow: Elbow,
) -> Contour {
    let (stiffness, damping) = environment.surface();
    let wall = EdgeParameters {
        surface: Surface::Unlubricated,
        // What is in the direction of negative x is on the left of y.
        from: [origin.x, origin.y - HALF_LENGTH],
        to: [origin.x, origin.y + HALF_LENGTH],
        contact: ContactParameters {
            stiffness: stiffness.max(1.0),
            damping,
            friction: environment.friction(),
        },
    };
    Contour {
        nominal_tip: (*tip).into(),
        nominal_elbow,
        edge: if stiffness > 0.0 {
            vec![wall]
        } else {
            Vec::new()
        },
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

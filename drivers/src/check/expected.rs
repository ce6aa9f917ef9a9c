//! What an arm's file leads one to expect.

use ferntast_control::{estimator::Form, servo::ServoConfig};
use ferntast_model::{JointCount, Joints, ParameterError};
use ferntast_msgs::sample::JointNames;
use ferntast_nodes::process::SessionContext;

use crate::weight::Weight;

/// Which torque the contact force is told by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Torque {
    /// That of sensors behind the gears.
    Joint,
    /// That of the motors.
    Motor,
}

/// What is expected of a joint.
#[derive(Clone, Copy, Debug)]
pub struct ExpectedJoint {
    /// Where it may be \[rad\] or \[m\].
    pub range: [f64; 2],
    /// How fast \[rad/s\] or \[m/s\].
    pub speed: f64,
    /// The most that its motor gives \[Nm\] or \[N\].
    pub torque: f64,
}

/// What an arm's file leads one to expect.
pub struct Expected {
    /// The joints' names.
    pub names: JointNames,
    /// What is expected of each.
    pub joints: Joints<ExpectedJoint>,
    /// What they carry.
    pub weight: Weight,
    /// Which torque has to be measured.
    pub torque: Torque,
    /// No reading for so long is a fault of the servo \[s\].
    pub longest_gap: f64,
}

impl Expected {
    /// Of the session's arm.
    ///
    /// # Errors
    ///
    /// An arm without joints.
    pub fn of(session: &SessionContext) -> Result<Expected, ParameterError> {
        let loaded = &session.loaded;
        let believed = loaded.arm.model.joints();
        let count = JointCount::new(believed.len())?;
        let servo: &ServoConfig = &loaded.scenario.servo;
        Ok(Expected {
            names: session.joints(),
            joints: Joints::from_fn(count, |joint| {
                let own = &believed[joint];
                ExpectedJoint {
                    range: [own.position_lower, own.position_upper],
                    speed: own.velocity_limit,
                    torque: own.motor_torque_limit,
                }
            }),
            weight: Weight::new(&loaded.arm.model, count),
            torque: match loaded.arm.estimator.form {
                Form::MotorCurrent => Torque::Motor,
                _ => Torque::Joint,
            },
            longest_gap: servo.measurement_watchdog,
        })
    }
}

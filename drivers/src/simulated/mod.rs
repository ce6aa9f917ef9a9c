//! The simulated arm of two joints as a driver.

mod config;
mod description;
pub mod serial;
mod serial_description;

pub use config::{arm_file, load_arm, load_config};
pub(crate) use serial_description::describe_serial;

use ferntast_config::joint_names;
use ferntast_model::{ArmModel, Joints};
use ferntast_msgs::sample::{Fault, JointNames, Level, RobotDescriptionSample};
use ferntast_nodes::{
    node::NodeHealth,
    process::{NodeError, SessionContext},
};
use ferntast_sim::arm::{ArmConfig, SimulatedArm, SimulatedArmError};

use crate::driver::{Driver, DriverCommand, Measures, Reading};

/// The simulated arm that the session is of.
pub(crate) fn driver(session: &SessionContext) -> Result<Box<dyn Driver>, NodeError> {
    let loaded = &session.loaded;
    let seed = loaded.scenario.seed;
    if let Some(serial) = loaded.arm.model.serial() {
        return Ok(Box::new(serial::simulated(&loaded.arm, serial, seed)?));
    }
    let arm = Simulated::new(&loaded.arm.whole()?, seed).map_err(NodeError::own)?;
    Ok(Box::new(arm))
}

/// The simulated arm behind the arm's node.
pub struct Simulated {
    joints: JointNames,
    arm: SimulatedArm,
    description: Option<RobotDescriptionSample>,
}

impl Simulated {
    /// An arm at rest in the configured posture.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds, a posture that touches the contour.
    pub fn new(config: &ArmConfig, seed: u64) -> Result<Simulated, SimulatedArmError> {
        let arm = SimulatedArm::new(config, seed)?;
        Ok(Simulated::of(arm, &config.model()))
    }

    /// The arm as it is now; `model` is what is believed of it.
    pub fn of(arm: SimulatedArm, model: &ArmModel) -> Simulated {
        Simulated {
            joints: joint_names(model),
            arm,
            description: Some(description::describe(model)),
        }
    }

    /// The arm itself, for those who look at what is true.
    pub fn arm(&self) -> &SimulatedArm {
        &self.arm
    }
}

impl Driver for Simulated {
    fn joints(&self) -> JointNames {
        self.joints
    }

    fn measures(&self) -> Measures {
        Measures {
            joint_torque: true,
            motor_torque: true,
            temperature: true,
        }
    }

    fn write(&mut self, command: &DriverCommand, health: &mut NodeHealth) {
        let Some(elapsed) = command.elapsed else {
            return;
        };
        let torque = std::array::from_fn(|joint| command.torque[joint]);
        let flags = self.arm.advance(torque, elapsed);
        if flags.limited.contains(&true) {
            health.raise(Fault::EffortLimited, Level::OK);
        }
        if flags.not_finite.contains(&true) {
            health.raise(Fault::CommandInvalid, Level::ERROR);
        }
    }

    fn read(&mut self, health: &mut NodeHealth) -> Option<Reading> {
        let measured = self.arm.measure();
        if measured.torque_saturated.contains(&true) {
            health.raise(Fault::TorqueSaturated, Level::WARN);
        }
        Some(Reading {
            position: Joints::from(measured.motor_position),
            velocity: Joints::from(measured.motor_velocity),
            joint_torque: Some(Joints::from(measured.joint_torque)),
            motor_torque: Some(Joints::from(measured.motor_torque_from_current)),
            temperature: Some(Joints::from(measured.temperature)),
        })
    }

    fn description(&mut self) -> Option<RobotDescriptionSample> {
        self.description.take()
    }
}

//! The simulated arm of one to eight joints as a driver.

use ferntast_model::{Joints, rigid_body::Chain};
use ferntast_msgs::sample::{Fault, JointNames, Level, RobotDescriptionSample};
use ferntast_nodes::node::NodeHealth;
use ferntast_sim::serial_arm::{Grip, SerialArm, SerialArmError, SerialArmParameters};

use crate::driver::{Driver, DriverCommand, Measures, Reading};

/// A simulated serial arm behind the arm's node.
pub struct SimulatedSerialArm {
    joints: JointNames,
    arm: SerialArm,
    measures: Measures,
    description: Option<RobotDescriptionSample>,
    /// Its brakes are on while its drives are off.
    brakes: bool,
}

impl SimulatedSerialArm {
    /// The arm of [`SerialArm::new`] whose joints have those names, and which looks as
    /// `description` says.
    ///
    /// # Errors
    ///
    /// As [`SerialArm::new`].
    pub fn new(
        joints: JointNames,
        chain: &Chain,
        torque_limits: &Joints<f64>,
        truth: &SerialArmParameters,
        seed: u64,
        description: Option<RobotDescriptionSample>,
    ) -> Result<SimulatedSerialArm, SerialArmError> {
        Ok(SimulatedSerialArm {
            joints,
            arm: SerialArm::new(chain, torque_limits, truth, seed)?,
            measures: Measures {
                joint_torque: true,
                motor_torque: true,
                temperature: true,
            },
            description,
            brakes: false,
        })
    }

    /// The same, whose brakes are on while its drives are off: without them, it falls then.
    pub fn braked(mut self) -> SimulatedSerialArm {
        self.brakes = true;
        self.arm.brake(true);
        self
    }

    /// The same driver of another arm like it, such as this one at another time.
    pub fn with(mut self, arm: SerialArm) -> SimulatedSerialArm {
        self.arm = arm;
        self.arm.brake(self.brakes);
        self
    }

    /// The same without the sensors that it is not to have.
    pub fn measuring(self, measures: Measures) -> SimulatedSerialArm {
        SimulatedSerialArm { measures, ..self }
    }

    /// From now on a hand holds its tip like that.
    pub fn hold(&mut self, grip: Grip) {
        self.arm.hold(Some(grip));
    }

    /// The arm itself, for those who look at what is true.
    pub fn arm(&self) -> &SerialArm {
        &self.arm
    }
}

impl Driver for SimulatedSerialArm {
    fn joints(&self) -> JointNames {
        self.joints
    }

    fn measures(&self) -> Measures {
        self.measures
    }

    fn enable(&mut self, enabled: bool) {
        if self.brakes {
            self.arm.brake(!enabled);
        }
    }

    fn write(&mut self, command: &DriverCommand, health: &mut NodeHealth) {
        let Some(elapsed) = command.elapsed else {
            return;
        };
        let flags = self.arm.advance(&command.torque, elapsed);
        if flags.limited.contains(&true) {
            health.raise(Fault::EffortLimited, Level::OK);
        }
        if flags.not_finite.contains(&true) {
            health.raise(Fault::CommandInvalid, Level::ERROR);
        }
    }

    fn read(&mut self, health: &mut NodeHealth) -> Option<Reading> {
        let measured = self.arm.measure();
        let has = self.measures;
        if has.joint_torque && measured.torque_saturated.contains(&true) {
            health.raise(Fault::TorqueSaturated, Level::WARN);
        }
        Some(Reading {
            position: measured.motor_position,
            velocity: measured.motor_velocity,
            joint_torque: has.joint_torque.then_some(measured.joint_torque),
            motor_torque: has
                .motor_torque
                .then_some(measured.motor_torque_from_current),
            temperature: has.temperature.then_some(measured.temperature),
        })
    }

    fn description(&mut self) -> Option<RobotDescriptionSample> {
        self.description.take()
    }
}

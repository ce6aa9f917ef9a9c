//! A plain position controller to move the simulated arm with, for tests.

use crate::common::TICK;
use ferntast_model::friction::{Friction, FrictionState};
use ferntast_model::kinematics::Kinematics;
use ferntast_model::{ArmModel, Vector2};
use ferntast_sim::arm::{ArmConfig, Measurement, SimulatedArm};

/// Moves the tip along a path with joint position control and friction compensation.
pub struct Driver {
    pub arm: SimulatedArm,
    model: ArmModel,
    kinematics: Kinematics,
    friction: [Friction; 2],
    setpoint: Vector2<f64>,
}

impl Driver {
    /// The shipped arm, or one derived from it.
    pub fn new(config: &ArmConfig, seed: u64) -> Self {
        let model = config.model();
        let friction = |joint: usize| Friction::new(&model.joint[joint].friction).expect("valid");
        Self {
            arm: SimulatedArm::new(config, seed).expect("valid"),
            kinematics: model.arm.kinematics(),
            friction: [friction(0), friction(1)],
            setpoint: Vector2::from(config.truth.start_position),
            model,
        }
    }

    /// One tick towards the tip point `offset` \[m\] from the nominal one.
    pub fn step(&mut self, offset: [f64; 2]) -> Measurement {
        let tip = Vector2::from(self.model.contour.nominal_tip) + Vector2::from(offset);
        let elbow = self.model.contour.nominal_elbow;
        let goal = self.kinematics.inverse(&tip, elbow).expect("in reach");
        let velocity = (goal - self.setpoint) / TICK;
        self.setpoint = goal;
        let measured = self.arm.measure();
        let torque = [0, 1].map(|joint: usize| {
            let friction = self.friction[joint].torque_within_range(&FrictionState {
                velocity: velocity[joint],
                load: measured.joint_torque[joint],
                ..Default::default()
            });
            1500.0 * (goal[joint] - measured.motor_position[joint])
                + 60.0 * (velocity[joint] - measured.motor_velocity[joint])
                + friction.torque
                + measured.joint_torque[joint]
        });
        self.arm.advance(torque, TICK);
        self.arm.measure()
    }
}

//! The same arm twice: as a chain, and as the arm of two joints.

use ferntast_model::Joints;
use ferntast_sim::arm::{ArmConfig, SimulatedArm};
use ferntast_sim::serial_arm::{SerialArm, SerialArmParameters, SerialJointParameters};

use super::{TICK, arms};
use crate::common::rokviss;

/// The shipped arm, with nothing to touch and held temperatures, and the same as a chain.
fn both(config: &ArmConfig) -> (SimulatedArm, SerialArm) {
    let chain = arms::planar(&config.arm.link);
    let [x, y] = config.arm.gravity;
    let joint = config.truth.joint.iter().map(|joint| {
        let mut friction = joint.friction;
        friction.wear = None;
        SerialJointParameters {
            motor_inertia: Some(joint.motor_inertia),
            gear_ratio: joint.gear_ratio,
            stiffness: Some(joint.stiffness),
            damping: joint.damping,
            motor_constant: joint.motor_constant,
            motor_torque_limit: Some(joint.motor_torque_limit),
            torque_sensor_range: joint.torque_sensor_range,
            friction: Some(friction),
            ..Default::default()
        }
    });
    let parameters = SerialArmParameters {
        substep: Some(1e-5),
        start_position: config.truth.start_position.to_vec(),
        gravity: [x, y, 0.0],
        temperature: 10.0,
        joint: joint.collect(),
        ..Default::default()
    };
    let limits = Joints::from([1e3, 1e3]);
    let serial = SerialArm::new(&chain, &limits, &parameters, 1).expect("an arm");
    (SimulatedArm::new(config, 1).expect("an arm"), serial)
}

#[test]
fn the_arm_of_two_joints_moves_in_the_same_way() {
    for gravity in [[0.0, 0.0], [0.0, -9.8]] {
        let mut config = rokviss();
        config.arm.gravity = gravity;
        config.truth.substep = 1e-5;
        config.truth.environment.temperature = Some([10.0, 10.0]);
        config.contour.edge.clear();
        config.contour.spring.clear();
        for joint in &mut config.truth.joint {
            joint.friction.wear = None;
            // No warmth of its own: the other one has none.
            joint.thermal.capacity = 1e6;
        }
        let (mut planar, mut serial) = both(&config);
        let (mut worst, mut farthest) = ([0.0_f64; 3], 0.0_f64);
        for tick in 0..3000 {
            let time = f64::from(tick) * TICK;
            let torque = [35.0 * (5.0 * time).sin(), 30.0 * (7.0 * time).cos()];
            planar.advance(torque, TICK);
            serial.advance(&Joints::from(torque), TICK);
            let (one, other) = (planar.truth(), serial.truth());
            for joint in 0..2 {
                let apart = [
                    one.position[joint] - other.position[joint],
                    one.motor_position[joint] - other.motor_position[joint],
                    one.joint_torque[joint] - other.joint_torque[joint],
                ];
                for (worst, apart) in worst.iter_mut().zip(apart) {
                    *worst = worst.max(apart.abs());
                }
                let moved = one.position[joint] - config.truth.start_position[joint];
                farthest = farthest.max(moved.abs());
            }
        }
        println!("apart: {worst:?} rad, rad, Nm on a way of {farthest:.2} rad");
        assert!(farthest > 0.1);
        assert!(worst[0] < 2e-5 && worst[1] < 2e-5 && worst[2] < 0.05);
    }
}

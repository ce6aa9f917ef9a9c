//! What is true of a simulated serial arm: what its file says, else what is believed of it.

use ferntast_config::{
    ArmFile, ConfigError,
    serial::{Serial, SerialFile},
};
use ferntast_control::estimator::Form;
use ferntast_model::{Joints, joint::JointParameters, serial_arm::Plane, shape::Shape};
use ferntast_nodes::process::NodeError;
use ferntast_sim::{
    arm::{SensorParameters, TrueSurface},
    serial_arm::{ObjectParameters, SerialArmParameters, SerialJointParameters},
};

use super::serial_description::describe_serial;
use crate::{driver::Measures, serial_arm::SimulatedSerialArm};

/// A gear that is believed to be as stiff as this is rigid \[Nm/rad\].
const RIGID: f64 = 9e5;
/// Noise of a torque sensor, as a share of its range \[-\], standard deviation.
const TORQUE_NOISE: f64 = 5e-4;

/// The section `[truth]` of the file of a serial arm. What it leaves out is as believed: the
/// start is at home, the planes are where they are thought to be, motors and gears are as
/// in `[[joint]]`, and free of friction.
///
/// # Errors
///
/// The file is not one of a serial arm, or its section has a key or type that is wrong.
pub fn truth(arm: &ArmFile) -> Result<SerialArmParameters, ConfigError> {
    let file: SerialFile = arm.whole()?;
    let mut truth: SerialArmParameters = match &file.truth {
        None => SerialArmParameters::default(),
        Some(truth) => serde_json::from_value(truth.clone()).map_err(ConfigError::Arm)?,
    };
    let says = |key: &str| {
        file.truth
            .as_ref()
            .is_some_and(|own| own.get(key).is_some())
    };
    if !says("start_position") {
        truth.start_position.clone_from(&file.home);
    }
    if !says("gravity") {
        truth.gravity = file.gravity;
    }
    if !says("object") {
        truth.object = file.surface.iter().map(object).collect();
    }
    if !says("joint") {
        truth.joint = file.joint.iter().map(joint).collect();
    }
    Ok(truth)
}

/// The simulated arm of `file`; joints whose torques are to be found from the motors' currents
/// have no torque sensors.
///
/// # Errors
///
/// What is wrong with the file's section `[truth]`.
pub fn simulated(
    file: &ArmFile,
    serial: &Serial,
    seed: u64,
) -> Result<SimulatedSerialArm, NodeError> {
    simulated_as(file, serial, &truth(file)?, seed)
}

/// The same with another truth.
///
/// # Errors
///
/// What is wrong with it.
pub fn simulated_as(
    file: &ArmFile,
    serial: &Serial,
    truth: &SerialArmParameters,
    seed: u64,
) -> Result<SimulatedSerialArm, NodeError> {
    let arm = &serial.arm;
    let limit = |joint: usize| arm.joints()[joint].motor_torque_limit;
    let limits = Joints::from_fn(arm.count(), limit);
    let description = Some(describe_serial(serial));
    let simulated = SimulatedSerialArm::new(
        serial.joints,
        arm.chain(),
        &limits,
        truth,
        seed,
        description,
    );
    Ok(simulated.map_err(NodeError::own)?.measuring(Measures {
        joint_torque: file.estimator.form != Form::MotorCurrent,
        motor_torque: true,
        temperature: true,
    }))
}

/// The plane as a thing to touch.
fn object(plane: &Plane) -> ObjectParameters {
    ObjectParameters {
        name: plane.name.clone(),
        shape: Shape::Plane {
            point: plane.point,
            normal: plane.normal,
        },
        surface: TrueSurface {
            stiffness: plane.stiffness.min(1e6),
            damping: plane.damping.min(1e3),
            friction: plane.friction.min(3.0),
            tangential_stiffness: plane.stiffness.min(1e6),
            tangential_damping: plane.damping.min(1e3),
            wear: None,
        },
        motion: None,
    }
}

/// A drive as it is believed to be, with sensors as good as an arm's with torque sensors.
fn joint(believed: &JointParameters) -> SerialJointParameters {
    SerialJointParameters {
        motor_inertia: Some(believed.motor_inertia),
        gear_ratio: believed.gear_ratio,
        stiffness: (believed.stiffness < RIGID).then_some(believed.stiffness),
        damping: believed.damping,
        motor_constant: believed.motor_constant,
        motor_torque_limit: Some(believed.motor_torque_limit),
        torque_sensor_range: believed.torque_sensor_range,
        sensor: Some(SensorParameters {
            encoder_counts: 16384.0,
            velocity_time_constant: 0.002,
            torque_noise: TORQUE_NOISE * believed.torque_sensor_range,
            torque_step: 0.0,
            current_noise: 0.0,
            current_step: 0.0,
            torque_errors: None,
        }),
        ..SerialJointParameters::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::load_arm;

    #[test]
    fn what_the_file_leaves_out_is_as_believed() {
        let arm = load_arm("panda").unwrap();
        let file: SerialFile = arm.whole().unwrap();
        let own = truth(&arm).unwrap();
        assert_eq!(own.start_position, file.home);
        assert_eq!(own.object.len(), file.surface.len());
        assert_eq!(own.joint.len(), 7);
        assert_eq!(
            own.joint[3].motor_inertia,
            Some(file.joint[3].motor_inertia)
        );
        own.validate().unwrap();
    }
}

//! What the arm gives: flags, measurements, the truth.

use ferntast_model::{
    Joints,
    rigid_body::{Placement, Vector3},
};

/// What the drives made of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveFlags {
    /// The torque was NaN or infinite; zero was applied instead.
    pub not_finite: Joints<bool>,
    /// The torque was beyond the drive's limit and cut to it.
    pub limited: Joints<bool>,
}

/// What the sensors give, all on the joint side of the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Motor positions θ \[rad\] or \[m\], in steps of the encoder.
    pub motor_position: Joints<f64>,
    /// Motor velocities \[rad/s\] or \[m/s\]: filtered difference of the encoder.
    pub motor_velocity: Joints<f64>,
    /// Joint torques τ \[Nm\] or \[N\] at the torque sensors.
    pub joint_torque: Joints<f64>,
    /// The torque sensor is at the end of its range.
    pub torque_saturated: Joints<bool>,
    /// Motor currents \[A\].
    pub motor_current: Joints<f64>,
    /// Motor torques τ_m \[Nm\] or \[N\] from the currents, with the motor constant that
    /// is believed.
    pub motor_torque_from_current: Joints<f64>,
    /// Temperatures \[degC\].
    pub temperature: Joints<f64>,
}

/// What is true, for judges only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Link positions q and velocities q̇.
    pub position: Joints<f64>,
    /// Link velocities q̇.
    pub velocity: Joints<f64>,
    /// Motor positions θ.
    pub motor_position: Joints<f64>,
    /// Motor velocities θ̇.
    pub motor_velocity: Joints<f64>,
    /// Joint torques τ.
    pub joint_torque: Joints<f64>,
    /// Temperatures of the gears \[degC\].
    pub temperature: Joints<f64>,
    /// The tip's frame in the base frame.
    pub tip: Placement,
    /// Velocity of the tip \[m/s\], base frame.
    pub tip_velocity: Vector3<f64>,
    /// Angular velocity of the tip \[rad/s\], base frame.
    pub tip_turning: Vector3<f64>,
    /// Contact force on the tip \[N\], base frame, all things together.
    pub force: Vector3<f64>,
    /// Moment of it about the middle of the tip \[Nm\], base frame.
    pub moment: Vector3<f64>,
    /// Force of the hand that holds the tip \[N\], base frame; zero where none does.
    pub grip_force: Vector3<f64>,
    /// Moment of it about the middle of the tip \[Nm\], base frame.
    pub grip_moment: Vector3<f64>,
    /// The thing that pushes most, by its place in the list; `None` without contact.
    pub object: Option<usize>,
    /// Its normal force F_N ≥ 0 \[N\].
    pub normal_force: f64,
    /// Its normal, out of it.
    pub normal: Vector3<f64>,
    /// Velocity of the tip along it \[m/s\].
    pub sliding: Vector3<f64>,
    /// Energy of all parts, kinetic, elastic and potential \[J\].
    pub energy: f64,
    /// Work that the contact did on the tip since the start \[J\].
    pub contact_work: f64,
    /// Work that the motors' torques did since the start \[J\].
    pub motor_work: f64,
    /// Heat of friction in all gears since the start \[J\].
    pub friction_heat: f64,
}

//! What comes out of the estimator of a serial arm.

use super::super::ContactState;
use ferntast_model::{JointCount, Joints};

/// What is known of tip and contact in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialEstimate {
    /// Link-side positions q \[rad\] or \[m\], newest, not filtered.
    pub position: Joints<f64>,
    /// Link-side velocities q̇ \[rad/s\] or \[m/s\], filtered.
    pub velocity: Joints<f64>,
    /// Tip \[m\], base frame, newest, not filtered.
    pub tip: [f64; 3],
    /// Its orientation in the base frame: quaternion x, y, z, w.
    pub orientation: [f64; 4],
    /// Velocity of the tip \[m/s\], base frame, filtered.
    pub tip_velocity: [f64; 3],
    /// Force of the surroundings on the tip \[N\], base frame, filtered; also without
    /// contact, where it shows the estimator's noise.
    pub force: [f64; 3],
    /// Force \[N\] and torque \[Nm\] of the surroundings on the tool, about the tip, base frame,
    /// filtered. Where a force at the tip is enough, and where no torque can be told (fewer than six
    /// joints, near a singularity, by motor currents), that force and no torque.
    pub wrench: [[f64; 3]; 2],
    /// `force` in the contact frame \[N\]: along two tangents, which are right-handed with
    /// the normal, and along the normal; zero without contact.
    pub contact_force: [f64; 3],
    /// The surface touched, of those that are believed in.
    pub surface: Option<usize>,
    /// What there is to say whatever the arm's shape.
    pub state: ContactState,
}

impl SpatialEstimate {
    /// Nothing is known of an arm with so many joints.
    pub fn unknown(joints: JointCount) -> SpatialEstimate {
        SpatialEstimate {
            position: Joints::filled(joints, 0.0),
            velocity: Joints::filled(joints, 0.0),
            tip: [0.0; 3],
            orientation: [0.0, 0.0, 0.0, 1.0],
            tip_velocity: [0.0; 3],
            force: [0.0; 3],
            wrench: [[0.0; 3]; 2],
            contact_force: [0.0; 3],
            surface: None,
            state: ContactState::unknown(joints),
        }
    }
}

//! What goes into the estimator, and what comes out.

use super::ContactState;
use ferntast_model::contour::Surface;
use ferntast_model::{JointCount, Joints};

/// What the estimator needs of a measurement, joint side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMeasurement {
    /// Motor positions θ \[rad\].
    pub motor_position: Joints<f64>,
    /// Joint torques τ at the torque sensors \[Nm\].
    pub joint_torque: Joints<f64>,
}

/// What is known of tip and contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactEstimate {
    /// Link-side positions q \[rad\], newest, not filtered.
    pub position: Joints<f64>,
    /// Link-side velocities q̇ \[rad/s\], filtered.
    pub velocity: Joints<f64>,
    /// Stylus tip r_ee \[m\], base frame, newest, not filtered.
    pub tip: [f64; 2],
    /// Velocity of the tip \[m/s\], base frame, filtered.
    pub tip_velocity: [f64; 2],
    /// Force of the surroundings on the tip \[N\], base frame, filtered; also
    /// without contact, where it shows the estimator's noise.
    pub force: [f64; 2],
    /// The same in the contact frame \[N\]: along the tangent (normal turned
    /// by −90°), and along the normal; zero without contact.
    pub contact_force: [f64; 2],
    /// The surface touched.
    pub surface: Option<Surface>,
    /// Its index in [`Contour::features`](ferntast_model::contour::Contour::features).
    pub feature: Option<usize>,
    /// What there is to say whatever the arm's shape.
    pub state: ContactState,
}

impl ContactEstimate {
    /// Nothing is known of an arm with so many joints.
    pub fn unknown(joints: JointCount) -> ContactEstimate {
        ContactEstimate {
            position: Joints::filled(joints, 0.0),
            velocity: Joints::filled(joints, 0.0),
            tip: [0.0; 2],
            tip_velocity: [0.0; 2],
            force: [0.0; 2],
            contact_force: [0.0; 2],
            surface: None,
            feature: None,
            state: ContactState::unknown(joints),
        }
    }
}

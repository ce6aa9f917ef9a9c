//! What goes into the estimator, and what comes out.

use super::Coefficient;
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

/// What is known of tip and contact. Always finite, but for the error of a
/// coefficient that is not identified, which is infinite.
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
    /// Normal force F_N ≥ 0 \[N\]; zero without contact.
    pub normal_force: f64,
    /// Tangential force F_T \[N\], positive against the tip's motion; zero
    /// without contact. Near rest the last direction of motion is taken,
    /// so it may become negative (Fig. 16).
    pub tangential_force: f64,
    /// The surface touched.
    pub surface: Option<Surface>,
    /// Its index in [`Contour::features`](ferntast_model::contour::Contour::features).
    pub feature: Option<usize>,
    /// b_0T of equation (6) of the surface touched, or touched last.
    pub friction: Coefficient,
    /// The tip touches something: a surface of the contour, or, by a force of three times as
    /// much for 50 ms, something that is not in it.
    pub touches: bool,
    /// The tip touches a surface of the contour.
    pub in_contact: bool,
    /// The forces can be used.
    pub valid: bool,
    /// In contact, and the tip rests or turns or is in a corner: F_T is not defined.
    pub near_rest: bool,
    /// The tip touches two surfaces at once: `force` holds, its split does not.
    pub corner: bool,
    /// The arm is too near its singularity to tell forces.
    pub singular: bool,
    /// A torque sensor is, or was a moment ago, at the end of its range.
    pub saturated: bool,
    /// A torque sensor gives the same number again and again while its joint turns.
    pub stuck: Joints<bool>,
    /// The measurement or the time step was not usable; the rest is from before.
    pub input_invalid: bool,
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
            normal_force: 0.0,
            tangential_force: 0.0,
            surface: None,
            feature: None,
            friction: Coefficient::UNKNOWN,
            touches: false,
            in_contact: false,
            valid: false,
            near_rest: false,
            corner: false,
            singular: false,
            saturated: false,
            stuck: Joints::filled(joints, false),
            input_invalid: false,
        }
    }
}

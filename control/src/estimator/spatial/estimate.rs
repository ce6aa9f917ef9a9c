//! What comes out of the estimator of a serial arm.

use super::super::Coefficient;
use ferntast_model::{JointCount, Joints};

/// What is known of tip and contact in space. Always finite, but for the error of a
/// coefficient that is not identified, which is infinite.
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
    /// Normal force F_N ≥ 0 \[N\]; zero without contact.
    pub normal_force: f64,
    /// Tangential force F_T \[N\], positive against the tip's motion along the surface; zero
    /// without contact. Near rest the last direction of motion is taken.
    pub tangential_force: f64,
    /// The surface touched, of those that are believed in.
    pub surface: Option<usize>,
    /// b_0T of equation (6) of the surface touched, or touched last.
    pub friction: Coefficient,
    /// The tip touches something: a believed surface, or, by a force of three times as much
    /// for 50 ms, something else.
    pub touches: bool,
    /// As `touches`, where a force is split: along a believed surface, or else along and
    /// across the tip's motion.
    pub in_contact: bool,
    /// The forces can be used.
    pub valid: bool,
    /// In contact, and the tip rests or turns or is in a corner: F_T is not defined.
    pub near_rest: bool,
    /// The tip touches two surfaces at once: `force` holds, its split does not.
    pub corner: bool,
    /// The arm is too near a singularity to tell forces.
    pub singular: bool,
    /// A torque sensor is, or was a moment ago, at the end of its range.
    pub saturated: bool,
    /// A torque sensor gives the same number again and again while its joint turns.
    pub stuck: Joints<bool>,
    /// The measurement or the time step was not usable; the rest is from before.
    pub input_invalid: bool,
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
            normal_force: 0.0,
            tangential_force: 0.0,
            surface: None,
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

//! What is told of a contact whatever the arm's shape.

use super::Coefficient;
use ferntast_model::{JointCount, Joints};

/// What is told of a contact, in a plane and in space, beside places and forces in a frame.
/// Always finite, but for the error of a coefficient that is not identified, which is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// Normal force F_N ≥ 0 \[N\]; zero without contact.
    pub normal_force: f64,
    /// Tangential force F_T \[N\], positive against the tip's motion along the surface; zero
    /// without contact. Near rest the last direction of motion is taken, so it may become
    /// negative (Fig. 16).
    pub tangential_force: f64,
    /// b_0T of equation (6) of the surface touched, or touched last.
    pub friction: Coefficient,
    /// The tip touches something: a surface that is believed in, or, by a force of three times
    /// as much for 50 ms, something else.
    pub touches: bool,
    /// The force is split: in a plane along a surface of the contour, in space, where the tip
    /// touches, along a surface that is believed in, or else along and across its motion.
    pub in_contact: bool,
    /// The forces can be used.
    pub valid: bool,
    /// In contact, and the tip rests or turns or is in a corner: F_T is not defined.
    pub near_rest: bool,
    /// The tip touches two surfaces at once: the force holds, its split does not.
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

impl ContactState {
    /// Nothing is known of an arm with so many joints.
    pub fn unknown(joints: JointCount) -> ContactState {
        ContactState {
            normal_force: 0.0,
            tangential_force: 0.0,
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
    /// Nothing is known but the coefficient of friction of what was touched last.
    pub(super) fn without_contact(&self) -> ContactState {
        ContactState {
            friction: self.friction,
            ..ContactState::unknown(self.stuck.count())
        }
    }
}

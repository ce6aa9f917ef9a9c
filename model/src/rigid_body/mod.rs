//! Rigid-body dynamics of any serial arm: one to eight revolute or prismatic joints.
//!
//! A [`Chain`] is made once and checked; its functions of a state neither fail nor
//! allocate. Its closed-form oracle is ROKVISS's arm ([`arm`](crate::arm)).
//!
//! * Frames: each joint carries a link with a frame of its own. At joint position
//!   zero the joint's `placement` gives that frame in the frame before it (the base
//!   frame for the first joint); the joint turns or shifts it about or along `axis`.
//!   What is fixed to a link is part of it ([`LinkInertia::placed`], `+`).
//! * Joint values q, q̇, q̈ are in rad or m, rad/s or m/s, rad/s² or m/s², torques τ
//!   in Nm or N; τ is positive where it accelerates towards positive q.
//! * Gravity is the acceleration of gravity in the base frame \[m/s²\], such as
//!   (0, 0, −9.81) for a base that stands upright.
//! * The states' joints are the chain's: each function panics where a list of joint
//!   values has not one for each of them.
//!
//! Sources: R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008;
//! J. Y. S. Luh, M. W. Walker, R. P. C. Paul, On-line computational scheme for
//! mechanical manipulators, J. Dyn. Syst. Meas. Control 102 (1980); C. G. Atkeson,
//! C. H. An, J. M. Hollerbach, Estimation of inertial parameters of manipulator
//! loads and links, Int. J. Robotics Research 5 (1986); for inverse kinematics see
//! [`inverse_kinematics`].

mod chain;
mod inertia;
mod inverse_dynamics;
pub mod inverse_kinematics;
mod jacobian;
mod mass_matrix;
mod motion;
mod placement;
mod posture;
mod regressor;
#[cfg(test)]
mod tests;
mod weight;

pub use chain::{Chain, ChainError, ChainJoint, JointKind, PositionLimits};
pub use inertia::{LINK_PARAMETERS, LinkInertia};
pub use jacobian::Jacobian;
pub use mass_matrix::MassMatrix;
pub use nalgebra::{Matrix3, Matrix4, Vector3, Vector6};
pub use placement::{Placement, rotation, rotation_vector};
pub use posture::Posture;
pub use regressor::{REGRESSOR_COLUMNS, Regressor};

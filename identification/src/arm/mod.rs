//! A whole arm: every joint's model, with the torque of its rigid bodies as the load.
//!
//! To the pipeline each joint is a joint whose load is known: τ_m = J q̈ + τ + τ_F, J the
//! armature (motor and gear) and τ what the links take, by inverse dynamics of all
//! joints' motions ([`mod@motion`], [`rigid_body`]). The other joints' velocities and
//! torques come along as extra signals, so that coupling is one of the effects that
//! are tried ([`JointCoupling`](crate::effects::JointCoupling)). What τ lacks is an
//! effect of the arm ([`ArmEffect`]): a payload, a base that is not level, a link's
//! inertial parameters. Its coefficients are shared by all joints, each weighted by its
//! noise, and are fitted together with all joints' own ([`shared`]); what they make of a
//! link is always a body that can exist ([`possible`]).

mod addition;
mod comparison;
mod contest;
mod data;
mod diagnosis;
mod discovery;
mod effects;
mod error;
mod joint;
mod misread;
mod motion;
mod parts;
mod possible;
mod prepared;
mod rigid_body;
mod shared;
mod soft_gears;
mod spec;
mod term;
#[cfg(test)]
mod tests;
mod trial;

pub use addition::{ArmAddition, add};
pub use comparison::{ArmComparison, compare};
pub use data::{ArmDataset, ArmSession};
pub use diagnosis::{
    ArmCandidate, ArmDependence, ArmDiagnosis, ArmSuspect, JointDiagnosis, diagnose,
};
pub use discovery::{ArmDiscovery, ArmFormula, discover};
pub use effects::ArmEffect;
pub use error::ArmError;
pub use joint::ArmJoint;
pub use misread::Misread;
pub use parts::{ArmParts, Body, take_apart};
pub use prepared::PreparedArm;
pub use spec::ArmSpec;
pub use term::ArmTerm;

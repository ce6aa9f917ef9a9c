//! The messages as nodes read and write them: fixed size, `repr(C)`.

mod checks;
mod codes;
mod fault;
mod frame;
mod health;
mod identity;
mod joint;
mod joint_names;
mod lists;
mod own;
mod pose;
mod robot;
mod robot_description;
mod standard;
mod transforms;
mod wrench;

pub use crate::layout::{Field, Flag, Identity, Plain, Rule, Sample};
pub use codes::Named;
pub use fault::{Fault, Faults};
pub use frame::Frame;
pub use health::{HealthSample, Level};
pub use joint::{JointFields, JointSample};
pub use joint_names::{JointNames, MAX_JOINTS};
pub use lists::MAX_TWIN_PARAMETERS;
pub use own::*;
pub use pose::PoseSample;
pub use robot::{ControllerCommandSample, MAX_ROBOT_JOINTS, RobotJointsSample};
pub use robot_description::{LONGEST_DESCRIPTION, RobotDescriptionSample};
pub use standard::*;
pub use transforms::{ARM_FRAMES, MAX_FRAMES, TransformsSample};
pub use wrench::WrenchSample;

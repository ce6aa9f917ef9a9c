//! The joints of the arm that recordings are of.

use std::{collections::BTreeMap, fs, path::Path};

use ferntast_identification::JointType;
use ferntast_urdf::{Joint, JointType as UrdfJointType, Robot};
use serde::Serialize;

use super::{NewError, request::OfArm};
use crate::experiment::units_of_joint;

/// A joint of an arm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ArmJoint {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub joint: JointType,
    /// The units that its signals may have, by `position` and `motor_torque`.
    pub units: BTreeMap<&'static str, Vec<&'static str>>,
}

/// The joints of an arm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ArmChain {
    /// From the base on.
    pub joints: Vec<ArmJoint>,
    /// Names of all joints of the file that move, none before one that carries it.
    pub there: Vec<String>,
}

impl ArmChain {
    /// Reads them; where none are said they are those of the URDF's arm.
    pub(super) fn read(of: &OfArm) -> Result<ArmChain, NewError> {
        let robot = robot(&of.urdf)?;
        let arm = match of.joints.is_empty() {
            true => robot.whole_arm().map_err(|error| {
                format!("{error}; or list its joints, from the base on (--joints)")
            }),
            false => (robot.of_joints(&of.joints)).map_err(|error| error.to_string()),
        };
        let arm = arm.map_err(|reason| wrong(&of.urdf, reason))?;
        let kinds = arm.chain.kinds();
        let joints = arm
            .joints
            .into_iter()
            .zip(kinds.iter())
            .map(|(name, kind)| {
                let joint = JointType::from(*kind);
                let units =
                    ["position", "motor_torque"].map(|key| (key, units_of_joint(key, joint)));
                ArmJoint {
                    name,
                    joint,
                    units: units.into(),
                }
            });
        let moving = robot.joints.iter();
        let moving = moving.filter(|own| own.joint_type != UrdfJointType::Fixed);
        let mut moving: Vec<&Joint> = moving.collect();
        // The file may have them in any order.
        moving.sort_by_key(|own| depth(&robot, own));
        Ok(ArmChain {
            joints: joints.collect(),
            there: moving.iter().map(|own| own.name.clone()).collect(),
        })
    }

    /// Names of the joints from the base on.
    pub(super) fn names(&self) -> Vec<&str> {
        self.joints.iter().map(|own| own.name.as_str()).collect()
    }
}

/// How many joints carry this one.
fn depth(robot: &Robot, joint: &Joint) -> usize {
    let carrier = |of: &&Joint| robot.joints.iter().find(|own| own.child == of.parent);
    std::iter::successors(Some(joint), |own| carrier(own)).count()
}

fn robot(urdf: &Path) -> Result<Robot, NewError> {
    let bytes = fs::read(urdf).map_err(|error| wrong(urdf, error.to_string()))?;
    Robot::read(&bytes).map_err(|error| wrong(urdf, error.to_string()))
}

fn wrong(urdf: &Path, reason: String) -> NewError {
    NewError::Urdf {
        path: urdf.to_owned(),
        reason,
    }
}

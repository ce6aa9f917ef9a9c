//! State or command of both joints.

use ferntast_derive::sample;

use crate::{
    InvalidMessage, Message, Time,
    ros::{sensor_msgs::JointState, std_msgs::Header},
};

use super::{Plain, checks};

/// The arm's number of joints.
pub const JOINTS: usize = 2;

/// Names of the joints on the wire, in the order of the arrays here.
pub const JOINT_NAMES: [&str; JOINTS] = ["joint_1", "joint_2"];

/// Which of the quantities a [`JointSample`] carries (bit set).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct JointFields(pub u32);

impl JointFields {
    /// Positions are given.
    pub const POSITION: JointFields = JointFields(1);
    /// Velocities are given.
    pub const VELOCITY: JointFields = JointFields(2);
    /// Efforts are given.
    pub const EFFORT: JointFields = JointFields(4);
    /// All three are given.
    pub const ALL: JointFields = JointFields(7);

    /// None is given.
    pub const NONE: JointFields = JointFields(0);

    /// Whether all of `fields` are in this set.
    pub const fn has(self, fields: JointFields) -> bool {
        self.0 & fields.0 == fields.0
    }

    /// This set with `fields` added.
    pub const fn with(self, fields: JointFields) -> JointFields {
        JointFields(self.0 | fields.0)
    }
}

/// Positions, velocities and efforts of joint 1 and joint 2, on the joint
/// side of the gear. `sensor_msgs/msg/JointState` on the wire.
#[sample]
pub struct JointSample {
    /// When it was measured or commanded.
    pub stamp: Time,
    /// Joint positions \[rad\].
    pub position: [f64; JOINTS],
    /// Joint velocities \[rad/s\].
    pub velocity: [f64; JOINTS],
    /// Joint torques \[Nm\]; which torque, the topic says.
    pub effort: [f64; JOINTS],
    /// Which of the three are given; the others hold zero.
    #[field(bytes = 4)]
    pub fields: JointFields,
}

impl JointSample {
    /// All three quantities given as zero.
    pub const fn zero(stamp: Time) -> JointSample {
        JointSample {
            stamp,
            position: [0.0; JOINTS],
            velocity: [0.0; JOINTS],
            effort: [0.0; JOINTS],
            fields: JointFields::ALL,
            reserved: [0; 4],
        }
    }

    /// Positions only \[rad\].
    pub const fn positions(stamp: Time, position: [f64; JOINTS]) -> JointSample {
        JointSample {
            position,
            fields: JointFields::POSITION,
            ..JointSample::zero(stamp)
        }
    }

    /// Efforts only \[Nm\].
    pub const fn efforts(stamp: Time, effort: [f64; JOINTS]) -> JointSample {
        JointSample {
            effort,
            fields: JointFields::EFFORT,
            ..JointSample::zero(stamp)
        }
    }
}

// SAFETY: a number in a transparent type.
unsafe impl Plain for JointFields {}

impl Message for JointSample {
    type Ros = JointState;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> JointState {
        let given = |field, values: &[f64; JOINTS]| match self.fields.has(field) {
            true => values.to_vec(),
            false => Vec::new(),
        };
        JointState {
            header: Header::new(self.stamp, ""),
            name: JOINT_NAMES.map(String::from).to_vec(),
            position: given(JointFields::POSITION, &self.position),
            velocity: given(JointFields::VELOCITY, &self.velocity),
            effort: given(JointFields::EFFORT, &self.effort),
        }
    }

    /// Takes the joints in any order; `header.frame_id` does not count.
    fn from_ros(ros: &JointState) -> Result<JointSample, InvalidMessage> {
        let order = order(&ros.name)?;
        let mut fields = JointFields::NONE;
        let mut read = |field, name, values: &[f64]| match *values {
            [] => Ok([0.0; JOINTS]),
            [first, second] => {
                fields = fields.with(field);
                let values = [first, second];
                Ok(order.map(|index| values[index]))
            }
            _ => Err(InvalidMessage::WrongLength {
                field: name,
                found: values.len(),
                expected: JOINTS,
            }),
        };
        let position = read(JointFields::POSITION, "position", &ros.position)?;
        let velocity = read(JointFields::VELOCITY, "velocity", &ros.velocity)?;
        let effort = read(JointFields::EFFORT, "effort", &ros.effort)?;
        let sample = JointSample {
            stamp: ros.header.time(),
            position,
            velocity,
            effort,
            fields,
            reserved: [0; 4],
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite("position", &self.position)?;
        checks::finite("velocity", &self.velocity)?;
        checks::finite("effort", &self.effort)?;
        if !JointFields::ALL.has(self.fields) {
            let known = "bits 1 (position), 2 (velocity), 4 (effort)";
            return Err(checks::unknown("fields", self.fields.0, known));
        }
        Ok(())
    }
}

/// Where joint 1 and joint 2 stand among `names`.
fn order(names: &[String]) -> Result<[usize; JOINTS], InvalidMessage> {
    if names.len() != JOINTS {
        return Err(InvalidMessage::WrongLength {
            field: "name",
            found: names.len(),
            expected: JOINTS,
        });
    }
    if names == JOINT_NAMES {
        Ok([0, 1])
    } else if names.iter().rev().eq(&JOINT_NAMES) {
        Ok([1, 0])
    } else {
        Err(InvalidMessage::WrongJoints {
            found: names.to_vec(),
        })
    }
}

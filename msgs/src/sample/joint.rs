//! State or command of the joints.

use std::borrow::Cow;

use ferntast_derive::sample;

use crate::{
    InvalidMessage, Message, Time,
    ros::{sensor_msgs::JointState, std_msgs::Header},
};

use super::{JointNames, MAX_JOINTS, Plain, checks, lists};

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

/// A number of each joint; those after the last joint are zero.
type Numbers = [f64; MAX_JOINTS];

/// Positions, velocities and efforts of joints, on the joint side of the gear.
/// `sensor_msgs/msg/JointState` on the wire.
#[sample]
pub struct JointSample {
    /// When it was measured or commanded.
    pub stamp: Time,
    /// The joints, in the order of the numbers.
    #[field(bytes = 264)]
    pub joints: JointNames,
    /// Joint positions \[rad\].
    pub position: [f64; MAX_JOINTS],
    /// Joint velocities \[rad/s\].
    pub velocity: [f64; MAX_JOINTS],
    /// Joint torques \[Nm\]; which torque, the topic says.
    pub effort: [f64; MAX_JOINTS],
    /// Which of the three are given; the others hold zero.
    #[field(bytes = 4)]
    pub fields: JointFields,
}

// SAFETY: a number in a transparent type.
unsafe impl Plain for JointFields {}

impl JointSample {
    /// All three quantities given as zero.
    #[inline]
    pub const fn zero(joints: JointNames, stamp: Time) -> JointSample {
        JointSample::of(JointFields::ALL, joints, stamp)
    }

    /// Nothing given yet: see [`with_position`](Self::with_position) and its like.
    #[inline]
    pub const fn empty(joints: JointNames, stamp: Time) -> JointSample {
        JointSample::of(JointFields::NONE, joints, stamp)
    }

    #[inline]
    const fn of(fields: JointFields, joints: JointNames, stamp: Time) -> JointSample {
        JointSample {
            stamp,
            joints,
            position: [0.0; MAX_JOINTS],
            velocity: [0.0; MAX_JOINTS],
            effort: [0.0; MAX_JOINTS],
            fields,
            reserved: [0; 4],
        }
    }

    /// The same with these positions \[rad\].
    pub fn with_position<const N: usize>(self, position: [f64; N]) -> JointSample {
        JointSample {
            position: padded(&position),
            fields: self.fields.with(JointFields::POSITION),
            ..self
        }
    }

    /// The same with these velocities \[rad/s\].
    pub fn with_velocity<const N: usize>(self, velocity: [f64; N]) -> JointSample {
        JointSample {
            velocity: padded(&velocity),
            fields: self.fields.with(JointFields::VELOCITY),
            ..self
        }
    }

    /// The same with these efforts \[Nm\].
    pub fn with_effort<const N: usize>(self, effort: [f64; N]) -> JointSample {
        JointSample {
            effort: padded(&effort),
            fields: self.fields.with(JointFields::EFFORT),
            ..self
        }
    }

    /// Gives these positions \[rad\], in place.
    #[inline]
    pub fn set_position(&mut self, position: &[f64]) {
        self.position = padded(position);
        self.fields = self.fields.with(JointFields::POSITION);
    }

    /// Gives these velocities \[rad/s\], in place.
    #[inline]
    pub fn set_velocity(&mut self, velocity: &[f64]) {
        self.velocity = padded(velocity);
        self.fields = self.fields.with(JointFields::VELOCITY);
    }

    /// Gives these efforts \[Nm\], in place.
    #[inline]
    pub fn set_effort(&mut self, effort: &[f64]) {
        self.effort = padded(effort);
        self.fields = self.fields.with(JointFields::EFFORT);
    }

    /// Positions of the first `N` joints \[rad\].
    pub fn position<const N: usize>(&self) -> [f64; N] {
        first(&self.position)
    }

    /// Velocities of the first `N` joints \[rad/s\].
    pub fn velocity<const N: usize>(&self) -> [f64; N] {
        first(&self.velocity)
    }

    /// Efforts of the first `N` joints \[Nm\].
    pub fn effort<const N: usize>(&self) -> [f64; N] {
        first(&self.effort)
    }

    /// The same with its joints in the order of `joints`: itself where they are in it;
    /// `None` where it is not about exactly these.
    pub fn in_order_of(&self, joints: &JointNames) -> Option<Cow<'_, JointSample>> {
        if self.joints == *joints {
            return Some(Cow::Borrowed(self));
        }
        if self.joints.len() != joints.len() {
            return None;
        }
        let mut sorted = JointSample {
            fields: self.fields,
            ..JointSample::zero(*joints, self.stamp)
        };
        for (to, name) in joints.iter().enumerate() {
            let from = self.joints.index(name)?;
            sorted.position[to] = self.position[from];
            sorted.velocity[to] = self.velocity[from];
            sorted.effort[to] = self.effort[from];
        }
        Some(Cow::Owned(sorted))
    }

    /// What is to be checked beside the joints' names.
    fn check_numbers(&self) -> Result<(), InvalidMessage> {
        for (_, name, values) in self.quantities() {
            checks::finite(name, &values[..self.joints.len()])?;
        }
        if !JointFields::ALL.has(self.fields) {
            let known = "bits 1 (position), 2 (velocity), 4 (effort)";
            return Err(checks::unknown("fields", self.fields.0, known));
        }
        Ok(())
    }

    /// The three quantities by name.
    fn quantities(&self) -> [(JointFields, &'static str, &Numbers); 3] {
        [
            (JointFields::POSITION, "position", &self.position),
            (JointFields::VELOCITY, "velocity", &self.velocity),
            (JointFields::EFFORT, "effort", &self.effort),
        ]
    }
}

#[inline]
fn padded(numbers: &[f64]) -> Numbers {
    let mut places = [0.0; MAX_JOINTS];
    for (place, number) in places.iter_mut().zip(numbers) {
        *place = *number;
    }
    places
}

fn first<const N: usize>(numbers: &Numbers) -> [f64; N] {
    std::array::from_fn(|joint| numbers.get(joint).copied().unwrap_or(0.0))
}

impl Message for JointSample {
    type Ros = JointState;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> JointState {
        let [position, velocity, effort] =
            self.quantities()
                .map(|(field, _, values)| match self.fields.has(field) {
                    true => values[..self.joints.len()].to_vec(),
                    false => Vec::new(),
                });
        JointState {
            header: Header::new(self.stamp, ""),
            name: self.joints.iter().map(String::from).collect(),
            position,
            velocity,
            effort,
        }
    }

    /// Takes up to [`MAX_JOINTS`] joints of any names, in the order in which
    /// they come; `header.frame_id` does not count.
    fn from_ros(ros: &JointState) -> Result<JointSample, InvalidMessage> {
        let joints = JointNames::new(ros.name.iter().map(String::as_str))?;
        let mut sample = JointSample::empty(joints, ros.header.time());
        let mut read = |field, name, values: &[f64]| {
            let mut places = [0.0; MAX_JOINTS];
            if !values.is_empty() {
                sample.fields = sample.fields.with(field);
                lists::fill(name, &mut places, joints.len() as u32, values, |own| *own)?;
            }
            Ok(places)
        };
        let position = read(JointFields::POSITION, "position", &ros.position)?;
        let velocity = read(JointFields::VELOCITY, "velocity", &ros.velocity)?;
        let effort = read(JointFields::EFFORT, "effort", &ros.effort)?;
        let sample = JointSample {
            position,
            velocity,
            effort,
            ..sample
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        self.joints.check()?;
        self.check_numbers()
    }

    fn check_after(&self, before: &JointSample) -> Result<(), InvalidMessage> {
        if self.joints != before.joints {
            return self.check();
        }
        checks::stamp(self.stamp)?;
        self.check_numbers()
    }
}

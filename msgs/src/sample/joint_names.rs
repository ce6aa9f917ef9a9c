//! The joints that a message is about, by name.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Plain;
use crate::{InvalidMessage, Text};

/// The most joints that a message has room for.
pub const MAX_JOINTS: usize = 8;
/// The longest name that a joint may have \[byte\].
pub const LONGEST_JOINT_NAME: usize = 32;

/// Up to [`MAX_JOINTS`] joints by name, each once, in an order. In a file a
/// list of names.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Vec<String>", into = "Vec<String>")]
#[repr(C)]
pub struct JointNames {
    names: [Text<LONGEST_JOINT_NAME>; MAX_JOINTS],
    count: u64,
}

// SAFETY: texts and a number, eight bytes aligned, without padding.
unsafe impl Plain for JointNames {}
const _: () = assert!(size_of::<JointNames>() == MAX_JOINTS * LONGEST_JOINT_NAME + 8);

impl JointNames {
    /// The joints of these names.
    ///
    /// # Errors
    ///
    /// None or more than [`MAX_JOINTS`], a name twice, empty, or of more than
    /// [`LONGEST_JOINT_NAME`] bytes.
    pub fn new<'a>(
        names: impl IntoIterator<Item = &'a str, IntoIter: Clone>,
    ) -> Result<JointNames, InvalidMessage> {
        let names = names.into_iter();
        let count = names.clone().count();
        let refuse = || InvalidMessage::WrongJoints {
            found: names.clone().map(String::from).collect(),
        };
        let mut joints = JointNames {
            names: [Text::EMPTY; MAX_JOINTS],
            count: count as u64,
        };
        for (place, name) in joints.names.iter_mut().zip(names.clone()) {
            *place = Text::new(name);
            if place.as_str() != name {
                return Err(refuse());
            }
        }
        match joints.are_valid() {
            true => Ok(joints),
            false => Err(refuse()),
        }
    }

    /// The first `count` of `joint_1`, `joint_2`, …: of an arm whose joints are
    /// not named otherwise.
    pub fn numbered(count: usize) -> JointNames {
        let count = count.clamp(1, MAX_JOINTS);
        let name = |joint| match joint < count {
            true => Text::display(format_args!("joint_{}", joint + 1)),
            false => Text::EMPTY,
        };
        JointNames {
            names: std::array::from_fn(name),
            count: count as u64,
        }
    }

    /// How many there are.
    #[expect(clippy::len_without_is_empty, reason = "there is always one")]
    pub fn len(&self) -> usize {
        (self.count as usize).min(MAX_JOINTS)
    }

    /// The names in order.
    pub fn iter(&self) -> impl Iterator<Item = &str> + Clone {
        self.names[..self.len()].iter().map(Text::as_str)
    }

    /// The name of the joint at that place.
    pub fn get(&self, joint: usize) -> Option<&str> {
        self.iter().nth(joint)
    }

    /// The place of the joint of that name.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.iter().position(|known| known == name)
    }

    /// Refuses what cannot be the joints of a message.
    pub(super) fn check(&self) -> Result<(), InvalidMessage> {
        match self.are_valid() {
            true => Ok(()),
            false => Err(InvalidMessage::WrongJoints {
                found: self.iter().map(String::from).collect(),
            }),
        }
    }

    fn are_valid(&self) -> bool {
        let names = &self.names[..self.len()];
        // As they nearly always are: plain ASCII, then zeros. Bytes tell them apart then.
        if names.iter().all(Text::is_plain) {
            // Texts whose bytes come to different numbers are different; most do.
            let mut sums = [0; MAX_JOINTS];
            for (sum, name) in sums.iter_mut().zip(names) {
                *sum = name.sum();
            }
            let different = |(place, name): (usize, &Text<LONGEST_JOINT_NAME>)| {
                let alike = |other: usize| sums[other] == sums[place] && names[other] == *name;
                !name.is_empty() && !(0..place).any(alike)
            };
            return (1..=MAX_JOINTS as u64).contains(&self.count)
                && names.iter().enumerate().all(different);
        }
        let mut names = [""; MAX_JOINTS];
        for (place, name) in names.iter_mut().zip(self.iter()) {
            *place = name;
        }
        let names = &names[..self.len()];
        let different =
            |(place, name): (usize, &&str)| !name.is_empty() && !names[..place].contains(name);
        (1..=MAX_JOINTS as u64).contains(&self.count) && names.iter().enumerate().all(different)
    }
}

impl TryFrom<Vec<String>> for JointNames {
    type Error = InvalidMessage;

    fn try_from(names: Vec<String>) -> Result<JointNames, InvalidMessage> {
        JointNames::new(names.iter().map(String::as_str))
    }
}

impl From<JointNames> for Vec<String> {
    fn from(joints: JointNames) -> Vec<String> {
        joints.iter().map(str::to_owned).collect()
    }
}

impl fmt::Debug for JointNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl fmt::Display for JointNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, name) in self.iter().enumerate() {
            let comma = if place > 0 { ", " } else { "" };
            write!(f, "{comma}{name}")?;
        }
        Ok(())
    }
}

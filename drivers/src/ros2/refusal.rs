//! Why what a robot tells of its joints is not used.

use std::fmt;

use ferntast_msgs::{
    Text,
    sample::{Fault, JointNames},
};

/// Why a joint state gives no reading, or there is none. Joints by their number from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// Nothing has come yet.
    NothingYet,
    /// Nothing has come for so long \[s\].
    Silent(f64),
    /// They come too seldom \[Hz\].
    Slow {
        /// How often.
        rate: f64,
        /// How often is needed.
        needed: f64,
    },
    /// It is so much older than the others when it comes \[s\].
    Late(f64),
    /// It has the stamp of the one before, or an earlier one.
    StampStands,
    /// It is not about this joint of the arm.
    Missing(usize),
    /// A number that is none, or is not given.
    NotGiven {
        /// Of what.
        what: &'static str,
        /// Of which joint.
        joint: usize,
    },
    /// A position that the joint cannot have.
    OutOfRange {
        /// Which joint.
        joint: usize,
        /// Where it is said to be \[rad\] or \[m\].
        position: f64,
        /// Where it can be.
        range: [f64; 2],
    },
    /// A velocity that the joint cannot have.
    TooFast {
        /// Which joint.
        joint: usize,
        /// How fast it is said to be \[rad/s\] or \[m/s\].
        velocity: f64,
        /// How fast it can be.
        limit: f64,
    },
    /// A position that the joint cannot have got to.
    Jumped {
        /// Which joint.
        joint: usize,
        /// How far \[rad\] or \[m\].
        by: f64,
    },
    /// All is well again, but not for long enough.
    Settling,
}

impl Refusal {
    /// The fault that it is.
    pub const fn fault(self) -> Fault {
        match self {
            Refusal::NothingYet
            | Refusal::Silent(_)
            | Refusal::Slow { .. }
            | Refusal::Late(_)
            | Refusal::StampStands
            | Refusal::Settling => Fault::MeasurementSilent,
            _ => Fault::MeasurementInvalid,
        }
    }

    /// It in words, of an arm of those joints, which `topic` tells of.
    pub fn words(self, joints: &JointNames, topic: &str) -> Text<96> {
        Text::display(InWords {
            refusal: self,
            joints,
            topic,
        })
    }
}

struct InWords<'a> {
    refusal: Refusal,
    joints: &'a JointNames,
    topic: &'a str,
}

impl fmt::Display for InWords<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let topic = self.topic;
        let name = |joint: usize| self.joints.get(joint).unwrap_or_default();
        match self.refusal {
            Refusal::NothingYet => {
                write!(f, "nothing on {topic} yet: does the robot's driver run?")
            }
            Refusal::Silent(seconds) => write!(f, "{topic} is silent for {seconds:.2} s"),
            Refusal::Slow { rate, needed } => {
                write!(
                    f,
                    "{topic} comes at {rate:.0} Hz, {needed:.0} Hz are needed"
                )
            }
            Refusal::Late(seconds) => {
                write!(f, "{topic} comes {:.0} ms late", seconds * 1e3)
            }
            Refusal::StampStands => write!(f, "{topic}: the stamp stands still"),
            Refusal::Missing(joint) => write!(f, "{topic} lacks joint {}", name(joint)),
            Refusal::NotGiven { what, joint } => {
                write!(f, "{what} of {} is NaN or not given", name(joint))
            }
            Refusal::OutOfRange {
                joint,
                position,
                range: [lower, upper],
            } => {
                let turned = position.to_radians();
                let hint = match (lower..=upper).contains(&turned) {
                    true => "degrees?",
                    false => "zero or sign wrong?",
                };
                let name = name(joint);
                write!(
                    f,
                    "{name} at {position:.2}, not in {lower:.2} … {upper:.2}: {hint}"
                )
            }
            Refusal::TooFast {
                joint,
                velocity,
                limit,
            } => write!(
                f,
                "{} at {velocity:.2} rad/s, the limit is {limit:.2}",
                name(joint)
            ),
            Refusal::Jumped { joint, by } => write!(f, "{} jumped by {by:.3} rad", name(joint)),
            Refusal::Settling => write!(f, "{topic} is well again, not yet for long enough"),
        }
    }
}

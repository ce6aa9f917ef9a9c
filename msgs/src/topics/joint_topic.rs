//! A topic that there is once a joint.

use std::marker::PhantomData;

use super::{Authority, Delivery, Topic, TopicName, TopicNameError};
use crate::{Message, sample::JointNames};

/// Where the joint's name stands in the name of a [`JointTopic`].
const JOINT: &str = "{joint}";

/// A topic that there is once a joint, under the joint's name:
/// `/follower/{joint}/temperature`.
#[derive(Debug)]
pub struct JointTopic<M: Message> {
    /// Its name, with `{joint}` where the joint's stands.
    pub pattern: &'static str,
    /// What stands before the joint's name, and after it.
    around: (&'static str, &'static str),
    delivery: Delivery,
    publishers: &'static [&'static str],
    authority: Authority,
    sample: PhantomData<fn() -> M>,
}

/// Why a joint of that name has no topics.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "joint {joint:?} cannot have the topic {pattern}: {source}; name joints by letters, digits and single _, a letter first"
)]
pub struct JointNameError {
    /// The joint's name.
    pub joint: String,
    /// The topic's name, with `{joint}` where the joint's stands.
    pub pattern: &'static str,
    /// What is wrong.
    pub source: TopicNameError,
}

impl<M: Message> Clone for JointTopic<M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: Message> Copy for JointTopic<M> {}

impl<M: Message> JointTopic<M> {
    /// A row of the table; a pattern without `{joint}` does not compile there.
    pub(super) const fn of_table(
        pattern: &'static str,
        delivery: Delivery,
        publishers: &'static [&'static str],
        authority: Authority,
    ) -> JointTopic<M> {
        JointTopic {
            pattern,
            around: around(pattern),
            delivery,
            publishers,
            authority,
            sample: PhantomData,
        }
    }

    /// The topic of the joint of that name.
    ///
    /// # Errors
    ///
    /// A name that cannot be part of a topic's.
    pub fn of(&self, joint: &str) -> Result<Topic<M>, JointNameError> {
        let name = match joint {
            "" => Err(TopicNameError::Empty),
            // It would be another part of the name.
            joint if joint.contains('/') => Err(TopicNameError::Character),
            joint => {
                let (before, after) = self.around;
                TopicName::new(&format!("{before}{joint}{after}"))
            }
        };
        match name {
            Ok(name) => Ok(Topic::of(
                name,
                self.delivery,
                self.publishers,
                self.authority,
            )),
            Err(source) => Err(JointNameError {
                joint: joint.to_owned(),
                pattern: self.pattern,
                source,
            }),
        }
    }

    /// The topics of these joints, in their order.
    ///
    /// # Errors
    ///
    /// As [`JointTopic::of`].
    pub fn of_joints(&self, joints: &JointNames) -> Result<Vec<Topic<M>>, JointNameError> {
        joints.iter().map(|joint| self.of(joint)).collect()
    }

    /// The joint whose topic of this kind has that name.
    pub fn joint_of<'a>(&self, topic: &'a str) -> Option<&'a str> {
        let (before, after) = self.around;
        let joint = topic.strip_prefix(before)?.strip_suffix(after)?;
        self.of(joint).is_ok().then_some(joint)
    }
}

/// What stands before `{joint}`, and after it.
const fn around(pattern: &'static str) -> (&'static str, &'static str) {
    let mut at = 0;
    while at + JOINT.len() <= pattern.len() {
        let (before, rest) = pattern.split_at(at);
        let (joint, after) = rest.split_at(JOINT.len());
        let mut same = 0;
        while same < JOINT.len() && joint.as_bytes()[same] == JOINT.as_bytes()[same] {
            same += 1;
        }
        if same == JOINT.len() {
            return (before, after);
        }
        at += 1;
    }
    panic!("no {{joint}} in the name of a topic of each joint")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topics::{FOLLOWER_JOINT_TEMPERATURE, FOLLOWER_MEASURED_JS};

    #[test]
    fn a_topic_has_its_joint_s_name_and_is_known_by_it() {
        let joints = JointNames::new(["panda_joint1", "J2"]).unwrap();
        let topics = FOLLOWER_JOINT_TEMPERATURE.of_joints(&joints).unwrap();
        let names = topics.iter().map(|topic| topic.name.as_str());
        let expected = [
            "/follower/panda_joint1/temperature",
            "/follower/J2/temperature",
        ];
        assert_eq!(names.collect::<Vec<_>>(), expected);
        for (topic, joint) in topics.iter().zip(joints.iter()) {
            let known = FOLLOWER_JOINT_TEMPERATURE.joint_of(&topic.name);
            assert_eq!(known, Some(joint));
        }
        for other in [
            FOLLOWER_MEASURED_JS.name.as_str(),
            "/follower/J2/friction",
            "/follower/temperature",
            "/follower//temperature",
            "/follower/a/b/temperature",
        ] {
            assert_eq!(FOLLOWER_JOINT_TEMPERATURE.joint_of(other), None, "{other}");
        }
    }

    #[test]
    fn a_joint_that_ros_2_could_not_name_is_refused_in_words() {
        let long = "j".repeat(50);
        for (joint, words) in [
            ("", "empty"),
            ("2nd", "begins with a digit"),
            ("joint 1", "other characters"),
            ("élbow", "other characters"),
            ("a/b", "other characters"),
            ("a__b", "two _"),
            (&long, "more than 64"),
        ] {
            let error = FOLLOWER_JOINT_TEMPERATURE.of(joint).unwrap_err();
            let text = error.to_string();
            assert!(text.contains(words), "{text}");
            let named = format!("joint {joint:?} cannot have the topic /follower/{{joint}}/");
            assert!(text.starts_with(&named), "{text}");
        }
    }
}

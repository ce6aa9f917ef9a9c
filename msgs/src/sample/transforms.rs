//! Where the arm's frames are.

use ferntast_derive::sample;

use crate::{
    InvalidMessage, Message, Time,
    ros::{
        geometry_msgs::{Transform, TransformStamped},
        std_msgs::Header,
        tf2_msgs::TFMessage,
    },
};

use super::checks;

/// The arm's frames, each as parent and child, from the base to the tip.
pub const ARM_FRAMES: [(&str, &str); 3] = [
    ("follower_base", "link_1"),
    ("link_1", "link_2"),
    ("link_2", "follower_tip"),
];

/// Where each of [`ARM_FRAMES`] is in its parent. `tf2_msgs/msg/TFMessage` on
/// the wire.
#[sample]
pub struct TransformsSample {
    /// When the joints were there.
    pub stamp: Time,
    /// Origins of the children in their parents \[m\].
    pub translations: [[f64; 3]; ARM_FRAMES.len()],
    /// Rotations from the parents' axes to the children's: x, y, z, w.
    pub rotations: [[f64; 4]; ARM_FRAMES.len()],
}

impl Message for TransformsSample {
    type Ros = TFMessage;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> TFMessage {
        let places = self.translations.iter().zip(&self.rotations);
        let transforms = ARM_FRAMES.iter().zip(places);
        TFMessage {
            transforms: transforms
                .map(
                    |(&(parent, child), (&translation, &rotation))| TransformStamped {
                        header: Header::new(self.stamp, parent),
                        child_frame_id: child.to_owned(),
                        transform: Transform {
                            translation: translation.into(),
                            rotation: rotation.into(),
                        },
                    },
                )
                .collect(),
        }
    }

    /// Takes messages with exactly the arm's frames, in their order and with one stamp.
    fn from_ros(ros: &TFMessage) -> Result<TransformsSample, InvalidMessage> {
        if ros.transforms.len() != ARM_FRAMES.len() {
            return Err(InvalidMessage::WrongLength {
                field: "transforms",
                found: ros.transforms.len(),
                expected: ARM_FRAMES.len(),
            });
        }
        let mut sample = TransformsSample {
            stamp: Time::INVALID,
            translations: Default::default(),
            rotations: Default::default(),
        };
        for (index, (stamped, (parent, child))) in ros.transforms.iter().zip(ARM_FRAMES).enumerate()
        {
            let found = (
                stamped.header.frame_id.as_str(),
                stamped.child_frame_id.as_str(),
            );
            if found != (parent, child) {
                return Err(checks::unknown(
                    "child_frame_id",
                    &stamped.child_frame_id,
                    KNOWN,
                ));
            }
            let stamp = stamped.header.time();
            if index > 0 && stamp != sample.stamp {
                return Err(checks::unknown(
                    "header.stamp",
                    stamp.nanos(),
                    "the stamp of the first transform",
                ));
            }
            sample.stamp = stamp;
            sample.translations[index] = (&stamped.transform.translation).into();
            sample.rotations[index] = (&stamped.transform.rotation).into();
        }
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite("transform.translation", self.translations.as_flattened())?;
        for rotation in &self.rotations {
            checks::unit_quaternion("transform.rotation", rotation)?;
        }
        Ok(())
    }
}

/// The arm's frames, for error texts.
const KNOWN: &str = "link_1 in follower_base, link_2 in link_1, follower_tip in link_2";

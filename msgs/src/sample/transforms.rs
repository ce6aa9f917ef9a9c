//! Where the arm's frames are.

use ferntast_derive::sample;

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{
        geometry_msgs::{Transform, TransformStamped},
        std_msgs::Header,
        tf2_msgs::TFMessage,
    },
};

use super::checks;

/// The planar arm's frames, each as parent and child, from the base to the tip.
pub const ARM_FRAMES: [(&str, &str); 3] = [
    ("follower_base", "link_1"),
    ("link_1", "link_2"),
    ("link_2", "follower_tip"),
];

/// The most frames that a message has room for: those of eight links, the base and the tip.
pub const MAX_FRAMES: usize = 10;
/// The longest name of a frame \[byte\].
const LONGEST_NAME: usize = 48;

/// Where up to [`MAX_FRAMES`] frames are, each in another one. `tf2_msgs/msg/TFMessage` on
/// the wire.
#[sample]
pub struct TransformsSample {
    /// When the joints were there.
    pub stamp: Time,
    /// How many there are.
    pub count: u64,
    /// The frames that the others are in.
    #[field(bytes = 480)]
    pub parents: [Text<LONGEST_NAME>; MAX_FRAMES],
    /// The frames themselves.
    #[field(bytes = 480)]
    pub children: [Text<LONGEST_NAME>; MAX_FRAMES],
    /// Origins of the children in their parents \[m\].
    pub translations: [[f64; 3]; MAX_FRAMES],
    /// Rotations from the parents' axes to the children's: x, y, z, w.
    pub rotations: [[f64; 4]; MAX_FRAMES],
}

/// Not turned: x, y, z, w.
const UNTURNED: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

impl TransformsSample {
    /// No frames yet.
    pub const fn empty(stamp: Time) -> TransformsSample {
        TransformsSample {
            stamp,
            count: 0,
            parents: [Text::EMPTY; MAX_FRAMES],
            children: [Text::EMPTY; MAX_FRAMES],
            translations: [[0.0; 3]; MAX_FRAMES],
            rotations: [UNTURNED; MAX_FRAMES],
        }
    }

    /// The same with `child` in `parent`, its origin at `translation` \[m\] and turned by
    /// `rotation` (x, y, z, w); without a place left it stays as it is.
    #[must_use]
    pub fn with(
        mut self,
        parent: &str,
        child: &str,
        translation: [f64; 3],
        rotation: [f64; 4],
    ) -> TransformsSample {
        let place = self.len();
        if place < MAX_FRAMES {
            self.parents[place] = Text::new(parent);
            self.children[place] = Text::new(child);
            self.translations[place] = translation;
            self.rotations[place] = rotation;
            self.count += 1;
        }
        self
    }

    /// The planar arm's frames, those of [`ARM_FRAMES`].
    pub fn planar(
        stamp: Time,
        translations: [[f64; 3]; ARM_FRAMES.len()],
        rotations: [[f64; 4]; ARM_FRAMES.len()],
    ) -> TransformsSample {
        let places = translations.into_iter().zip(rotations);
        let frames = ARM_FRAMES.into_iter().zip(places);
        frames.fold(
            TransformsSample::empty(stamp),
            |sample, ((parent, child), (translation, rotation))| {
                sample.with(parent, child, translation, rotation)
            },
        )
    }

    fn len(&self) -> usize {
        (self.count as usize).min(MAX_FRAMES)
    }
}

impl Message for TransformsSample {
    type Ros = TFMessage;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> TFMessage {
        let stamped = |frame: usize| TransformStamped {
            header: Header::new(self.stamp, self.parents[frame].as_str()),
            child_frame_id: self.children[frame].as_str().to_owned(),
            transform: Transform {
                translation: self.translations[frame].into(),
                rotation: self.rotations[frame].into(),
            },
        };
        TFMessage {
            transforms: (0..self.len()).map(stamped).collect(),
        }
    }

    /// Takes messages of up to [`MAX_FRAMES`] frames with one stamp.
    fn from_ros(ros: &TFMessage) -> Result<TransformsSample, InvalidMessage> {
        if ros.transforms.is_empty() || ros.transforms.len() > MAX_FRAMES {
            return Err(InvalidMessage::WrongLength {
                field: "transforms",
                found: ros.transforms.len(),
                expected: MAX_FRAMES,
            });
        }
        let mut sample = TransformsSample::empty(ros.transforms[0].header.time());
        for stamped in &ros.transforms {
            let stamp = stamped.header.time();
            if stamp != sample.stamp {
                return Err(checks::unknown(
                    "header.stamp",
                    stamp.nanos(),
                    "the stamp of the first transform",
                ));
            }
            for (field, name) in [
                ("header.frame_id", &stamped.header.frame_id),
                ("child_frame_id", &stamped.child_frame_id),
            ] {
                if name.len() > LONGEST_NAME {
                    return Err(checks::unknown(field, name, "names of up to 48 bytes"));
                }
            }
            sample = sample.with(
                &stamped.header.frame_id,
                &stamped.child_frame_id,
                (&stamped.transform.translation).into(),
                (&stamped.transform.rotation).into(),
            );
        }
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        if !(1..=MAX_FRAMES as u64).contains(&self.count) {
            return Err(checks::unknown("transforms", self.count, "1 to 10 frames"));
        }
        let (translations, rotations) = (&self.translations, &self.rotations);
        checks::finite(
            "transform.translation",
            translations[..self.len()].as_flattened(),
        )?;
        for rotation in &rotations[..self.len()] {
            checks::unit_quaternion("transform.rotation", rotation)?;
        }
        for place in 0..self.len() {
            let (parent, child) = (self.parents[place], self.children[place]);
            if parent.is_empty() || child.is_empty() || parent == child {
                let name = child.as_str();
                return Err(checks::unknown(
                    "child_frame_id",
                    name,
                    "a frame of its own in another one",
                ));
            }
        }
        Ok(())
    }
}

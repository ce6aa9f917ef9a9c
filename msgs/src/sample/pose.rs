//! A position and orientation.

use ferntast_derive::sample;

use crate::{
    InvalidMessage, Message, Time,
    ros::geometry_msgs::{Pose, PoseStamped},
};

use super::{Frame, checks};

/// Pose of the tip or of the hand. `geometry_msgs/msg/PoseStamped` on the
/// wire.
#[sample]
pub struct PoseSample {
    /// When it was measured or commanded.
    pub stamp: Time,
    /// Position x, y, z \[m\].
    pub position: [f64; 3],
    /// Orientation as unit quaternion x, y, z, w; all zeros: none is known. Of a hand one that is not
    /// turned, (0, 0, 0, 1) exactly, says as little.
    pub orientation: [f64; 4],
    /// Who sent it, as the middleware tells senders apart; 0 for senders on
    /// this host. Not on the wire of ROS 2: the gateway fills it in.
    pub source: u64,
    /// Frame that it is expressed in.
    pub frame: Frame,
}

impl PoseSample {
    /// A pose at `position` \[m\] in `frame`, not rotated, from this host.
    pub const fn at(stamp: Time, frame: Frame, position: [f64; 3]) -> PoseSample {
        PoseSample {
            stamp,
            position,
            orientation: [0.0, 0.0, 0.0, 1.0],
            source: 0,
            frame,
            reserved: [0; 7],
        }
    }
}

impl Message for PoseSample {
    type Ros = PoseStamped;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn set_source(&mut self, source: u64) {
        self.source = source;
    }

    fn to_ros(&self) -> PoseStamped {
        PoseStamped {
            header: self.frame.header(self.stamp),
            pose: Pose {
                position: self.position.into(),
                orientation: self.orientation.into(),
            },
        }
    }

    /// The source comes out as 0: whoever received the message fills it in.
    fn from_ros(ros: &PoseStamped) -> Result<PoseSample, InvalidMessage> {
        let sample = PoseSample {
            orientation: (&ros.pose.orientation).into(),
            ..PoseSample::at(
                ros.header.time(),
                Frame::of(&ros.header)?,
                (&ros.pose.position).into(),
            )
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite("pose.position", &self.position)?;
        if self.orientation != [0.0; 4] {
            checks::unit_quaternion("pose.orientation", &self.orientation)?;
        }
        self.frame.check()
    }
}

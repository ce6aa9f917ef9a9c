//! A force and torque.

use ferntast_derive::sample;

use crate::{
    InvalidMessage, Message, Time,
    ros::geometry_msgs::{Wrench, WrenchStamped},
};

use super::{Frame, checks};

/// Force and torque on the tip or the hand. `geometry_msgs/msg/WrenchStamped`
/// on the wire.
#[sample]
pub struct WrenchSample {
    /// When it was measured or commanded.
    pub stamp: Time,
    /// Force x, y, z \[N\].
    pub force: [f64; 3],
    /// Torque x, y, z \[Nm\].
    pub torque: [f64; 3],
    /// Frame that it is expressed in.
    pub frame: Frame,
}

impl WrenchSample {
    /// A force \[N\] without torque.
    pub const fn force(stamp: Time, frame: Frame, force: [f64; 3]) -> WrenchSample {
        WrenchSample {
            stamp,
            force,
            torque: [0.0; 3],
            frame,
            reserved: [0; 7],
        }
    }
}

impl Message for WrenchSample {
    type Ros = WrenchStamped;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> WrenchStamped {
        WrenchStamped {
            header: self.frame.header(self.stamp),
            wrench: Wrench {
                force: self.force.into(),
                torque: self.torque.into(),
            },
        }
    }

    fn from_ros(ros: &WrenchStamped) -> Result<WrenchSample, InvalidMessage> {
        let sample = WrenchSample {
            torque: (&ros.wrench.torque).into(),
            ..WrenchSample::force(
                ros.header.time(),
                Frame::of(&ros.header)?,
                (&ros.wrench.force).into(),
            )
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite("wrench.force", &self.force)?;
        checks::finite("wrench.torque", &self.torque)?;
        self.frame.check()
    }
}

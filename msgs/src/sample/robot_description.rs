//! What the arm looks like.

use ferntast_derive::sample;

use crate::{InvalidMessage, Message, Text, Time, ros::std_msgs};

use super::checks;

/// Most bytes of a description.
pub const LONGEST_DESCRIPTION: usize = 8192;

/// The arm as URDF. `std_msgs/msg/String` on the wire.
#[sample]
pub struct RobotDescriptionSample {
    /// The XML.
    #[field(bytes = 8192)]
    pub urdf: Text<LONGEST_DESCRIPTION>,
}

impl Message for RobotDescriptionSample {
    type Ros = std_msgs::String;

    /// None: a description holds for good.
    fn stamp(&self) -> Time {
        Time::INVALID
    }

    fn to_ros(&self) -> std_msgs::String {
        std_msgs::String {
            data: self.urdf.as_str().to_owned(),
        }
    }

    fn from_ros(ros: &std_msgs::String) -> Result<RobotDescriptionSample, InvalidMessage> {
        let sample = RobotDescriptionSample {
            urdf: Text::new(&ros.data),
        };
        if sample.urdf.as_str() != ros.data {
            return Err(InvalidMessage::WrongLength {
                field: "data",
                found: ros.data.len(),
                expected: LONGEST_DESCRIPTION,
            });
        }
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        if self.urdf.is_empty() {
            return Err(checks::unknown("data", "", "a robot description in URDF"));
        }
        Ok(())
    }
}

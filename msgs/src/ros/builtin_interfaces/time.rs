//! `builtin_interfaces/msg/Time`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

/// A point in time since the UNIX epoch.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// Seconds \[s\].
    pub sec: i32,
    /// Nanoseconds beyond the seconds \[ns\], less than 10⁹.
    pub nanosec: u32,
}

ros_message!(Time, "builtin_interfaces/msg/Time");

impl From<crate::Time> for Time {
    fn from(time: crate::Time) -> Time {
        Time {
            sec: time.ros_sec(),
            nanosec: time.ros_nanosec(),
        }
    }
}

impl From<&Time> for crate::Time {
    fn from(time: &Time) -> crate::Time {
        crate::Time::from_ros(time.sec, time.nanosec)
    }
}

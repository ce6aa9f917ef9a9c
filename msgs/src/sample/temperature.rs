//! Temperature of one joint.

use crate::{
    InvalidMessage, Message, Time,
    ros::{sensor_msgs::Temperature, std_msgs::Header},
};

use super::checks;

/// Mean of one joint's temperature sensors. `sensor_msgs/msg/Temperature` on
/// the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct TemperatureSample {
    /// When it was measured.
    pub stamp: Time,
    /// Temperature \[degC\], as the ROS 2 type has it.
    pub temperature: f64,
    /// Variance of the measurement \[degC²\]; 0 where unknown.
    pub variance: f64,
}

checks::no_padding!(TemperatureSample: Time, f64, f64);

impl TemperatureSample {
    /// A temperature \[degC\] of unknown variance.
    pub const fn new(stamp: Time, temperature: f64) -> TemperatureSample {
        TemperatureSample {
            stamp,
            temperature,
            variance: 0.0,
        }
    }
}

// SAFETY: `repr(C)` of integers, floats and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for TemperatureSample {
    type Ros = Temperature;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> Temperature {
        Temperature {
            header: Header::new(self.stamp, ""),
            temperature: self.temperature,
            variance: self.variance,
        }
    }

    /// `header.frame_id` does not count: the topic says which joint it is.
    fn from_ros(ros: &Temperature) -> Result<TemperatureSample, InvalidMessage> {
        let sample = TemperatureSample {
            stamp: ros.header.time(),
            temperature: ros.temperature,
            variance: ros.variance,
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite("temperature", &[self.temperature])?;
        checks::finite("variance", &[self.variance])
    }
}

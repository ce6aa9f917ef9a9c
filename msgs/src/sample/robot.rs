//! What passes between ferntast and a robot that others drive over ROS 2: joints as they tell
//! them, commands as their controllers take them. No topics of a session.

use ferntast_derive::sample;

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{sensor_msgs::JointState, std_msgs},
};

use super::{MAX_JOINTS, checks, lists};

/// The most joints of a robot that are taken in: two arms with hands.
pub const MAX_ROBOT_JOINTS: usize = 64;
/// Room for a joint's name \[byte\]: as much as an arm's has.
const NAME: usize = 32;

/// The state of a robot's joints, the arm's among them in any order, as the robot's own driver
/// gives it. `sensor_msgs/msg/JointState` on the wire.
///
/// Nothing is judged here beyond what is needed to read it, so that who uses it can say which
/// joint is wrong: a quantity that is not given, and one that is given as NaN, is NaN.
#[sample]
pub struct RobotJointsSample {
    /// When it was measured, by the robot's clock.
    pub stamp: Time,
    /// The joints; a name that is too long to be one of an arm's joints is left empty.
    #[field(bytes = 2048)]
    pub names: [Text<NAME>; MAX_ROBOT_JOINTS],
    /// Positions \[rad\] or \[m\].
    pub position: [f64; MAX_ROBOT_JOINTS],
    /// Velocities \[rad/s\] or \[m/s\].
    pub velocity: [f64; MAX_ROBOT_JOINTS],
    /// Torques or forces \[Nm\] or \[N\].
    pub effort: [f64; MAX_ROBOT_JOINTS],
    /// How many joints there are.
    pub joints: u32,
}

impl RobotJointsSample {
    /// The place of the joint of that name.
    pub fn index(&self, name: &str) -> Option<usize> {
        let names = self.names.iter().take(self.joints as usize);
        let mut names = names.map(Text::as_str);
        names.position(|own| own == name)
    }

    /// The joints' names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names
            .iter()
            .take(self.joints as usize)
            .map(Text::as_str)
    }
}

impl Message for RobotJointsSample {
    type Ros = JointState;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> JointState {
        let count = (self.joints as usize).min(MAX_ROBOT_JOINTS);
        JointState {
            header: std_msgs::Header::new(self.stamp, ""),
            name: self.names().map(String::from).collect(),
            position: self.position[..count].to_vec(),
            velocity: self.velocity[..count].to_vec(),
            effort: self.effort[..count].to_vec(),
        }
    }

    fn from_ros(ros: &JointState) -> Result<RobotJointsSample, InvalidMessage> {
        lists::fits("name", ros.name.len(), MAX_ROBOT_JOINTS)?;
        let count = ros.name.len();
        let mut names = [Text::EMPTY; MAX_ROBOT_JOINTS];
        for (place, name) in names.iter_mut().zip(&ros.name) {
            let own = Text::new(name);
            if own.as_str() == name {
                *place = own;
            }
        }
        let read = |field, values: &[f64]| {
            let mut places = [f64::NAN; MAX_ROBOT_JOINTS];
            if !values.is_empty() {
                lists::fill(field, &mut places, count as u32, values, |own| *own)?;
            }
            Ok(places)
        };
        let sample = RobotJointsSample {
            stamp: ros.header.time(),
            names,
            position: read("position", &ros.position)?,
            velocity: read("velocity", &ros.velocity)?,
            effort: read("effort", &ros.effort)?,
            joints: count as u32,
            reserved: [0; 4],
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        lists::fits("name", self.joints as usize, MAX_ROBOT_JOINTS)
    }
}

/// A command to a controller, one number of each of its joints.
/// `std_msgs/msg/Float64MultiArray` on the wire, as ros2_control's forward command
/// controllers take it.
#[sample]
pub struct ControllerCommandSample {
    /// The numbers, in the controller's order.
    pub values: [f64; MAX_JOINTS],
    /// How many there are.
    pub count: u32,
}

impl ControllerCommandSample {
    /// Those numbers, as many of them as there is room for.
    pub fn new(values: &[f64]) -> ControllerCommandSample {
        let mut places = [0.0; MAX_JOINTS];
        for (place, value) in places.iter_mut().zip(values) {
            *place = *value;
        }
        ControllerCommandSample {
            values: places,
            count: values.len().min(MAX_JOINTS) as u32,
            reserved: [0; 4],
        }
    }

    /// The numbers.
    pub fn values(&self) -> &[f64] {
        &self.values[..(self.count as usize).min(MAX_JOINTS)]
    }
}

impl Message for ControllerCommandSample {
    type Ros = std_msgs::Float64MultiArray;

    /// None: it counts when it comes.
    fn stamp(&self) -> Time {
        Time::INVALID
    }

    fn to_ros(&self) -> std_msgs::Float64MultiArray {
        std_msgs::Float64MultiArray {
            data: self.values().to_vec(),
            ..std_msgs::Float64MultiArray::default()
        }
    }

    fn from_ros(ros: &std_msgs::Float64MultiArray) -> Result<Self, InvalidMessage> {
        lists::fits("data", ros.data.len(), MAX_JOINTS)?;
        let sample = ControllerCommandSample::new(&ros.data);
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        lists::fits("data", self.count as usize, MAX_JOINTS)?;
        checks::finite("data", self.values())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(names: &[&str], position: &[f64]) -> JointState {
        JointState {
            header: std_msgs::Header::new(Time::from_nanos(1_700_000_000_000_000_000), "base"),
            name: names.iter().map(|&name| name.to_owned()).collect(),
            position: position.to_vec(),
            ..JointState::default()
        }
    }

    #[test]
    fn joints_of_a_whole_robot_come_in_whatever_is_wrong_with_a_number() {
        let long = "a_joint_whose_name_is_longer_than_any_of_an_arm";
        let ros = state(&["finger", long, "elbow"], &[0.1, 0.2, f64::NAN]);
        let sample = RobotJointsSample::from_ros(&ros).unwrap();
        assert_eq!(sample.index("elbow"), Some(2));
        assert_eq!(sample.index(&long[..32]), None);
        assert_eq!(sample.position[0], 0.1);
        assert!(sample.position[2].is_nan() && sample.velocity[0].is_nan());
    }

    #[test]
    fn a_list_of_another_length_is_refused() {
        let words = RobotJointsSample::from_ros(&state(&["a", "b"], &[1.0])).unwrap_err();
        let expected = "position has 1 entries where 2 are needed";
        assert_eq!(words.to_string(), expected);
        let many = vec!["a"; 65];
        assert!(RobotJointsSample::from_ros(&state(&many, &[])).is_err());
        let mut unstamped = state(&["a"], &[1.0]);
        unstamped.header = std_msgs::Header::default();
        let words = RobotJointsSample::from_ros(&unstamped).unwrap_err();
        assert_eq!(words, InvalidMessage::ZeroStamp);
    }

    #[test]
    fn a_command_is_a_plain_list() {
        let command = ControllerCommandSample::new(&[1.0, -2.5]);
        let ros = command.to_ros();
        assert_eq!(ros.data, [1.0, -2.5]);
        assert!(ros.layout.dim.is_empty());
        assert_eq!(ControllerCommandSample::from_ros(&ros), Ok(command));
        assert!(ControllerCommandSample::new(&[f64::NAN]).check().is_err());
    }
}

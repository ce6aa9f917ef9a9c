//! What can be set about an arm on ROS 2.

use ferntast_model::{ParameterError, parameters};
use ferntast_msgs::{
    sample::JointNames,
    topics::{TopicName, TopicNameError},
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// What a controller's commands are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interface {
    /// Torques \[Nm\].
    Effort,
    /// Velocities \[rad/s\].
    Velocity,
    /// Positions \[rad\].
    Position,
}

impl Interface {
    /// Its name in files and names of controllers.
    pub const fn name(self) -> &'static str {
        match self {
            Interface::Effort => "effort",
            Interface::Velocity => "velocity",
            Interface::Position => "position",
        }
    }
}

/// What the effort of the joint states is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// What torque sensors behind the gears measure, the links' weight in it.
    JointTorque,
    /// The motors' torques, from their currents.
    MotorTorque,
    /// Nothing that could be used.
    None,
}

parameters! {
    /// The section `[driver.ros2]` of an arm's file. Every key may be left out.
    pub struct Settings {
        /// Topic on which the robot tells its joints.
        pub joint_states: String = "/joint_states".to_owned(),
        /// What the controller's commands are. Torques go by ROS 2 and back in some milliseconds, which
        /// the servo's usual gains do not bear: velocities are what is asked for otherwise.
        pub interface: Interface = Interface::Velocity,
        /// Topic of the controller's commands; `/forward_velocity_controller/commands` and its like
        /// where it is not given.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub command: Option<String> = None,
        /// The controller's joints in its order; the arm's in theirs where it is not given.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub joints: Option<Vec<String>> = None,
        /// What the joint states' effort is; where it is not given what the arm's file says
        /// that the arm has: joint torques, or motor torques only.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub effort: Option<Effort> = None,
        /// The robot carries its own weight, and takes effort commands beyond that (Franka).
        pub carries_itself: bool = false,
        /// Joint states have to come at least so often \[Hz\].
        pub least_rate: f64 [10.0..=1e4, "Hz"] = 100.0,
        /// Joint states that are silent for so long are a fault \[s\].
        pub longest_silence: f64 [0.002..=0.5, "s"] = 0.02,
        /// A joint state that comes so much later than the quickest is not used \[s\].
        pub longest_delay: f64 [0.001..=0.5, "s"] = 0.02,
        /// A joint further beyond its limits is not believed \[rad\] or \[m\].
        pub limit_margin: f64 [0.0..=1.0, "rad"] = 0.05,
        /// A position command is so far from where the joint is at most \[rad\] or \[m\]: times the
        /// stiffness of the robot's own controller that is what it presses with.
        pub lead: f64 [1e-4..=0.5, "rad"] = 0.05,
    }
}

/// Why an arm cannot be driven over ROS 2.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// A key or a type that is wrong.
    #[error("[driver.ros2] of the arm's file, or --driver ros2:…: {0}")]
    Section(serde_json::Error),
    /// A value out of bounds.
    #[error("[driver.ros2]: {0}")]
    Value(#[from] ParameterError),
    /// What stands behind `ros2:` is no list of settings.
    #[error(
        "--driver ros2:{0}: write settings as key=value, such as ros2:interface=velocity,joint_states=/ur/joint_states"
    )]
    Text(String),
    /// A topic that is none.
    #[error("[driver.ros2] {key} = {name:?}: {reason}; write it as ros2 topic list does")]
    Topic {
        /// The key.
        key: &'static str,
        /// What it says.
        name: String,
        /// Why it is none.
        reason: TopicNameError,
    },
    /// The controller's joints are not those of the arm.
    #[error(
        "[driver.ros2] joints: the controller's are {found}, the arm's {wanted}; each of these has to stand there once"
    )]
    Joints {
        /// The controller's.
        found: String,
        /// The arm's.
        wanted: String,
    },
}

impl Settings {
    /// Those of the arm's file, with what stands behind `ros2:` in their place.
    ///
    /// # Errors
    ///
    /// [`SettingsError`], of both.
    pub fn read(section: Option<&Value>, text: &str) -> Result<Settings, SettingsError> {
        let mut all = match section {
            Some(Value::Object(own)) => own.clone(),
            Some(other) => {
                let error = serde_json::from_value::<Settings>(other.clone());
                return error.map_err(SettingsError::Section);
            }
            None => Map::new(),
        };
        for setting in text.split(',').filter(|own| !own.trim().is_empty()) {
            let Some((key, value)) = setting.split_once('=') else {
                return Err(SettingsError::Text(text.to_owned()));
            };
            let value = value.trim();
            // Numbers and truth values are written as they are, all else is text.
            let value = serde_json::from_str(value).unwrap_or_else(|_| Value::from(value));
            all.insert(key.trim().to_owned(), value);
        }
        let settings: Settings =
            serde_json::from_value(Value::Object(all)).map_err(SettingsError::Section)?;
        settings.validate()?;
        settings.joint_states_topic()?;
        settings.command_topic()?;
        Ok(settings)
    }

    /// See [`Settings::joint_states`].
    ///
    /// # Errors
    ///
    /// It is no topic.
    pub fn joint_states_topic(&self) -> Result<TopicName, SettingsError> {
        topic("joint_states", &self.joint_states)
    }

    /// See [`Settings::command`].
    ///
    /// # Errors
    ///
    /// It is no topic.
    pub fn command_topic(&self) -> Result<TopicName, SettingsError> {
        match &self.command {
            Some(name) => topic("command", name),
            None => {
                let name = format!("/forward_{}_controller/commands", self.interface.name());
                topic("command", &name)
            }
        }
    }

    /// For each place of the controller's list the number of the arm's joint.
    ///
    /// # Errors
    ///
    /// The controller's joints are not those of the arm.
    pub fn order(&self, arm: &JointNames) -> Result<Vec<usize>, SettingsError> {
        let Some(own) = &self.joints else {
            return Ok((0..arm.len()).collect());
        };
        let places: Vec<usize> = own.iter().filter_map(|name| arm.index(name)).collect();
        let each_once = (0..arm.len()).all(|joint| places.contains(&joint));
        match each_once && own.len() == arm.len() {
            true => Ok(places),
            false => Err(SettingsError::Joints {
                found: own.join(", "),
                wanted: arm.to_string(),
            }),
        }
    }
}

fn topic(key: &'static str, name: &str) -> Result<TopicName, SettingsError> {
    TopicName::new(name).map_err(|reason| SettingsError::Topic {
        key,
        name: name.to_owned(),
        reason,
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_command_line_goes_before_the_file() {
        let file = json!({"interface": "velocity", "least_rate": 50.0});
        let settings = Settings::read(Some(&file), "least_rate=125, command=/ur/commands").unwrap();
        assert_eq!(settings.interface, Interface::Velocity);
        assert_eq!(settings.least_rate, 125.0);
        assert_eq!(settings.command_topic().unwrap().as_str(), "/ur/commands");
        let settings = Settings::read(Some(&file), "").unwrap();
        let topic = settings.command_topic().unwrap();
        assert_eq!(topic.as_str(), "/forward_velocity_controller/commands");
        assert_eq!(Settings::read(None, "").unwrap(), Settings::default());
    }

    #[test]
    fn what_is_wrong_is_told_with_its_key() {
        for (text, words) in [
            ("colour=red", "unknown field `colour`"),
            ("interface=torque", "unknown variant `torque`"),
            ("least_rate=1", "least_rate = 1 Hz is outside"),
            ("fast", "write settings as key=value"),
            (
                "joint_states=js",
                "joint_states = \"js\": the name does not begin with /",
            ),
        ] {
            let told = Settings::read(None, text).unwrap_err().to_string();
            assert!(told.contains(words), "{told}");
        }
        let told = Settings::read(Some(&json!(3)), "").unwrap_err().to_string();
        assert!(told.contains("[driver.ros2]"), "{told}");
    }

    #[test]
    fn a_controller_may_have_its_joints_in_another_order() {
        let arm = JointNames::new(["a", "b", "c"]).unwrap();
        let of = |names: &[&str]| Settings {
            joints: Some(names.iter().map(|&name| name.to_owned()).collect()),
            ..Settings::default()
        };
        assert_eq!(Settings::default().order(&arm).unwrap(), [0, 1, 2]);
        assert_eq!(of(&["c", "a", "b"]).order(&arm).unwrap(), [2, 0, 1]);
        for wrong in [
            &["a", "b"][..],
            &["a", "b", "b"],
            &["a", "b", "x"],
            &["a", "b", "c", "c"],
        ] {
            let told = of(wrong).order(&arm).unwrap_err().to_string();
            assert!(told.contains("the arm's a, b, c"), "{told}");
        }
    }
}

//! Which driver there is between the arm's node and an arm.

use std::str::FromStr;

use ferntast_nodes::process::{NodeError, SessionContext};

use crate::{
    driver::Driver,
    dynamixel::{self, Dynamixel},
    feetech::{self, Feetech},
    motors::MotorArm,
    process, ros2, simulated,
};

/// Which driver, as it is written after `--driver`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// `simulated`: the arm's file says what is true of it.
    Simulated,
    /// `dynamixel`: motors on a serial bus, as the arm's file lists them.
    Dynamixel,
    /// `feetech`: the same of another maker.
    Feetech,
    /// `process:COMMAND`: a plant in a program of its own.
    Process(String),
    /// `ros2`, `ros2:SETTINGS`: a robot that others drive over ROS 2.
    Ros2(String),
}

/// A driver that there is not.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no driver {0:?}; there are: simulated, dynamixel, feetech, process:COMMAND, ros2[:KEY=VALUE,…]"
)]
pub struct UnknownDriver(String);

/// Hardware where time is that of our steps.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "--driver {}: it drives an arm in real time, which virtual time cannot wait for: use `ferntast session`",
    .0.as_deref().unwrap_or_default()
)]
struct InVirtualTime(Option<String>);

impl FromStr for Choice {
    type Err = UnknownDriver;

    fn from_str(text: &str) -> Result<Choice, UnknownDriver> {
        match text.split_once(':') {
            None if text == "simulated" => Ok(Choice::Simulated),
            None if text == dynamixel::NAME => Ok(Choice::Dynamixel),
            None if text == feetech::NAME => Ok(Choice::Feetech),
            None if text == "ros2" => Ok(Choice::Ros2(String::new())),
            Some(("ros2", settings)) => Ok(Choice::Ros2(settings.to_owned())),
            Some(("process", command)) if !command.trim().is_empty() => {
                Ok(Choice::Process(command.trim().to_owned()))
            }
            _ => Err(UnknownDriver(text.to_owned())),
        }
    }
}

impl Choice {
    /// That of a session.
    ///
    /// # Errors
    ///
    /// There is no such driver.
    pub fn of(session: &SessionContext) -> Result<Choice, NodeError> {
        match &session.driver {
            None => Ok(Choice::Simulated),
            Some(text) => text.parse().map_err(NodeError::own),
        }
    }

    /// The driver of the session's arm.
    ///
    /// # Errors
    ///
    /// What keeps it from being made: settings, a program or device that is not there.
    pub fn driver(
        &self,
        session: &SessionContext,
        virtual_time: bool,
    ) -> Result<Box<dyn Driver>, NodeError> {
        if virtual_time && !self.is_stepped() {
            return Err(NodeError::own(InVirtualTime(session.driver.clone())));
        }
        match self {
            Choice::Simulated => simulated::driver(session),
            Choice::Dynamixel => MotorArm::driver(session, dynamixel::NAME, Dynamixel::open),
            Choice::Feetech => MotorArm::driver(session, feetech::NAME, Feetech::open),
            Choice::Process(command) => process::driver(session, command),
            Choice::Ros2(settings) => ros2::driver(session, settings),
        }
    }

    /// Whether the arm's time is that of our steps: no hardware moves.
    pub fn is_stepped(&self) -> bool {
        matches!(self, Choice::Simulated | Choice::Process(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_is_named_by_its_kind_and_what_it_needs() {
        assert_eq!("simulated".parse(), Ok(Choice::Simulated));
        assert_eq!("dynamixel".parse(), Ok(Choice::Dynamixel));
        assert_eq!("feetech".parse(), Ok(Choice::Feetech));
        let command = "python3 plant.py --wall 'a:b'";
        let choice = format!("process: {command}").parse();
        assert_eq!(choice, Ok(Choice::Process(command.into())));
        assert_eq!("ros2".parse(), Ok(Choice::Ros2(String::new())));
        let settings = "interface=velocity".to_owned();
        assert_eq!(
            "ros2:interface=velocity".parse(),
            Ok(Choice::Ros2(settings))
        );
        for wrong in [
            "",
            "process",
            "process:",
            "simulated:x",
            "hardware",
            "Simulated",
        ] {
            let error = wrong.parse::<Choice>().unwrap_err().to_string();
            assert!(
                error.contains("there are: simulated, dynamixel, feetech, process:COMMAND, ros2"),
                "{error}"
            );
        }
    }
}

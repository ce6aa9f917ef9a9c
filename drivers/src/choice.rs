//! Which driver there is between the arm's node and an arm.

use std::str::FromStr;

use ferntast_nodes::{
    graph::{Build, NodeRow},
    node::Ticking,
    process::{NodeError, Priority},
};

use crate::{dynamixel, feetech, node::ArmPorts, process, simulated};

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
}

/// A driver that there is not.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no driver {0:?}; there are: simulated, dynamixel, feetech, process:COMMAND")]
pub struct UnknownDriver(String);

impl FromStr for Choice {
    type Err = UnknownDriver;

    fn from_str(text: &str) -> Result<Choice, UnknownDriver> {
        match text.split_once(':') {
            None if text == "simulated" => Ok(Choice::Simulated),
            None if text == dynamixel::NAME => Ok(Choice::Dynamixel),
            None if text == feetech::NAME => Ok(Choice::Feetech),
            Some(("process", command)) if !command.trim().is_empty() => {
                Ok(Choice::Process(command.trim().to_owned()))
            }
            _ => Err(UnknownDriver(text.to_owned())),
        }
    }
}

/// The row of the arm in the graph, whatever its driver.
pub const fn row() -> NodeRow {
    NodeRow::step::<ArmPorts>(
        "arm",
        "The simulated arm; hardware takes its place by speaking the same topics",
        Priority::Arm,
        make,
    )
}

fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let choice = match &build.session.driver {
        None => Choice::Simulated,
        Some(text) => text.parse().map_err(NodeError::own)?,
    };
    match choice {
        Choice::Simulated => simulated::make(build),
        Choice::Dynamixel => dynamixel::make(build),
        Choice::Feetech => feetech::make(build),
        Choice::Process(command) => process::make(build, &command),
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
                error.ends_with("there are: simulated, dynamixel, feetech, process:COMMAND"),
                "{error}"
            );
        }
    }
}

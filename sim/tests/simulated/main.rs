//! The simulated arms, the laws on them, and trials of teleoperation. One program: a second one
//! would compile once more what reads an arm's file.

mod arm;
mod chain;
mod common;
mod delay_laws;
mod driver;
mod estimator;
mod long;
mod motor_current;
mod passivity;
mod random_cases;
mod sensor_errors;
mod serial_arm;
mod serial_whole;
mod servo;
#[path = "../../../tests/shared/thorough.rs"]
mod thorough;

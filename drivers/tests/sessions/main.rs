//! Whole sessions in virtual time. One program: a second one would compile once more what reads an
//! arm's file.

mod clutch;
mod common;
mod motor_current;
mod process;
mod twin;

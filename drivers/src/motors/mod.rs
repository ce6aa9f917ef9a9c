//! What drivers of motors on a serial bus share: the section of the arm's file, the port, the
//! exchange of packets, a thread that talks to the motors, and the [`Driver`](crate::Driver)
//! in front of it. A family of motors brings its packets ([`protocol::Protocol`]) and what it
//! does with its registers ([`family::Family`]).
//!
//! All motors are driven by positions a little ahead of where they are, with a limited current:
//! they press by as much as they are told to, and one that is told nothing any more goes that
//! little way at most and stands.

pub mod bus;
pub mod error;
pub mod family;
pub mod line;
pub mod port;
pub mod protocol;
pub mod section;
mod shared;
mod talk;

mod arm;

pub use arm::MotorArm;
pub use error::{MotorError, MotorName};

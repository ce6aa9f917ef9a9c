//! What can be wrong with motors on a bus.

use std::{fmt, io, time::Duration};

/// Which motor, for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MotorName {
    /// Its number on the bus.
    pub id: u8,
    /// The joint that it turns.
    pub joint: String,
    /// The port that it is on.
    pub port: String,
}

impl fmt::Display for MotorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "motor {} ({}) on {}", self.id, self.joint, self.port)
    }
}

/// Why motors cannot be used, or no longer.
#[derive(Debug, thiserror::Error)]
pub enum MotorError {
    /// The arm's file does not say which motors there are.
    #[error(
        "the arm's file has no section [driver.{0}]; write one with the port and a \
         [[driver.{0}.motor]] for each joint (docs/motors.md)"
    )]
    NoSection(&'static str),
    /// The section cannot be used.
    #[error("[driver.{driver}]: {message} (docs/motors.md)")]
    Section {
        /// Which driver's.
        driver: &'static str,
        /// What is wrong.
        message: String,
    },
    /// The port cannot be opened.
    #[error("{port} cannot be opened: {source}{}", hint(.source))]
    Open {
        /// Which.
        port: String,
        /// Why.
        source: io::Error,
    },
    /// Another program has the port.
    #[error("{0} is in use by another program; end that program, or name another port")]
    Taken(String),
    /// The port does not go so fast.
    #[error("{port} cannot be set to {baud} baud: {source}; see the motors' baud rates")]
    Baud {
        /// Which.
        port: String,
        /// How fast.
        baud: u32,
        /// Why.
        source: io::Error,
    },
    /// The port is gone.
    #[error("{port} has gone away ({source}); is the adapter plugged in?")]
    Gone {
        /// Which.
        port: String,
        /// How that is known.
        source: io::Error,
    },
    /// Not one motor answers.
    #[error(
        "no motor answers on {port} at {baud} baud (asked for {ids}); switch on their power, \
         check the cable and the baud rate"
    )]
    NoMotors {
        /// Where.
        port: String,
        /// How fast.
        baud: u32,
        /// Who was asked for.
        ids: String,
    },
    /// A motor does not answer though others do.
    #[error("{0} does not answer, others do; check its cable and its id")]
    Missing(MotorName),
    /// It is another motor than the file says.
    #[error("{motor} is {found}, the arm's file says {wanted}; correct one of them")]
    Model {
        /// Which.
        motor: MotorName,
        /// What it says of itself.
        found: String,
        /// What the file says.
        wanted: String,
    },
    /// It is set so that it cannot be used.
    #[error("{motor}: {message}")]
    Setting {
        /// Which.
        motor: MotorName,
        /// What is wrong, and how to mend it.
        message: String,
    },
    /// It reports that something is wrong with it.
    #[error("{motor}: {what}; the arm is held. Mend that, and switch its power off and on")]
    Hardware {
        /// Which.
        motor: MotorName,
        /// What.
        what: String,
    },
    /// It did not do what it was told.
    #[error("{motor} refuses register {address}: {reason}")]
    Refused {
        /// Which.
        motor: MotorName,
        /// What it was about.
        address: u16,
        /// Why.
        reason: &'static str,
    },
    /// It answers no longer, or no longer what can be read.
    #[error(
        "{motor} has given no answer that can be read for {milliseconds} ms ({damaged} damaged); \
         check power and cable"
    )]
    Silent {
        /// Which.
        motor: MotorName,
        /// For how long.
        milliseconds: u128,
        /// How many answers had a wrong checksum, since the start.
        damaged: u32,
    },
    /// None of them answers any longer.
    #[error("no motor on {port} has answered for {milliseconds} ms; was their power switched off?")]
    AllSilent {
        /// Where.
        port: String,
        /// For how long.
        milliseconds: u128,
    },
    /// There can be no thread.
    #[error("no thread can be started for {port}: {source}")]
    Thread {
        /// For which port.
        port: String,
        /// Why.
        source: io::Error,
    },
}

fn hint(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::NotFound => "; is the adapter plugged in? ls /dev/serial/by-id names it",
        io::ErrorKind::PermissionDenied => {
            "; allow it: sudo usermod -aG dialout $USER, then log in again"
        }
        _ => "",
    }
}

/// Why an exchange gave nothing.
#[derive(Debug)]
pub enum Lost {
    /// No answer within the time.
    Silent,
    /// An answer whose checksum is wrong.
    Damaged,
    /// An answer of another motor, or of another length.
    Foreign,
    /// The port does not work.
    Port(io::Error),
}

impl MotorError {
    /// What a motor that was lost for that long is told as.
    pub(crate) fn silent(motor: &MotorName, time: Duration, damaged: u32) -> MotorError {
        MotorError::Silent {
            motor: motor.clone(),
            milliseconds: time.as_millis(),
            damaged,
        }
    }
}

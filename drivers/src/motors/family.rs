//! What a family of motors does on its bus.

use ferntast_model::MAX_JOINTS;

use super::error::{Lost, MotorError};

/// What the motors are to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Nothing: their shafts can be turned by hand.
    Off,
    /// Stand where they are.
    Hold,
    /// Give these currents \[A\], in the motor's own sense of turning.
    Currents([f64; MAX_JOINTS]),
}

/// What a motor says, in its own sense of turning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorState {
    /// Position \[count\].
    pub position: f64,
    /// Velocity of the shaft \[rad/s\].
    pub velocity: f64,
    /// Current \[A\].
    pub current: f64,
    /// Temperature \[degC\].
    pub temperature: f64,
    /// Voltage of the supply \[V\].
    pub voltage: f64,
}

/// All motors' states, in the order of the joints.
pub type States = [MotorState; MAX_JOINTS];

/// Why a cycle gave nothing new.
#[derive(Debug)]
pub enum Missed {
    /// The motor at that place of the section was not heard.
    Motor(usize, Lost),
    /// It cannot go on.
    Error(MotorError),
}

impl From<MotorError> for Missed {
    fn from(error: MotorError) -> Missed {
        Missed::Error(error)
    }
}

/// Motors of one maker on a bus.
pub trait Family: Send + 'static {
    /// Whether they give a current that they are commanded, and so a torque.
    const GIVES_TORQUE: bool;

    /// Looks for all motors, checks that they are what they should be, and makes them ready.
    /// Their drives stay off.
    ///
    /// # Errors
    ///
    /// What is wrong.
    fn start(&mut self) -> Result<States, MotorError>;

    /// Tells the motors what to do and asks for their states.
    ///
    /// # Errors
    ///
    /// Who was not heard; what else is wrong. `states` is then as it was, or in part new.
    fn step(&mut self, drive: &Drive, states: &mut States) -> Result<(), Missed>;

    /// Switches the drives off, as far as the motors hear it.
    fn release(&mut self);

    /// The places of those that do not answer.
    fn silent(&mut self) -> Vec<usize>;

    /// How many answers had a wrong checksum since the start.
    fn damaged(&self) -> u32;
}

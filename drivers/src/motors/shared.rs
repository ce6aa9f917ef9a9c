//! What the arm's node and the thread on the bus have of each other.

use std::sync::{
    OnceLock,
    atomic::{AtomicBool, AtomicU32},
};

use ferntast_model::MAX_JOINTS;

use super::{
    error::MotorError,
    family::{Drive, MotorState, States},
};
use crate::newest::Newest;

/// Numbers of a motor's state.
const FIELDS: usize = 5;

/// Between the two.
pub struct Shared {
    states: Newest<{ FIELDS * MAX_JOINTS }>,
    /// What to do (0 off, 1 hold, 2 currents), and the currents.
    drive: Newest<{ 1 + MAX_JOINTS }>,
    /// Cycles of the bus that gave nothing, since the start.
    pub missed: AtomicU32,
    /// Why it is over.
    pub failure: OnceLock<MotorError>,
    /// The node ends.
    pub ends: AtomicBool,
}

impl Shared {
    pub fn new() -> Shared {
        Shared {
            states: Newest::new(),
            drive: Newest::new(),
            missed: AtomicU32::new(0),
            failure: OnceLock::new(),
            ends: AtomicBool::new(false),
        }
    }

    pub fn put_states(&self, states: &States) {
        let mut values = [0.0; FIELDS * MAX_JOINTS];
        for (place, state) in values.as_chunks_mut::<FIELDS>().0.iter_mut().zip(states) {
            *place = [
                state.position,
                state.velocity,
                state.current,
                state.temperature,
                state.voltage,
            ];
        }
        self.states.write(&values);
    }

    pub fn states(&self) -> Option<(u64, States)> {
        let (version, values) = self.states.read()?;
        let mut states = States::default();
        for (state, values) in states.iter_mut().zip(values.as_chunks::<FIELDS>().0) {
            let [position, velocity, current, temperature, voltage] = *values;
            *state = MotorState {
                position,
                velocity,
                current,
                temperature,
                voltage,
            };
        }
        Some((version, states))
    }

    pub fn put_drive(&self, drive: &Drive) {
        let mut values = [0.0; 1 + MAX_JOINTS];
        match drive {
            Drive::Off => {}
            Drive::Hold => values[0] = 1.0,
            Drive::Currents(currents) => {
                values[0] = 2.0;
                values[1..].copy_from_slice(currents);
            }
        }
        self.drive.write(&values);
    }

    pub fn drive(&self) -> Option<(u64, Drive)> {
        let (version, [what, currents @ ..]) = self.drive.read()?;
        let drive = match what {
            2.0 => Drive::Currents(currents),
            1.0 => Drive::Hold,
            _ => Drive::Off,
        };
        Some((version, drive))
    }
}

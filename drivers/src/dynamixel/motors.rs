//! What is done with Dynamixel motors.
//!
//! In the current-based position mode a motor goes to a position with no more current than its
//! goal current. A current is given as a goal so far ahead that the motor's own gain asks for
//! more than that: the goal current is then what flows. A motor that hears nothing any more
//! gets no further than that goal, and its bus watchdog stops it before.

use super::{
    models::{self, Model},
    packet::Protocol2,
    registers::*,
};
use crate::motors::{
    error::{Lost, MotorError},
    family::{Drive, Family, Missed, States},
    line::Line,
    protocol::Protocol,
    section::Section,
};

/// How much further ahead the goal is than just far enough: the motor moves on between two
/// cycles \[-\].
const AHEAD: f64 = 1.5;
/// The farthest that it may be ahead \[count\]: an eighth of a turn.
const FARTHEST: f64 = 512.0;
/// Cycles between two looks at something that changes slowly.
const SLOWLY: u32 = 32;

/// Dynamixel motors on a bus.
pub struct Dynamixel {
    line: Line<Protocol2>,
    models: Vec<Model>,
    /// How far ahead the goals are \[count\].
    ahead: Vec<f64>,
    /// Whether they know the fast sync read.
    fast: bool,
    on: bool,
    /// Where they are held \[count\].
    held: Option<States>,
    cycles: u32,
}

impl Dynamixel {
    /// Opens the port of `section`.
    ///
    /// # Errors
    ///
    /// A model that is not known, a port that is not to be had.
    pub fn open(section: &Section) -> Result<Dynamixel, MotorError> {
        let motors = section.motor.iter().enumerate();
        let models = motors.map(|(place, motor)| {
            models::by_name(&motor.model).ok_or_else(|| {
                let known: Vec<&str> = models::MODELS.iter().map(|model| model.name).collect();
                let (own, known) = (&motor.model, known.join(", "));
                section.setting(
                    place,
                    format!("model \"{own}\" cannot limit its current, or is not known; known are {known}"),
                )
            })
        });
        Ok(Dynamixel {
            models: models.collect::<Result<_, _>>()?,
            line: Line::open(section)?,
            ahead: vec![0.0; section.motor.len()],
            fast: true,
            on: false,
            held: None,
            cycles: 0,
        })
    }

    fn prepare(&mut self, place: usize) -> Result<(), MotorError> {
        let line = &mut self.line;
        let [error] = line.get(place, HARDWARE_ERROR)?;
        if error != 0 {
            return Err(line.hardware(place, hardware_error(error)));
        }
        // These outlast the power: they are written where they are not so yet, which a drive
        // that is on refuses. A motor that holds an arm since the program died goes on with it.
        for (address, wanted) in [
            (OPERATING_MODE, CURRENT_BASED_POSITION),
            (RETURN_DELAY, 0),
            (STATUS_RETURN_LEVEL, 2),
        ] {
            if line.get::<1>(place, address)? != [wanted] {
                line.set(place, TORQUE_ENABLE, &[0])?;
                line.set(place, address, &[wanted])?;
            }
        }
        let unit = self.models[place].current_unit;
        let wanted = line.section.motor[place].current_limit;
        let most = f64::from(u16::from_le_bytes(line.get(place, CURRENT_LIMIT)?)) * unit;
        if wanted > most + 0.5 * unit {
            return Err(line.setting(
                place,
                format!("current_limit = {wanted} A is more than is set in it, {most:.3} A"),
            ));
        }
        let gain = f64::from(u16::from_le_bytes(line.get(place, POSITION_P_GAIN)?)) / 128.0;
        let far_enough = AHEAD * wanted / unit;
        let ahead = (far_enough / gain).ceil();
        // Infinite where there is no gain.
        if ahead > FARTHEST {
            let least = (128.0 * far_enough / FARTHEST).ceil();
            return Err(line.setting(
                place,
                format!("its position P gain is too low for {wanted} A; set it to {least} or more"),
            ));
        }
        self.ahead[place] = ahead;
        // A current that goes with nothing but how far the goal is ahead.
        line.set(place, POSITION_D_AND_I_GAIN, &[0; 4])?;
        line.set(place, FEED_FORWARD_GAINS, &[0; 4])?;
        line.set(place, PROFILE, &[0; 8])?;
        // Once the watchdog is cleared the last goal counts again: it is where the motor is.
        line.set(place, BUS_WATCHDOG, &[0])?;
        let position: [u8; 4] = line.get(place, PRESENT_POSITION)?;
        line.set(place, GOAL_POSITION, &position)
    }

    /// Gives each motor a position \[count\] and a current \[A\] to go there with.
    fn set_goals(&mut self, goals: impl Fn(usize) -> (f64, f64)) -> Result<(), Missed> {
        let models = &self.models;
        // Never more than the file says, whatever the rounding.
        let current = |place: usize| {
            let counts = goals(place).1.abs() / models[place].current_unit;
            (counts.floor() as i16).to_le_bytes()
        };
        self.line.set_each(GOAL_CURRENT, current)?;
        let position = |place: usize| (goals(place).0.round() as i32).to_le_bytes();
        self.line.set_each(GOAL_POSITION, position)
    }

    fn tell(&mut self, drive: &Drive, states: &States) -> Result<(), Missed> {
        if (*drive != Drive::Off) != self.on {
            self.switch(!self.on, states)?;
        }
        match drive {
            Drive::Off => Ok(()),
            Drive::Currents(currents) => {
                self.held = None;
                let ahead = std::mem::take(&mut self.ahead);
                let told = self.set_goals(|place| {
                    let current = currents[place];
                    let goal = states[place].position + ahead[place].copysign(current);
                    (goal, current)
                });
                self.ahead = ahead;
                told
            }
            Drive::Hold => {
                let held = *self.held.get_or_insert(*states);
                let motors = self.line.section.motor.iter();
                let limits: Vec<f64> = motors.map(|motor| motor.current_limit).collect();
                self.set_goals(|place| (held[place].position, limits[place]))
            }
        }
    }

    fn switch(&mut self, on: bool, states: &States) -> Result<(), Missed> {
        self.held = None;
        if on {
            self.set_goals(|place| (states[place].position, 0.0))?;
            self.watch()?;
        } else {
            self.line.set_surely(BUS_WATCHDOG, &[0])?;
        }
        // A joint whose motor did not hear this would be limp, and tell its place all the same.
        self.line.set_surely(TORQUE_ENABLE, &[u8::from(on)])?;
        self.on = on;
        Ok(())
    }

    /// Has the motors stop by themselves once the bus is silent.
    fn watch(&mut self) -> Result<(), Missed> {
        let counts = self.patience();
        self.line.set_surely(BUS_WATCHDOG, &counts)
    }

    /// How long a silence they bear, as they count it.
    fn patience(&self) -> [u8; 1] {
        [(self.line.section.watchdog / WATCHDOG_UNIT).ceil() as u8]
    }

    fn read_states(&mut self, states: &mut States) -> Result<(), Missed> {
        let mut alert = None;
        let models = &self.models;
        let take = |place: usize, error: u8, data: &[u8; PRESENT_BYTES]| {
            if Protocol2::alerts(error) {
                alert = Some(place);
            }
            let [c0, c1, v0, v1, v2, v3, p0, p1, p2, p3] = *data;
            let state = &mut states[place];
            let current = f64::from(i16::from_le_bytes([c0, c1]));
            state.current = current * models[place].current_unit;
            state.velocity = f64::from(i32::from_le_bytes([v0, v1, v2, v3])) * VELOCITY_UNIT;
            state.position = f64::from(i32::from_le_bytes([p0, p1, p2, p3]));
        };
        match self.fast {
            true => read_fast(&mut self.line, take)?,
            false => self.line.get_all(PRESENT, take)?,
        }
        match alert {
            None => Ok(()),
            Some(place) => {
                let [error] = self.line.get(place, HARDWARE_ERROR)?;
                Err(self.line.hardware(place, hardware_error(error)).into())
            }
        }
    }

    /// What changes slowly, in turns.
    fn look(&mut self, states: &mut States) -> Result<(), Missed> {
        self.cycles = self.cycles.wrapping_add(1);
        match self.cycles % SLOWLY {
            0 => self
                .line
                .get_all(PRESENT_SUPPLY, |place, _, &[low, high, temperature]| {
                    states[place].voltage = 0.1 * f64::from(u16::from_le_bytes([low, high]));
                    states[place].temperature = f64::from(temperature);
                }),
            half if half == SLOWLY / 2 && self.on => {
                let wanted = self.patience();
                let mut watched = true;
                let each = |_, _, own: &[u8; 1]| watched &= *own == wanted;
                self.line.get_all(BUS_WATCHDOG, each)?;
                match watched {
                    true => Ok(()),
                    // Motors that have stopped follow again from here on.
                    false => {
                        self.line.set_surely(BUS_WATCHDOG, &[0])?;
                        self.watch()
                    }
                }
            }
            quarter if quarter == SLOWLY / 4 && self.on => self.line.are_on(TORQUE_ENABLE),
            _ => Ok(()),
        }
    }
}

/// The states of all motors in one packet: error, id, registers and CRC of each, but for the
/// first error and the last CRC, which are the packet's.
fn read_fast(
    line: &mut Line<Protocol2>,
    mut take: impl FnMut(usize, u8, &[u8; PRESENT_BYTES]),
) -> Result<(), Missed> {
    let length = (PRESENT_BYTES + 4) * line.ids.len() - 3;
    let answer = line
        .bus
        .fast_sync_read(&line.ids, PRESENT, PRESENT_BYTES, length)
        .map_err(|lost| Missed::Motor(0, lost))?;
    let (mut error, mut rest) = (answer.error, answer.data());
    for (place, id) in line.ids.iter().enumerate() {
        let own = rest.split_first().filter(|(found, _)| *found == id);
        let Some((data, after)) = own.and_then(|(_, data)| data.split_first_chunk()) else {
            return Err(Missed::Motor(place, Lost::Foreign));
        };
        take(place, error, data);
        if let [_, _, next, others @ ..] = after {
            (error, rest) = (*next, others);
        }
    }
    Ok(())
}

impl Family for Dynamixel {
    const GIVES_TORQUE: bool = true;

    fn start(&mut self) -> Result<States, MotorError> {
        for (place, answer) in self.line.call()?.iter().enumerate() {
            let number = answer.data().first_chunk().copied();
            let number = u16::from_le_bytes(number.unwrap_or_default());
            if number != self.models[place].number {
                return Err(self.line.other_model(place, models::described(number)));
            }
        }
        for place in 0..self.models.len() {
            self.prepare(place)?;
        }
        let mut states = States::default();
        // Motors of an older firmware do not answer to the fast way.
        if self.read_states(&mut states).is_err() {
            self.fast = false;
            let read = self.read_states(&mut states);
            read.map_err(|missed| self.line.missed(missed))?;
        }
        self.cycles = SLOWLY - 1;
        let looked = self.look(&mut states);
        looked.map_err(|missed| self.line.missed(missed))?;
        self.line.bus.settle();
        Ok(states)
    }

    fn step(&mut self, drive: &Drive, states: &mut States) -> Result<(), Missed> {
        self.tell(drive, states)?;
        self.read_states(states)?;
        self.look(states)
    }

    fn release(&mut self) {
        // Twice: nothing answers to this.
        for _ in 0..2 {
            let _ = self.line.set_all(TORQUE_ENABLE, [0]);
            let _ = self.line.set_all(BUS_WATCHDOG, [0]);
        }
        self.on = false;
    }

    fn silent(&mut self) -> Vec<usize> {
        self.line.silent()
    }

    fn damaged(&self) -> u32 {
        self.line.bus.damaged()
    }
}

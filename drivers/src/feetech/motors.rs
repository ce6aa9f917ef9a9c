//! What is done with Feetech motors.
//!
//! They have no mode of current or torque, and no watchdog. In the position mode the firmware's
//! gain makes a duty of how far the goal is away; so a current is given as the goal at which the
//! voltage is the one that it takes, R i + k ω. A motor that hears nothing any more goes to that
//! goal, some degrees away at most, and stands there with no more than its torque limit.

use std::f64::consts::TAU;

use super::{packet::StsProtocol, registers::*};
use crate::motors::{
    error::MotorError,
    family::{Drive, Family, Missed, MotorState, States},
    line::Line,
    protocol::Protocol,
    section::{COUNTS, Motor, Section},
};

/// Kinds of motors: names, and what they call themselves.
const MODELS: [(&str, u16); 2] = [("STS3215", 777), ("STS3250", 2825)];
/// Cycles between two looks at whether the drives are on.
const SLOWLY: u32 = 32;
/// Goals of motors of a single turn \[count\].
const GOALS: (f64, f64) = (0.0, COUNTS - 1.0);

/// Feetech motors on a bus.
pub struct Feetech {
    line: Line<StsProtocol>,
    /// Duty by count that the goal is away \[-\].
    duty_by_count: Vec<f64>,
    on: bool,
    /// Where they are held \[count\].
    held: Option<States>,
    cycles: u32,
}

impl Feetech {
    /// Opens the port of `section`.
    ///
    /// # Errors
    ///
    /// A model that is not known or not described, a port that is not to be had.
    pub fn open(section: &Section) -> Result<Feetech, MotorError> {
        for (place, motor) in section.motor.iter().enumerate() {
            if number(&motor.model).is_none() {
                let known = MODELS.map(|(name, _)| name).join(", ");
                let message = format!("model \"{}\" is not known; known are {known}", motor.model);
                return Err(section.setting(place, message));
            }
            if motor.resistance.is_none() {
                let message = "it is driven by voltage: give its resistance [Ohm]";
                return Err(section.setting(place, message.to_owned()));
            }
        }
        Ok(Feetech {
            line: Line::open(section)?,
            duty_by_count: vec![0.0; section.motor.len()],
            on: false,
            held: None,
            cycles: 0,
        })
    }

    fn check(&mut self, place: usize, error: u8) -> Result<(), MotorError> {
        let line = &mut self.line;
        if StsProtocol::alerts(error) {
            return Err(line.hardware(place, hardware_error(error)));
        }
        let found = u16::from_le_bytes(line.get(place, MODEL)?);
        if Some(found) != number(&line.section.motor[place].model) {
            let known = MODELS.iter().find(|(_, number)| *number == found);
            let unknown = || format!("of model number {found}");
            let name = known.map_or_else(unknown, |(name, _)| (*name).to_owned());
            return Err(line.other_model(place, name));
        }
        if line.get::<1>(place, ANSWERS)? != [1] {
            let message = "it does not answer to everything; set its Response_Status_Level to 1";
            return Err(line.setting(place, message.to_owned()));
        }
        Ok(())
    }

    fn prepare(&mut self, place: usize, supply: f64) -> Result<(), MotorError> {
        let line = &mut self.line;
        // These outlast the power: they are written where they are not so yet. A motor that
        // holds an arm since the program died goes on with it.
        for (address, wanted) in [(OPERATING_MODE, 0), (RETURN_DELAY, 0)] {
            if line.get::<1>(place, address)? != [wanted] {
                line.set(place, TORQUE_ENABLE, &[0])?;
                line.set(place, LOCK, &[0])?;
                line.set(place, address, &[wanted])?;
                line.set(place, LOCK, &[1])?;
            }
        }
        let [gain] = line.get(place, P_GAIN)?;
        if gain == 0 {
            let message = "its P coefficient is 0; set it to 16 or more";
            return Err(line.setting(place, message.to_owned()));
        }
        self.duty_by_count[place] = DUTY_BY_GAIN * f64::from(gain) * TAU / COUNTS;
        // The duty that gives the limit at standstill: it holds whatever the goal is.
        let duty = most(&line.section.motor[place], supply);
        let limit = (1000.0 * duty).floor() as u16;
        line.set(place, TORQUE_LIMIT, &limit.to_le_bytes())?;
        line.set(place, ACCELERATION, &[0])?;
        line.set(place, GOAL_TIME_AND_SPEED, &[0; 4])
    }

    fn tell(&mut self, drive: &Drive, states: &States) -> Result<(), Missed> {
        if (*drive != Drive::Off) != self.on {
            self.switch(!self.on, states)?;
        }
        let motors = &self.line.section.motor;
        let goals: States = match drive {
            Drive::Off => return Ok(()),
            Drive::Hold => *self.held.get_or_insert(*states),
            Drive::Currents(currents) => {
                self.held = None;
                let mut goals = *states;
                for (place, motor) in motors.iter().enumerate() {
                    let way = duty(motor, currents[place], &states[place]);
                    goals[place].position += way / self.duty_by_count[place];
                }
                goals
            }
        };
        self.set_goals(&goals)
    }

    fn set_goals(&mut self, goals: &States) -> Result<(), Missed> {
        self.line.set_each(GOAL_POSITION, |place| {
            unsigned(goals[place].position.clamp(GOALS.0, GOALS.1))
        })
    }

    fn switch(&mut self, on: bool, states: &States) -> Result<(), Missed> {
        self.held = None;
        if on {
            self.set_goals(states)?;
        }
        // A joint whose motor did not hear this would be limp, and tell its place all the same.
        self.line.set_surely(TORQUE_ENABLE, &[u8::from(on)])?;
        self.on = on;
        Ok(())
    }

    fn read_states(&mut self, states: &mut States) -> Result<(), Missed> {
        let mut alert = None;
        let take = |place: usize, error: u8, data: &[u8; PRESENT_BYTES]| {
            if StsProtocol::alerts(error) {
                alert = Some((place, error));
            }
            let [p0, p1, v0, v1, d0, d1, voltage, temperature, .., c0, c1] = *data;
            let state = &mut states[place];
            state.position = signed([p0, p1], 15);
            state.velocity = signed([v0, v1], 15) * TAU / COUNTS;
            // The size of the current only is told; it has the sign of the duty.
            let current = f64::from(u16::from_le_bytes([c0, c1]) & 0x7FFF) * CURRENT_UNIT;
            state.current = current.copysign(signed([d0, d1], 10));
            state.voltage = 0.1 * f64::from(voltage);
            state.temperature = f64::from(temperature);
        };
        self.line.get_all(PRESENT, take)?;
        match alert {
            None => Ok(()),
            Some((place, error)) => Err(self.line.hardware(place, hardware_error(error)).into()),
        }
    }
}

fn number(model: &str) -> Option<u16> {
    let is = |(name, _): &&(&str, u16)| model == *name || model.starts_with(&format!("{name}-"));
    MODELS.iter().find(is).map(|(_, number)| *number)
}

fn resistance(motor: &Motor) -> f64 {
    motor.resistance.unwrap_or(f64::INFINITY)
}

/// The largest duty that may be \[-\], at `supply` \[V\].
fn most(motor: &Motor, supply: f64) -> f64 {
    (resistance(motor) * motor.current_limit / supply.max(1.0)).min(1.0)
}

/// The duty that gives `current` \[A\] to a motor that is as `state` says \[-\].
fn duty(motor: &Motor, current: f64, state: &MotorState) -> f64 {
    let voltage = resistance(motor) * current + motor.torque_constant * state.velocity;
    let most = most(motor, state.voltage);
    (voltage / state.voltage.max(1.0)).clamp(-most, most)
}

impl Family for Feetech {
    const GIVES_TORQUE: bool = false;

    fn start(&mut self) -> Result<States, MotorError> {
        for (place, answer) in self.line.call()?.iter().enumerate() {
            self.check(place, answer.error)?;
        }
        let mut states = States::default();
        let read = self.read_states(&mut states);
        read.map_err(|missed| self.line.missed(missed))?;
        let motors = self.duty_by_count.len();
        for (place, state) in states.iter().enumerate().take(motors) {
            self.prepare(place, state.voltage)?;
        }
        self.line.bus.settle();
        Ok(states)
    }

    fn step(&mut self, drive: &Drive, states: &mut States) -> Result<(), Missed> {
        self.tell(drive, states)?;
        self.read_states(states)?;
        self.cycles = self.cycles.wrapping_add(1);
        match self.on && self.cycles.is_multiple_of(SLOWLY) {
            true => self.line.are_on(TORQUE_ENABLE),
            false => Ok(()),
        }
    }

    fn release(&mut self) {
        // Twice: nothing answers to this.
        for _ in 0..2 {
            let _ = self.line.set_all(TORQUE_ENABLE, [0]);
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

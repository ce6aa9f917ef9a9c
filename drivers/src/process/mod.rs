//! A plant in a program of its own, stepped over a pipe: `docs/process_driver.md` says how.
//!
//! Its time is that of the session: each step sends the torques and how much time goes by, and
//! waits for what is measured after it. In virtual time a session with such a plant is
//! therefore as repeatable as the plant is.

mod error;
mod greeting;
mod pipe;

pub use error::{At, Ending, PlantError};
pub use greeting::{Greeting, Layout, Part};

use std::time::Duration;

use ferntast_model::{JointCount, Joints};
use ferntast_msgs::{
    Text,
    sample::{Fault, JointNames, Level, RobotDescriptionSample},
};
use ferntast_nodes::{
    graph::STEP_NANOS,
    node::NodeHealth,
    process::{NodeError, SessionContext},
};

use crate::driver::{Driver, DriverCommand, Measures, Reading};
use pipe::Pipe;

/// The plant that `command` is.
pub(crate) fn driver(
    session: &SessionContext,
    command: &str,
) -> Result<Box<dyn Driver>, NodeError> {
    let (joints, loaded) = (session.joints(), &session.loaded);
    let period = STEP_NANOS as f64 * 1e-9;
    let greeting = Greeting::new(&joints, period, loaded.scenario.seed, loaded.arm.whole()?);
    let plant = ProcessPlant::start(command, joints, &greeting, Patience::default());
    Ok(Box::new(plant.map_err(NodeError::own)?))
}

/// How long it is waited for a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patience {
    /// For the answer to the greeting: a program may have to load much.
    pub greeting: Duration,
    /// For the answer to a step.
    pub step: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Patience {
            greeting: Duration::from_secs(60),
            step: Duration::from_secs(5),
        }
    }
}

/// What a plant tells of what is true, for judges only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlantTruth {
    /// Contact force on the tip \[N\], base frame.
    pub contact_force: Option<[f64; 3]>,
    /// The tip \[m\], base frame.
    pub tip: Option<[f64; 3]>,
    /// Work that the contact did on the tip since the start \[J\].
    pub contact_work: Option<f64>,
    /// Energy of all parts \[J\].
    pub energy: Option<f64>,
}

/// A plant in a program of its own.
pub struct ProcessPlant {
    joints: JointNames,
    count: JointCount,
    layout: Layout,
    pipe: Pipe,
    patience: Patience,
    /// Time that has gone by there \[s\].
    time: f64,
    record: Vec<u8>,
    numbers: Vec<f64>,
    truth: PlantTruth,
    failed: Option<PlantError>,
    description: Option<RobotDescriptionSample>,
}

impl ProcessPlant {
    /// Starts `command` and greets it.
    ///
    /// # Errors
    ///
    /// A program that does not start, does not answer, or does not fit the arm.
    pub fn start(
        command: &str,
        joints: JointNames,
        greeting: &Greeting,
        patience: Patience,
    ) -> Result<ProcessPlant, PlantError> {
        let mut pipe = Pipe::start(command)?;
        let refused = |error: serde_json::Error| PlantError::Greeting {
            line: String::new(),
            reason: error.to_string(),
        };
        let mut line = serde_json::to_string(greeting).map_err(refused)?;
        line.push('\n');
        // One that says something and ends at once is told by what it says.
        let sent = pipe.send(line.as_bytes(), At::Greeting);
        let answer = pipe.receive_line(patience.greeting, At::Greeting)?;
        let layout = Layout::of_answer(&answer, greeting)?;
        sent?;
        let count = JointCount::new(joints.len()).map_err(|error| PlantError::Greeting {
            line: answer,
            reason: error.to_string(),
        })?;
        Ok(ProcessPlant {
            record: Vec::with_capacity(8 * layout.numbers().max(1 + joints.len())),
            numbers: vec![0.0; layout.numbers()],
            joints,
            count,
            layout,
            pipe,
            patience,
            time: 0.0,
            truth: PlantTruth::default(),
            failed: None,
            description: None,
        })
    }

    /// The same with what it looks like.
    pub fn described(self, description: RobotDescriptionSample) -> ProcessPlant {
        ProcessPlant {
            description: Some(description),
            ..self
        }
    }

    /// What it last told of what is true.
    pub fn truth(&self) -> &PlantTruth {
        &self.truth
    }

    /// Sends a step of `elapsed` \[s\] with `torque`.
    fn send(&mut self, torque: &Joints<f64>, elapsed: f64) -> Result<(), PlantError> {
        self.record.clear();
        self.record.extend(elapsed.to_le_bytes());
        let begin = self.record.len();
        self.record.resize(begin + 8 * torque.len(), 0);
        for (place, value) in self.layout.places.iter().zip(torque.iter()) {
            let at = begin + 8 * place;
            self.record[at..at + 8].copy_from_slice(&value.to_le_bytes());
        }
        self.time += elapsed;
        self.pipe.send(&self.record, At::Time(self.time))
    }

    /// Waits for what is measured after it.
    fn receive(&mut self) -> Result<Reading, PlantError> {
        let at = At::Time(self.time);
        self.record.clear();
        self.record.resize(8 * self.layout.numbers(), 0);
        self.pipe
            .receive(&mut self.record, self.patience.step, at)?;
        let words = self.record.as_chunks::<8>().0.iter();
        for (number, word) in self.numbers.iter_mut().zip(words) {
            *number = f64::from_le_bytes(*word);
        }
        let (mut begin, joints) = (0, self.count.get());
        let mut take = |what: &'static str, length: usize| {
            let numbers = &self.numbers[begin..begin + length];
            begin += length;
            let wrong = numbers.iter().position(|number| !number.is_finite());
            match wrong {
                None => Ok(numbers),
                Some(number) => Err(PlantError::NotFinite {
                    what,
                    number: number + 1,
                    value: numbers[number],
                    at,
                }),
            }
        };
        let places = &self.layout.places;
        let own = |numbers: &[f64]| Joints::from_fn(self.count, |joint| numbers[places[joint]]);
        let mut reading = Reading {
            position: own(take("position", joints)?),
            velocity: own(take("velocity", joints)?),
            joint_torque: None,
            motor_torque: None,
            temperature: None,
        };
        let three = |numbers: &[f64]| [numbers[0], numbers[1], numbers[2]];
        for part in &self.layout.parts {
            let numbers = take(part.name(), part.numbers(joints))?;
            match part {
                Part::JointTorque => reading.joint_torque = Some(own(numbers)),
                Part::MotorTorque => reading.motor_torque = Some(own(numbers)),
                Part::Temperature => reading.temperature = Some(own(numbers)),
                Part::ContactForce => self.truth.contact_force = Some(three(numbers)),
                Part::Tip => self.truth.tip = Some(three(numbers)),
                Part::ContactWork => self.truth.contact_work = Some(numbers[0]),
                Part::Energy => self.truth.energy = Some(numbers[0]),
            }
        }
        Ok(reading)
    }

    fn fail(&mut self, error: PlantError) {
        self.failed = Some(error);
    }
}

impl Driver for ProcessPlant {
    fn joints(&self) -> JointNames {
        self.joints
    }

    fn measures(&self) -> Measures {
        self.layout.measures()
    }

    fn write(&mut self, command: &DriverCommand, health: &mut NodeHealth) {
        if self.failed.is_some() {
            return;
        }
        let mut torque = command.torque;
        for value in torque.iter_mut().filter(|value| !value.is_finite()) {
            health.raise(Fault::CommandInvalid, Level::ERROR);
            *value = 0.0;
        }
        let sent = self.send(&torque, command.elapsed.unwrap_or(0.0));
        if let Err(error) = sent {
            self.fail(error);
        }
    }

    fn read(&mut self, health: &mut NodeHealth) -> Option<Reading> {
        if self.failed.is_none() {
            match self.receive() {
                Ok(reading) => return Some(reading),
                Err(error) => self.fail(error),
            }
        }
        // A plant that has lost its step has no state that could be gone on with.
        let fault = match self.failed {
            Some(PlantError::NotFinite { .. }) => Fault::MeasurementInvalid,
            _ => Fault::MeasurementSilent,
        };
        health.raise(fault, Level::ERROR);
        if let Some(error) = &self.failed {
            health.message = Text::display(error);
        }
        None
    }

    fn failure(&self) -> Option<String> {
        self.failed.as_ref().map(ToString::to_string)
    }

    fn description(&mut self) -> Option<RobotDescriptionSample> {
        self.description.take()
    }
}

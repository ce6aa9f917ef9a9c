//! What moves and touches in place of an arm: our own simulation, or a program of its own.

use ferntast_config::{ArmFile, serial::Serial};
use ferntast_drivers::{
    Choice, Driver, DriverCommand, Reading,
    process::{Greeting, Patience, ProcessPlant},
    serial_arm::SimulatedSerialArm,
    simulated::serial,
};
use ferntast_model::{Joints, rigid_body::Vector3};
use ferntast_nodes::{node::NodeHealth, process::NodeError};
use ferntast_sim::teleoperation::TICK;

use super::ArmsError;

/// A plant that tells what is true of it.
pub(super) enum Plant {
    Simulated(Box<SimulatedSerialArm>),
    Process(Box<ProcessPlant>),
}

/// What is true of the tip, base frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    /// [m]
    pub tip: Vector3<f64>,
    /// Of the contact on it [N].
    pub force: Vector3<f64>,
    /// Of the contact on it since the start [J].
    pub work: f64,
}

impl Plant {
    pub(super) fn new(
        choice: &Choice,
        file: &ArmFile,
        serial: &Serial,
        seed: u64,
    ) -> Result<Plant, ArmsError> {
        if let Choice::Process(command) = choice {
            let greeting = Greeting::new(&serial.joints, TICK, seed, file.whole()?);
            let plant = ProcessPlant::start(command, serial.joints, &greeting, Patience::default());
            return Ok(Plant::Process(Box::new(plant.map_err(NodeError::own)?)));
        }
        if *choice != Choice::Simulated {
            return Err(ArmsError::RealTime);
        }
        let arm = serial::simulated(file, serial, seed)?;
        Ok(Plant::Simulated(Box::new(arm)))
    }

    fn driver(&mut self) -> &mut dyn Driver {
        match self {
            Plant::Simulated(own) => &mut **own,
            Plant::Process(own) => &mut **own,
        }
    }

    /// Lets a tick pass, none with `elapsed` of `None`; gives what is measured then.
    pub(super) fn step(&mut self, torque: &Joints<f64>, elapsed: Option<f64>) -> Option<Reading> {
        let command = DriverCommand {
            torque: *torque,
            elapsed,
        };
        let mut health = NodeHealth::default();
        self.driver().write(&command, &mut health);
        self.driver().read(&mut health)
    }

    /// What is true now; `None` where the plant does not tell.
    pub(super) fn touching(&self) -> Option<Touching> {
        match self {
            Plant::Simulated(own) => {
                let truth = own.arm().truth();
                Some(Touching {
                    tip: truth.tip.translation,
                    force: truth.force,
                    work: truth.contact_work,
                })
            }
            Plant::Process(own) => {
                let truth = own.truth();
                Some(Touching {
                    tip: truth.tip?.into(),
                    force: truth.contact_force?.into(),
                    work: truth.contact_work?,
                })
            }
        }
    }

    /// Why it can do no more.
    pub(super) fn failure(&self) -> Option<String> {
        match self {
            Plant::Simulated(own) => own.failure(),
            Plant::Process(own) => own.failure(),
        }
    }
}

//! The simulated arm with sensors that fail, whose mechanics outlive its driver.

use std::{
    cell::{Cell, RefCell},
    rc::Rc,
};

use ferntast_bus::SubscriberCounts;
use ferntast_drivers::{
    ArmInput, ArmNode, ArmOutput, ArmPorts, Driver as ArmDriver,
    serial_arm::SimulatedSerialArm,
    simulated::{Simulated, serial},
};
use ferntast_model::{JointCount, Joints, MAX_JOINTS};
use ferntast_msgs::{
    Time,
    sample::{JointNames, JointSample},
    topics::{JointNameError, TopicName},
};
use ferntast_nodes::{
    graph::Build,
    node::{Node, Ports, Ticking},
    process::{NodeError, SessionContext},
};
use ferntast_sim::{
    arm::{ArmConfig, SimulatedArm, SimulatedArmError},
    serial_arm::{SerialArm, SerialArmParameters},
};

use super::{fault::SensorFault, truth::Truth};

/// What is true of the arm of a kit.
#[derive(Clone, Debug)]
pub enum TrueArm {
    /// Two joints in a plane.
    Planar(Box<ArmConfig>),
    /// Any joints in space.
    Serial(Box<SerialArmParameters>),
}

/// Why there is no arm.
#[derive(Debug, thiserror::Error)]
pub enum MechanicsError {
    /// One of two joints cannot be made.
    #[error(transparent)]
    Planar(#[from] SimulatedArmError),
    /// A serial one cannot be made.
    #[error(transparent)]
    Serial(#[from] NodeError),
}

/// The arm itself.
enum Arm {
    Planar(Box<SimulatedArm>),
    Serial(Box<SerialArm>),
}

impl Arm {
    fn truth(&self) -> Truth {
        match self {
            Arm::Planar(arm) => arm.truth().into(),
            Arm::Serial(arm) => arm.truth().into(),
        }
    }
}

/// What stays while drivers come and go.
pub struct Mechanics {
    arm: RefCell<Arm>,
    count: JointCount,
    truth: Cell<Truth>,
    sensor: Cell<Option<SensorFault>>,
    /// Whose sensors fail where those of one joint do.
    fails: usize,
    driven: Cell<Joints<f64>>,
}

impl Mechanics {
    /// The arm of a session at rest, which is like that in truth.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds, a posture that touches something.
    pub fn new(arm: &TrueArm, session: &SessionContext) -> Result<Rc<Mechanics>, MechanicsError> {
        let seed = session.loaded.scenario.seed;
        let (arm, fails) = match arm {
            TrueArm::Planar(config) => (Arm::Planar(SimulatedArm::new(config, seed)?.into()), 0),
            TrueArm::Serial(truth) => {
                let driver = serial_driver(session, truth)?;
                let joints = driver.arm().count().get() as u64;
                let fails = (seed % joints) as usize;
                (Arm::Serial(driver.arm().clone().into()), fails)
            }
        };
        let truth = arm.truth();
        Ok(Rc::new(Mechanics {
            count: truth.position.count(),
            truth: Cell::new(truth),
            arm: RefCell::new(arm),
            sensor: Cell::new(None),
            fails,
            driven: Cell::new(truth.position.map(|_| 0.0)),
        }))
    }

    /// What is true now.
    pub fn truth(&self) -> Truth {
        self.truth.get()
    }

    /// Torques of the motors, from their currents \[Nm\].
    pub fn driven(&self) -> Joints<f64> {
        self.driven.get()
    }

    /// What the sensors suffer from on.
    pub fn fail(&self, sensor: Option<SensorFault>) {
        self.sensor.set(sensor);
    }

    /// Lets `duration` \[s\] pass with the drives off, while there is no driver. What has weight
    /// is held by its brakes.
    pub fn coast(&self, duration: f64) {
        let none = Joints::filled(self.count, 0.0);
        let mut arm = self.arm.borrow_mut();
        match &mut *arm {
            Arm::Planar(arm) => {
                arm.advance([0.0; 2], duration);
            }
            Arm::Serial(arm) => {
                arm.brake(true);
                arm.advance(&none, duration);
            }
        }
        self.driven.set(none);
        self.truth.set(arm.truth());
    }

    /// A driver for it.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn driver(
        self: &Rc<Self>,
        build: Build,
        truth: &TrueArm,
    ) -> Result<Box<dyn Ticking>, NodeError> {
        let session = build.session;
        let other = || NodeError::Broken("the arm is of another kind than its truth".into());
        let driver: Box<dyn ArmDriver> = match (&*self.arm.borrow(), truth) {
            (Arm::Planar(arm), _) => {
                let model = session.loaded.arm.model.planar().ok_or_else(other)?;
                Box::new(Simulated::of((**arm).clone(), model))
            }
            (Arm::Serial(arm), TrueArm::Serial(truth)) => {
                Box::new(serial_driver(session, truth)?.with((**arm).clone()))
            }
            (Arm::Serial(_), TrueArm::Planar(_)) => return Err(other()),
        };
        let driver = Driver {
            node: ArmNode::new(driver)?.planted(session.planted),
            mechanics: self.clone(),
            last: None,
        };
        let ports = ArmPorts::connect(build.bus, &session.joints())?;
        build.join(driver, DriverPorts(ports))
    }
}

/// The driver of a session's serial arm at rest.
fn serial_driver(
    session: &SessionContext,
    truth: &SerialArmParameters,
) -> Result<SimulatedSerialArm, NodeError> {
    let arm = &session.loaded.arm;
    let believed = arm.model.serial();
    let believed = believed.ok_or_else(|| NodeError::Broken("the arm is no serial one".into()))?;
    let driver = serial::simulated_as(arm, believed, truth, session.loaded.scenario.seed)?;
    // It would fall else whenever its servo dies.
    Ok(driver.braked())
}

/// The arm's node, with sensors that fail.
struct Driver {
    node: ArmNode,
    mechanics: Rc<Mechanics>,
    last: Option<JointSample>,
}

impl Node for Driver {
    type Input = ArmInput;
    type Output = ArmOutput;

    fn step(&mut self, now: Time, input: &ArmInput, output: &mut ArmOutput) {
        self.node.step(now, input, output);
        if let Some(truth) = self.truth() {
            self.mechanics.truth.set(truth);
        }
        let count = self.mechanics.count;
        let motors = output.motor_js.map_or([0.0; MAX_JOINTS], |own| own.effort);
        self.mechanics
            .driven
            .set(Joints::from_places(count, motors));
        let Some(sensor) = self.mechanics.sensor.get() else {
            self.last = output.measured_js;
            return;
        };
        let joint = self.mechanics.fails;
        match sensor {
            SensorFault::Stuck => {
                output.measured_js = self.last.map(|last| JointSample { stamp: now, ..last });
            }
            SensorFault::ZeroError(error) => {
                if let Some(sample) = &mut output.measured_js {
                    sample.position[joint] += error;
                }
            }
            SensorFault::TorqueError(error) => {
                if let Some(sample) = &mut output.measured_js {
                    sample.effort[joint] += error;
                }
            }
            SensorFault::DropOut => output.measured_js = None,
            SensorFault::NotANumber => {
                if let Some(sample) = &mut output.measured_js {
                    sample.position[joint] = f64::NAN;
                }
            }
        }
    }
}

impl Driver {
    fn truth(&self) -> Option<Truth> {
        let planar = self.node.driver::<Simulated>();
        let serial = self.node.driver::<SimulatedSerialArm>();
        match (planar, serial) {
            (Some(own), _) => Some(own.arm().truth().into()),
            (None, Some(own)) => Some(own.arm().truth().into()),
            (None, None) => None,
        }
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        if let Some(own) = self.node.driver::<Simulated>() {
            let arm = Arm::Planar(own.arm().clone().into());
            self.mechanics.arm.replace(arm);
        }
        if let Some(own) = self.node.driver::<SimulatedSerialArm>() {
            let arm = Arm::Serial(own.arm().clone().into());
            self.mechanics.arm.replace(arm);
        }
    }
}

struct DriverPorts(ArmPorts);

impl Ports for DriverPorts {
    type Node = Driver;

    fn inputs(joints: &JointNames) -> Result<Vec<TopicName>, JointNameError> {
        ArmPorts::inputs(joints)
    }

    fn outputs(joints: &JointNames) -> Result<Vec<TopicName>, JointNameError> {
        ArmPorts::outputs(joints)
    }

    fn read(&mut self, now: Time, input: &mut ArmInput) {
        self.0.read(now, input);
    }

    fn write(&mut self, now: Time, output: &ArmOutput) -> u64 {
        self.0.write(now, output)
    }

    fn counts(&self, each: &mut dyn FnMut(&TopicName, &SubscriberCounts)) {
        self.0.counts(each);
    }
}

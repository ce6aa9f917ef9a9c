//! The simulated arm with sensors that fail, whose mechanics outlive its driver.

use std::{
    cell::{Cell, RefCell},
    rc::Rc,
};

use ferntast_bus::SubscriberCounts;
use ferntast_drivers::{ArmInput, ArmNode, ArmOutput, ArmPorts, simulated::Simulated};
use ferntast_msgs::{
    Time,
    sample::{JointNames, JointSample},
    topics::{JointNameError, TopicName},
};
use ferntast_nodes::{
    graph::Build,
    node::{Node, Ports, Ticking},
    process::NodeError,
};
use ferntast_sim::arm::{ArmConfig, SimulatedArm, SimulatedArmError, Truth};

use super::fault::SensorFault;

/// What stays while drivers come and go.
pub struct Mechanics {
    arm: RefCell<SimulatedArm>,
    truth: Cell<Truth>,
    sensor: Cell<Option<SensorFault>>,
    driven: Cell<[f64; 2]>,
}

impl Mechanics {
    /// An arm at rest.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds, a posture that touches the contour.
    pub fn new(config: &ArmConfig, seed: u64) -> Result<Rc<Mechanics>, SimulatedArmError> {
        let arm = SimulatedArm::new(config, seed)?;
        Ok(Rc::new(Mechanics {
            truth: Cell::new(arm.truth()),
            arm: RefCell::new(arm),
            sensor: Cell::new(None),
            driven: Cell::new([0.0; 2]),
        }))
    }

    /// What is true now.
    pub fn truth(&self) -> Truth {
        self.truth.get()
    }

    /// Torques of the motors, from their currents \[Nm\].
    pub fn driven(&self) -> [f64; 2] {
        self.driven.get()
    }

    /// What the sensors suffer from on.
    pub fn fail(&self, sensor: Option<SensorFault>) {
        self.sensor.set(sensor);
    }

    /// Lets `duration` \[s\] pass with the drives off, while there is no driver.
    pub fn coast(&self, duration: f64) {
        let mut arm = self.arm.borrow_mut();
        arm.advance([0.0; 2], duration);
        self.driven.set([0.0; 2]);
        self.truth.set(arm.truth());
    }

    /// A driver for it.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn driver(self: &Rc<Self>, build: Build) -> Result<Box<dyn Ticking>, NodeError> {
        let model = build.session.loaded.arm.model.planar();
        let model = model.ok_or_else(|| {
            NodeError::Broken("schedules of faults are for the planar arm".into())
        })?;
        let arm = Simulated::of(self.arm.borrow().clone(), model);
        let driver = Driver {
            node: ArmNode::new(Box::new(arm))?.planted(build.session.planted),
            mechanics: self.clone(),
            last: None,
        };
        let ports = ArmPorts::connect(build.bus, &build.session.joints())?;
        build.join(driver, DriverPorts(ports))
    }
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
        if let Some(simulated) = self.node.driver::<Simulated>() {
            self.mechanics.truth.set(simulated.arm().truth());
        }
        let motors = output.motor_js.map_or([0.0; 2], |own| own.effort());
        self.mechanics.driven.set(motors);
        let Some(sensor) = self.mechanics.sensor.get() else {
            self.last = output.measured_js;
            return;
        };
        match sensor {
            SensorFault::Stuck => {
                output.measured_js = self.last.map(|last| JointSample { stamp: now, ..last });
            }
            SensorFault::ZeroError(error) => {
                if let Some(sample) = &mut output.measured_js {
                    sample.position[0] += error;
                }
            }
            SensorFault::TorqueError(error) => {
                if let Some(sample) = &mut output.measured_js {
                    sample.effort[0] += error;
                }
            }
            SensorFault::DropOut => output.measured_js = None,
            SensorFault::NotANumber => {
                if let Some(sample) = &mut output.measured_js {
                    sample.position[0] = f64::NAN;
                }
            }
        }
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        if let Some(simulated) = self.node.driver::<Simulated>() {
            self.mechanics.arm.replace(simulated.arm().clone());
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

//! What there is of an arm behind its node.

use std::any::Any;

use ferntast_model::Joints;
use ferntast_msgs::{
    Time,
    sample::{JointNames, RobotDescriptionSample},
};
use ferntast_nodes::node::NodeHealth;

/// Something that moves joints and measures them: a simulation, a program, a bus of motors.
///
/// All values are on the joint side of the gear, in the order of [`joints`](Self::joints),
/// in SI units and the signs of the arm's file: a driver turns what its maker counts in
/// (steps, degrees, a motor's sense of turning) here, and nowhere else.
///
/// Neither function of a step fails. What goes wrong is raised in the node's health, with
/// words, and a reading that is not to be trusted is not given: a servo that hears nothing
/// for its `measurement_watchdog` is in FAULT, gives no torque, and does not begin. What then
/// holds an arm without brakes is its driver.
pub trait Driver: Any {
    /// Its joints, from the base on.
    fn joints(&self) -> JointNames;

    /// What it measures beside positions and velocities.
    fn measures(&self) -> Measures;

    /// Whether its drives give the torques that they are commanded. One whose drives can only be
    /// told where to go makes of a torque a goal that is not far: that moves an arm, and is no
    /// force that a hand could feel.
    fn gives_torque(&self) -> bool {
        true
    }

    /// Whether its joints know where they are. Until then no reading is published.
    fn is_homed(&self) -> bool {
        true
    }

    /// Lets its drives follow commands, or lets go of them. Called as that changes, before
    /// the command that it is about.
    fn enable(&mut self, _enabled: bool) {}

    /// Takes a command.
    fn write(&mut self, command: &DriverCommand, health: &mut NodeHealth);

    /// Reads its sensors; `None` where there is nothing that can be trusted.
    fn read(&mut self, health: &mut NodeHealth) -> Option<Reading>;

    /// When the last reading was measured by the arm's own clock, where it tells that.
    fn stamp(&self) -> Option<Time> {
        None
    }

    /// Why it can do no more, where that is so for good.
    fn failure(&self) -> Option<String> {
        None
    }

    /// What it looks like, for those with tools of their own; taken once.
    fn description(&mut self) -> Option<RobotDescriptionSample> {
        None
    }
}

/// What a driver measures beside positions and velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Measures {
    /// Joint torques, behind the gears.
    pub joint_torque: bool,
    /// Motor torques, from currents.
    pub motor_torque: bool,
    /// Temperatures of the gears.
    pub temperature: bool,
}

/// What the drives are to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriverCommand {
    /// Motor torques \[Nm\] or \[N\]; zero while the drives are off.
    pub torque: Joints<f64>,
    /// Time since the last step \[s\], for a plant whose time passes step by step; `None` in
    /// the first one.
    pub elapsed: Option<f64>,
}

/// What the sensors of all joints give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Positions \[rad\] or \[m\].
    pub position: Joints<f64>,
    /// Velocities \[rad/s\] or \[m/s\].
    pub velocity: Joints<f64>,
    /// Torques behind the gears \[Nm\] or \[N\].
    pub joint_torque: Option<Joints<f64>>,
    /// Torques of the motors \[Nm\] or \[N\], the mean since the last step.
    pub motor_torque: Option<Joints<f64>>,
    /// Temperatures of the gears \[degC\].
    pub temperature: Option<Joints<f64>>,
}

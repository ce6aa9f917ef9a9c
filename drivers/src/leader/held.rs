//! A simulated leader arm in a simulated hand, to be tried and tested without hardware.

use ferntast_config::{ArmFile, Axes, serial::Serial};
use ferntast_emulation::hand::{ImpedanceParameters, ScriptedHand, ScriptedHandConfig};
use ferntast_model::rigid_body::{Placement, Vector3};
use ferntast_msgs::sample::JointNames;
use ferntast_nodes::{node::NodeHealth, process::NodeError};
use ferntast_sim::serial_arm::Grip;

use crate::{
    driver::{Driver, DriverCommand, Measures, Reading},
    serial_arm::SimulatedSerialArm,
    simulated::serial::{simulated_as, truth},
};

/// How a hand resists the tip's turning \[Nm/rad\], \[Nm·s/rad\]: loosely, since an arm of few
/// joints turns its tip as it moves it. No measured hand.
const TURNING_STIFFNESS: f64 = 1.0;
const TURNING_DAMPING: f64 = 0.2;
/// The seed of the leader's sensors is that of the session, and this.
const OTHER_SEED: u64 = 0x6c65_6164;

/// A simulated arm whose tip the scripted operator holds, with the stiffness and damping of their
/// hand; its mass is not there. There is nothing else that it could touch.
pub struct HeldArm {
    arm: SimulatedSerialArm,
    hand: ScriptedHand,
    impedance: ImpedanceParameters,
    axes: Axes,
    /// The tip at home.
    home: Placement,
    running: bool,
}

impl HeldArm {
    /// The simulated arm of `file`, at home, held by a hand that moves as `config` says in
    /// `leader_base`, whose axes are those of the arm's base by `axes`.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds.
    pub fn new(
        file: &ArmFile,
        serial: &Serial,
        axes: Axes,
        config: &ScriptedHandConfig,
        seed: u64,
    ) -> Result<HeldArm, NodeError> {
        let mut own = truth(file)?;
        own.object.clear();
        Ok(HeldArm {
            arm: simulated_as(file, serial, &own, seed.wrapping_add(OTHER_SEED))?,
            hand: ScriptedHand::new(config, seed)?,
            impedance: config.impedance,
            axes,
            home: serial.arm.home_tip(),
            running: false,
        })
    }

    /// Whether the script goes on, or the hand stays where it is.
    pub fn set_running(&mut self, running: bool) {
        self.running = running;
    }

    /// The arm itself, for those who look at what is true.
    pub fn arm(&self) -> &ferntast_sim::serial_arm::SerialArm {
        self.arm.arm()
    }

    /// Has the hand hold the tip where it wants it `elapsed` \[s\] later.
    fn hold(&mut self, elapsed: f64) {
        let (target, rate) = self.hand.want(if self.running { elapsed } else { 0.0 });
        let own = |vector: [f64; 3]| Vector3::from(self.axes.to_device(vector));
        let velocity = match self.running {
            true => own(rate),
            false => Vector3::zeros(),
        };
        self.arm.hold(Grip {
            position: self.home.translation + own(target),
            velocity,
            rotation: self.home.rotation,
            stiffness: self.impedance.stiffness,
            damping: self.impedance.damping,
            turning_stiffness: TURNING_STIFFNESS,
            turning_damping: TURNING_DAMPING,
        });
    }
}

impl Driver for HeldArm {
    fn joints(&self) -> JointNames {
        self.arm.joints()
    }

    fn measures(&self) -> Measures {
        self.arm.measures()
    }

    fn write(&mut self, command: &DriverCommand, health: &mut NodeHealth) {
        self.hold(command.elapsed.unwrap_or(0.0));
        self.arm.write(command, health);
    }

    fn read(&mut self, health: &mut NodeHealth) -> Option<Reading> {
        self.arm.read(health)
    }
}

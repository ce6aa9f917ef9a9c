//! The driver's section of an arm's file: which motors turn which joints, and how.

use std::f64::consts::TAU;

use ferntast_config::{ArmFile, serial::SerialFile};
use ferntast_msgs::sample::JointNames;
use serde::Deserialize;

use super::error::{MotorError, MotorName};

/// Counts of a turn; all motors that there are drivers for count alike.
pub const COUNTS: f64 = 4096.0;

/// `[driver.dynamixel]`, `[driver.feetech]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// The port.
    pub port: String,
    /// How fast it goes \[baud\].
    #[serde(default = "a_million")]
    pub baud: u32,
    /// After how long a silence of the bus the motors stop by themselves \[s\]; for those
    /// that can.
    #[serde(default = "watchdog")]
    pub watchdog: f64,
    /// The motors, in any order.
    pub motor: Vec<Motor>,
}

/// `[[driver.….motor]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Its number on the bus.
    pub id: u8,
    /// The joint that it turns.
    pub joint: String,
    /// Its maker's name of its kind.
    pub model: String,
    /// 1 where it turns as the joint does, −1 where it turns against it.
    #[serde(default = "one")]
    pub direction: i8,
    /// What it counts where the joint's position is zero \[count\].
    pub zero: f64,
    /// Turns of the motor's shaft in one of the joint, or by metre.
    #[serde(default = "one_to_one")]
    pub gear: f64,
    /// Torque at the motor's shaft by current \[Nm/A\].
    pub torque_constant: f64,
    /// Resistance of the winding \[Ohm\], for motors that are driven by voltage.
    pub resistance: Option<f64>,
    /// The largest current \[A\].
    pub current_limit: f64,
}

fn a_million() -> u32 {
    1_000_000
}

fn watchdog() -> f64 {
    0.1
}

fn one() -> i8 {
    1
}

fn one_to_one() -> f64 {
    1.0
}

impl Section {
    /// That of `driver` in the arm's file, its motors in the order of `joints`.
    ///
    /// # Errors
    ///
    /// There is none, or it does not fit the arm.
    pub fn of(
        driver: &'static str,
        file: &ArmFile,
        joints: &JointNames,
    ) -> Result<Section, MotorError> {
        let bad = |message: String| MotorError::Section { driver, message };
        let serial = file.model.serial().map(|_| file.whole::<SerialFile>());
        let serial = serial.transpose().map_err(|error| bad(error.to_string()))?;
        let section = serial.and_then(|own| own.driver?.get(driver).cloned());
        let section = section.ok_or(MotorError::NoSection(driver))?;
        let section: Section =
            serde_json::from_value(section).map_err(|error| bad(error.to_string()))?;
        section.in_order_of(joints).map_err(bad)
    }

    /// The same with its motors in the order of `joints`.
    ///
    /// # Errors
    ///
    /// What does not fit, in words.
    pub fn in_order_of(mut self, joints: &JointNames) -> Result<Section, String> {
        for motor in &self.motor {
            motor.check()?;
            let same = |other: &&Motor| other.id == motor.id;
            if self.motor.iter().filter(same).count() > 1 {
                return Err(format!("two motors have the id {}", motor.id));
            }
            if !joints.iter().any(|joint| joint == motor.joint) {
                let (id, joint) = (motor.id, &motor.joint);
                return Err(format!(
                    "motor {id} turns \"{joint}\", which is no joint of the arm; it has {joints}"
                ));
            }
        }
        if !(0.02..=2.54).contains(&self.watchdog) {
            return Err(format!("watchdog = {}; give 0.02 to 2.54 s", self.watchdog));
        }
        let mut ordered = Vec::with_capacity(self.motor.len());
        for joint in joints.iter() {
            let mut own = self.motor.iter().filter(|motor| motor.joint == joint);
            match (own.next(), own.next()) {
                (Some(motor), None) => ordered.push(motor.clone()),
                (None, _) => return Err(format!("joint \"{joint}\" has no motor")),
                (Some(one), Some(other)) => {
                    return Err(format!(
                        "motors {} and {} both turn \"{joint}\"; have the second follow the \
                         first by its own settings (secondary id), and name the first",
                        one.id, other.id
                    ));
                }
            }
        }
        self.motor = ordered;
        Ok(self)
    }

    /// What motor number `place` is called.
    pub fn name(&self, place: usize) -> MotorName {
        let motor = &self.motor[place];
        MotorName {
            id: motor.id,
            joint: motor.joint.clone(),
            port: self.port.clone(),
        }
    }

    /// Something about a motor that has to be set otherwise.
    pub fn setting(&self, place: usize, message: String) -> MotorError {
        MotorError::Setting {
            motor: self.name(place),
            message,
        }
    }
}

impl Motor {
    fn check(&self) -> Result<(), String> {
        let id = self.id;
        let positive = |name: &str, value: f64| match value.is_finite() && value > 0.0 {
            true => Ok(()),
            false => Err(format!("motor {id}: {name} = {value} is not above zero")),
        };
        if id > 252 {
            return Err(format!("motor {id}: ids go to 252"));
        }
        if ![1, -1].contains(&self.direction) {
            return Err(format!("motor {id}: direction is 1 or -1"));
        }
        if !self.zero.is_finite() {
            return Err(format!("motor {id}: zero is no number"));
        }
        positive("gear", self.gear)?;
        positive("torque_constant", self.torque_constant)?;
        positive("current_limit", self.current_limit)?;
        positive("resistance", self.resistance.unwrap_or(1.0))
    }

    fn turn(&self) -> f64 {
        f64::from(self.direction) * self.gear
    }

    /// Position of the joint \[rad\] where the motor counts `counts`.
    pub fn position(&self, counts: f64) -> f64 {
        (counts - self.zero) * TAU / COUNTS / self.turn()
    }

    /// Velocity of the joint \[rad/s\] where the motor's shaft turns at `velocity` \[rad/s\].
    pub fn velocity(&self, velocity: f64) -> f64 {
        velocity / self.turn()
    }

    /// Torque on the joint \[Nm\] of a current \[A\].
    pub fn torque(&self, current: f64) -> f64 {
        current * self.torque_constant * self.turn()
    }

    /// Current \[A\] that gives a torque on the joint \[Nm\], before any limit.
    pub fn current(&self, torque: f64) -> f64 {
        torque / (self.torque_constant * self.turn())
    }
}

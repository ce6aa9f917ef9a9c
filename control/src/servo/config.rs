//! What can be tuned about the servo.

use super::TakeOverConfig;
use ferntast_model::{JOINTS, ParameterError, check};
use serde::{Deserialize, Serialize};

/// Tuning of the servo. Limits of the arm itself (position, velocity, torque)
/// come from the arm's file. Every key may be left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ServoConfig {
    /// Step of the loop \[s\].
    pub period: f64,
    /// Silence of valid commands after which the arm pauses \[s\].
    pub command_watchdog: f64,
    /// Age of the newest measurement that is a fault \[s\].
    pub measurement_watchdog: f64,
    /// Oldest command that is acted on, by its stamp \[s\].
    pub command_age: f64,
    /// Tip commands below this are refused, x and y, base frame \[m\].
    pub workspace_lower: [f64; 2],
    /// Tip commands above this are refused, x and y, base frame \[m\].
    pub workspace_upper: [f64; 2],
    /// Speed of the commanded tip from one command to the next that counts as
    /// a jump \[m/s\].
    pub jump_speed: f64,
    /// Step between commands that is never a jump, however short the time
    /// between them \[m\]: frames that a jittery link bunches together.
    pub jump_slack: f64,
    /// Share of the arm's velocity limit that the setpoint uses \[-\].
    pub velocity_share: f64,
    /// Largest acceleration of the setpoint \[rad/s²\].
    pub acceleration_limit: [f64; JOINTS],
    /// Joint speed on the way from rest to the first command after enable or
    /// resume \[rad/s\].
    pub approach_speed: f64,
    /// Natural frequency ω of the tracker that smooths commands \[rad/s\].
    pub tracker_frequency: f64,
    /// Proportional gain k_P on the motor position \[Nm/rad\].
    pub stiffness: [f64; JOINTS],
    /// Largest torque of the proportional part \[Nm\]: bounds how hard the arm
    /// presses against what is in its way. Below the torque sensor's range.
    pub pressing_limit: [f64; JOINTS],
    /// Derivative gain k_D on the motor velocity \[Nm·s/rad\].
    pub damping: [f64; JOINTS],
    /// k_P while paused \[Nm/rad\].
    pub hold_stiffness: [f64; JOINTS],
    /// k_D while paused \[Nm·s/rad\].
    pub hold_damping: [f64; JOINTS],
    /// Share of the modelled friction that is fed forward \[-\].
    pub friction_compensation: f64,
    /// Setpoint speed below which the friction fed forward fades out \[rad/s\].
    pub friction_smoothing: f64,
    /// How far friction that was found elsewhere may be taken over.
    pub take_over: TakeOverConfig,
    /// How far beyond its limits a joint may be measured before that is a
    /// fault \[rad\].
    pub limit_margin: f64,
    /// Share of the arm's velocity limit above which a joint is too fast \[-\].
    pub overspeed_share: f64,
}

impl Default for ServoConfig {
    fn default() -> Self {
        ServoConfig {
            period: 1e-3,
            command_watchdog: 0.025,
            measurement_watchdog: 0.020,
            command_age: 0.020,
            workspace_lower: [-0.5, -0.5],
            workspace_upper: [0.5, 0.5],
            jump_speed: 4.0,
            jump_slack: 0.010,
            velocity_share: 1.0,
            acceleration_limit: [40.0, 40.0],
            approach_speed: 0.2,
            tracker_frequency: 80.0,
            stiffness: [8000.0, 8000.0],
            pressing_limit: [20.0, 20.0],
            damping: [100.0, 100.0],
            hold_stiffness: [1000.0, 1000.0],
            hold_damping: [40.0, 40.0],
            friction_compensation: 0.9,
            friction_smoothing: 0.01,
            take_over: TakeOverConfig::default(),
            limit_margin: 0.02,
            overspeed_share: 1.5,
        }
    }
}

impl ServoConfig {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, with key, value, bounds, unit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("period", self.period, 1e-4, 1e-2, "s")?;
        check("command_watchdog", self.command_watchdog, 0.005, 0.030, "s")?;
        check(
            "measurement_watchdog",
            self.measurement_watchdog,
            0.002,
            0.1,
            "s",
        )?;
        check("command_age", self.command_age, 0.002, 1.0, "s")?;
        for axis in 0..2 {
            let (lower, upper) = (self.workspace_lower[axis], self.workspace_upper[axis]);
            check(&format!("workspace_upper[{axis}]"), upper, -10.0, 10.0, "m")?;
            check(
                &format!("workspace_lower[{axis}]"),
                lower,
                -10.0,
                upper,
                "m",
            )?;
        }
        check("jump_speed", self.jump_speed, 0.01, 100.0, "m/s")?;
        check("jump_slack", self.jump_slack, 0.0, 0.1, "m")?;
        check("velocity_share", self.velocity_share, 0.01, 1.0, "-")?;
        check("approach_speed", self.approach_speed, 0.001, 10.0, "rad/s")?;
        check(
            "tracker_frequency",
            self.tracker_frequency,
            1.0,
            300.0,
            "rad/s",
        )?;
        for joint in 0..JOINTS {
            let key = |name: &str| format!("{name}[{joint}]");
            check(
                &key("acceleration_limit"),
                self.acceleration_limit[joint],
                0.1,
                1e4,
                "rad/s²",
            )?;
            for (name, value, unit) in [
                ("stiffness", self.stiffness[joint], "Nm/rad"),
                ("pressing_limit", self.pressing_limit[joint], "Nm"),
                ("damping", self.damping[joint], "Nm·s/rad"),
                ("hold_stiffness", self.hold_stiffness[joint], "Nm/rad"),
                ("hold_damping", self.hold_damping[joint], "Nm·s/rad"),
            ] {
                check(&key(name), value, 0.0, 1e6, unit)?;
            }
        }
        check(
            "friction_compensation",
            self.friction_compensation,
            0.0,
            1.0,
            "-",
        )?;
        check(
            "friction_smoothing",
            self.friction_smoothing,
            1e-5,
            1.0,
            "rad/s",
        )?;
        self.take_over
            .validate()
            .map_err(|error| error.within("take_over"))?;
        check("limit_margin", self.limit_margin, 0.0, 1.0, "rad")?;
        check("overspeed_share", self.overspeed_share, 1.0, 10.0, "-")
    }
}

//! What can be tuned about the servo.

use super::{ContactStopConfig, TakeOverConfig};
use ferntast_model::{JointCount, Joints, ParameterError, check, parameters};

parameters! {
    /// Tuning of the servo. Limits of the arm itself (position, velocity, torque)
    /// come from the arm's file. Every key may be left out. Lists have one entry
    /// for each joint; their defaults are for an arm of two.
    pub struct ServoConfig {
        /// Step of the loop \[s\].
        pub period: f64 [1e-4..=1e-2, "s"] = 1e-3,
        /// Silence of valid commands after which the arm pauses \[s\].
        pub command_watchdog: f64 [0.005..=0.030, "s"] = 0.024,
        /// Age of the newest measurement that is a fault \[s\].
        pub measurement_watchdog: f64 [0.002..=0.1, "s"] = 0.020,
        /// Oldest command that is acted on, by its stamp \[s\].
        pub command_age: f64 [0.002..=1.0, "s"] = 0.020,
        /// Tip commands below this are refused, x and y, base frame \[m\].
        pub workspace_lower: [f64; 2] = [-0.5, -0.5],
        /// Tip commands above this are refused, x and y, base frame \[m\].
        pub workspace_upper: [f64; 2] [-10.0..=10.0, "m"] = [0.5, 0.5],
        /// Speed of the commanded tip from one command to the next that counts as
        /// a jump \[m/s\].
        pub jump_speed: f64 [0.01..=100.0, "m/s"] = 4.0,
        /// Step between commands that is never a jump, however short the time
        /// between them \[m\]: frames that a jittery link bunches together.
        pub jump_slack: f64 [0.0..=0.1, "m"] = 0.010,
        /// Share of the arm's velocity limit that the setpoint uses \[-\].
        pub velocity_share: f64 [0.01..=1.0, "-"] = 1.0,
        /// Largest acceleration of the setpoint \[rad/s²\].
        pub acceleration_limit: Vec<f64> [0.1..=1e4, "rad/s²"] = vec![40.0, 40.0],
        /// Joint speed on the way from rest to the first command after enable or
        /// resume, where the hand is at rest \[rad/s\]; of a hand that moves the square of 0.8 times
        /// its speed is added to this one's square. What the arm runs into on that way it hits with some
        /// 100 N for each rad/s, stiff surface and gear of ROKVISS. After two seconds it
        /// grows, so that a hand that does not wait is caught.
        pub approach_speed: f64 [0.001..=10.0, "rad/s"] = 0.06,
        /// Natural frequency ω of the tracker that smooths commands \[rad/s\].
        pub tracker_frequency: f64 [1.0..=300.0, "rad/s"] = 80.0,
        /// Proportional gain k_P on the motor position \[Nm/rad\].
        pub stiffness: Vec<f64> [0.0..=1e6, "Nm/rad"] = vec![8000.0, 8000.0],
        /// Largest torque of the proportional part \[Nm\]: bounds how hard the arm
        /// presses against what is in its way. Below the torque sensor's range.
        pub pressing_limit: Vec<f64> [0.0..=1e6, "Nm"] = vec![20.0, 20.0],
        /// Derivative gain k_D on the motor velocity \[Nm·s/rad\].
        pub damping: Vec<f64> [0.0..=1e6, "Nm·s/rad"] = vec![100.0, 100.0],
        /// k_P while paused \[Nm/rad\].
        pub hold_stiffness: Vec<f64> [0.0..=1e6, "Nm/rad"] = vec![1000.0, 1000.0],
        /// k_D while paused \[Nm·s/rad\].
        pub hold_damping: Vec<f64> [0.0..=1e6, "Nm·s/rad"] = vec![40.0, 40.0],
        /// How it stops where the arm runs into something.
        pub contact_stop: ContactStopConfig [section] = ContactStopConfig::default(),
        /// How a paused arm lets go of what it presses against.
        pub release: ReleaseConfig [section] = ReleaseConfig::default(),
        /// Share of the modelled friction that is fed forward \[-\].
        pub friction_compensation: f64 [0.0..=1.0, "-"] = 0.9,
        /// Setpoint speed below which the friction fed forward fades out \[rad/s\].
        pub friction_smoothing: f64 [1e-5..=1.0, "rad/s"] = 0.01,
        /// How far friction that was found elsewhere may be taken over.
        pub take_over: TakeOverConfig [section] = TakeOverConfig::default(),
        /// How far beyond its limits a joint may be measured before that is a
        /// fault \[rad\].
        pub limit_margin: f64 [0.0..=1.0, "rad"] = 0.02,
        /// Share of the arm's velocity limit above which a joint is too fast \[-\].
        pub overspeed_share: f64 [1.0..=10.0, "-"] = 1.5,
    }
    check ServoConfig::workspace_is_not_empty;
}

parameters! {
    /// How a paused joint lets go of what it presses against. Every key may be left out.
    #[derive(Copy)]
    pub struct ReleaseConfig {
        /// Torque that it keeps \[Nm\]: above the noise and the zero error of its sensor.
        pub torque: f64 [0.01..=1e3, "Nm"] = 0.7,
        /// How fast it gives way \[rad/s\].
        pub speed: f64 [0.001..=1.0, "rad/s"] = 0.15,
        /// How far at most \[rad\]; 0: it keeps what it presses with.
        pub distance: f64 [0.0..=0.2, "rad"] = 0.02,
    }
}

/// What is tuned joint by joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTuning {
    /// Largest acceleration of the setpoint \[rad/s²\].
    pub acceleration_limit: f64,
    /// Proportional gain k_P on the motor position \[Nm/rad\].
    pub stiffness: f64,
    /// Largest torque of the proportional part \[Nm\].
    pub pressing_limit: f64,
    /// Derivative gain k_D on the motor velocity \[Nm·s/rad\].
    pub damping: f64,
    /// k_P while paused \[Nm/rad\].
    pub hold_stiffness: f64,
    /// k_D while paused \[Nm·s/rad\].
    pub hold_damping: f64,
}

impl ServoConfig {
    /// The tuning of each of `count` joints.
    ///
    /// # Errors
    ///
    /// [`ParameterError::WrongCount`]: a list has not one entry for each joint.
    pub fn joints(&self, count: JointCount) -> Result<Joints<JointTuning>, ParameterError> {
        let lists = [
            ("acceleration_limit", &self.acceleration_limit),
            ("stiffness", &self.stiffness),
            ("pressing_limit", &self.pressing_limit),
            ("damping", &self.damping),
            ("hold_stiffness", &self.hold_stiffness),
            ("hold_damping", &self.hold_damping),
        ];
        for (key, list) in lists {
            count.check(key, list.len())?;
        }
        Ok(Joints::from_fn(count, |joint| JointTuning {
            acceleration_limit: self.acceleration_limit[joint],
            stiffness: self.stiffness[joint],
            pressing_limit: self.pressing_limit[joint],
            damping: self.damping[joint],
            hold_stiffness: self.hold_stiffness[joint],
            hold_damping: self.hold_damping[joint],
        }))
    }

    fn workspace_is_not_empty(&self) -> Result<(), ParameterError> {
        for (axis, upper) in self.workspace_upper.into_iter().enumerate() {
            let key = format!("workspace_lower[{axis}]");
            check(&key, self.workspace_lower[axis], -10.0, upper, "m")?;
        }
        Ok(())
    }
}

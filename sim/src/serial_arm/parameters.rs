//! What is true of a simulated serial arm: the section `[truth]` of its file.

use ferntast_model::{ParameterError, parameters};

use super::world::ObjectParameters;
use crate::arm::{SensorParameters, ThermalParameters, TorqueSensorErrors, TrueFriction};

parameters! {
    /// True properties of a simulated serial arm; nobody but the simulation reads them.
    pub struct SerialArmParameters {
        /// Longest step of the integration \[s\]. Left out, it is the longest that resolves
        /// the contacts, half a millisecond at most.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub substep: Option<f64> [1e-6..=1e-3, "s"] = None,
        /// Joint positions at the start \[rad\] or \[m\]; zero where left out.
        pub start_position: Vec<f64> [-100.0..=100.0, "rad or m"] = Vec::new(),
        /// Acceleration of gravity in the base frame \[m/s²\].
        pub gravity: [f64; 3] [-100.0..=100.0, "m/s²"] = [0.0, 0.0, -9.80665],
        /// Temperature of the surroundings \[degC\].
        pub temperature: f64 [-150.0..=150.0, "degC"] = 20.0,
        /// Radius of the ball at the tip that touches things \[m\]; zero is a point.
        pub tip_radius: f64 [0.0..=1.0, "m"] = 0.0,
        /// One for each joint, or one for all, or none: ideal drives and sensors.
        pub joint: Vec<SerialJointParameters> [section] = Vec::new(),
        /// What there is to touch.
        pub object: Vec<ObjectParameters> [section] = Vec::new(),
    }
}

parameters! {
    /// True properties of one joint, joint side of the gear. Left out, a drive is
    /// rigid and free of friction, and sensors give what is true.
    pub struct SerialJointParameters {
        /// Inertia of motor and gear \[kg m²\] or \[kg\]; that of the arm's chain where left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub motor_inertia: Option<f64> [0.0..=1000.0, "kg m²"] = None,
        /// Motor turns per joint turn \[-\], or motor \[rad\] per joint \[m\].
        pub gear_ratio: f64 [1.0..=1e5, "-"] = 100.0,
        /// Stiffness of gear and torque sensor \[Nm/rad\] or \[N/m\]; rigid where left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub stiffness: Option<f64> [1.0..=1e9, "Nm/rad"] = None,
        /// Damping of the same \[Nm·s/rad\] or \[N·s/m\].
        pub damping: f64 [0.0..=1e5, "Nm·s/rad"] = 0.0,
        /// k_m: motor current per motor torque, at the motor \[A/Nm\].
        pub motor_constant: f64 [1e-3..=1e4, "A/Nm"] = 10.0,
        /// k_m as the drive believes it \[A/Nm\]; as it is where left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub believed_motor_constant: Option<f64> [1e-3..=1e4, "A/Nm"] = None,
        /// Largest motor torque of the drive \[Nm\] or \[N\]; that of the arm where left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub motor_torque_limit: Option<f64> [0.0..=1e6, "Nm"] = None,
        /// Range of the torque sensor: ± \[Nm\] or \[N\].
        pub torque_sensor_range: f64 [0.01..=1e6, "Nm"] = 1e6,
        /// Friction on the motor's side of the gear.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub friction: Option<TrueFriction> [section] = None,
        /// Encoder, torque sensor and current measurement; ideal where left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub sensor: Option<SensorParameters> [section] = None,
        /// How the gear warms up; it keeps the temperature of its surroundings where left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub thermal: Option<ThermalParameters> [section] = None,
    }
}

impl SerialJointParameters {
    pub(super) fn sensor(&self) -> SensorParameters {
        self.sensor.unwrap_or(SensorParameters {
            encoder_counts: 1e9,
            velocity_time_constant: 0.0,
            torque_noise: 0.0,
            torque_step: 0.0,
            current_noise: 0.0,
            current_step: 0.0,
            torque_errors: None,
        })
    }

    pub(super) fn torque_errors(&self) -> TorqueSensorErrors {
        let sensor = self.sensor.as_ref();
        sensor
            .and_then(|sensor| sensor.torque_errors)
            .unwrap_or_default()
    }
}

impl SerialArmParameters {
    /// What is true of each of `count` joints.
    pub(super) fn joints(
        &self,
        count: usize,
    ) -> Result<Vec<SerialJointParameters>, ParameterError> {
        match &self.joint[..] {
            [] => Ok(vec![SerialJointParameters::default(); count]),
            [all] => Ok(vec![all.clone(); count]),
            each if each.len() == count => Ok(each.to_vec()),
            each => Err(ParameterError::WrongCount {
                key: "joint".into(),
                found: each.len(),
                wanted: count,
                each: "joint of the arm, or a single one for all",
            }),
        }
    }
}

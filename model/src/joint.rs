//! A flexible joint as it is believed: motor, gear, elasticity, sensor, limits.

use crate::friction::FrictionParameters;
use crate::{ParameterError, parameters};

parameters! {
    /// Parameters of one joint, on the joint side of the gear unless they say otherwise.
    pub struct JointParameters {
        /// J of equation (2): motor, gear and link up to the torque sensor, joint side \[kg m²\].
        pub motor_inertia: f64 [1e-4..=1000.0, "kg m²"],
        /// Motor turns per joint turn \[-\].
        pub gear_ratio: f64 [1.0..=1e4, "-"],
        /// Stiffness K of flex spline and torque sensor together \[Nm/rad\].
        pub stiffness: f64 [10.0..=1e6, "Nm/rad"],
        /// Damping of the same \[Nm·s/rad\].
        pub damping: f64 [0.0..=1e4, "Nm·s/rad"],
        /// k_m of equation (1), at the motor: current per motor torque \[A/Nm\].
        pub motor_constant: f64 [1e-3..=1e4, "A/Nm"],
        /// Largest motor torque of the drive, joint side \[Nm\].
        pub motor_torque_limit: f64 [0.01..=1e4, "Nm"],
        /// Range of the torque sensor: ± \[Nm\].
        pub torque_sensor_range: f64 [0.01..=1e4, "Nm"],
        /// Lower end of the joint's range \[rad\].
        pub position_lower: f64 [-6.3..=6.3, "rad"],
        /// Upper end of the joint's range \[rad\].
        pub position_upper: f64 [-6.3..=6.3, "rad"],
        /// Largest speed allowed \[rad/s\].
        pub velocity_limit: f64 [0.01..=100.0, "rad/s"],
        /// Friction, equations (3), (4).
        pub friction: FrictionParameters [section],
    }
    check JointParameters::range_is_not_empty;
}

impl JointParameters {
    fn range_is_not_empty(&self) -> Result<(), ParameterError> {
        if self.position_lower < self.position_upper {
            return Ok(());
        }
        Err(ParameterError::Inconsistent {
            key: "position_lower".into(),
            reason: format!(
                "{} rad is not below position_upper = {} rad; swap or correct them",
                self.position_lower, self.position_upper
            ),
        })
    }

    /// Motor torque τ_m on the joint side \[Nm\] from the motor current I \[A\]:
    /// equation (1), τ_m = k_m⁻¹ I, times the gear ratio.
    pub fn motor_torque(&self, current: f64) -> f64 {
        self.gear_ratio * current / self.motor_constant
    }

    /// Motor current I \[A\] for a motor torque on the joint side \[Nm\]; equation (1).
    pub fn motor_current(&self, motor_torque: f64) -> f64 {
        motor_torque * self.motor_constant / self.gear_ratio
    }

    /// How far the gear is wound, δ = θ − q \[rad\], under the joint torque τ = K δ + D δ̇
    /// \[Nm\], `dt` \[s\] after it was wound by `before` \[rad\]: an implicit Euler step, which
    /// is stable at any step and, as slow torques go, as late as δ is behind τ/K, D/K.
    pub fn wound(&self, before: f64, joint_torque: f64, dt: f64) -> f64 {
        (self.damping * before + joint_torque * dt) / (self.damping + self.stiffness * dt)
    }

    /// Link-side position q = θ − τ/K \[rad\] from the motor position θ
    /// \[rad\] and the joint torque τ \[Nm\], at rest.
    pub fn link_position(&self, motor_position: f64, joint_torque: f64) -> f64 {
        motor_position - joint_torque / self.stiffness
    }

    /// Motor position θ \[rad\] that holds the link at `link_position` \[rad\]
    /// under the joint torque τ \[Nm\].
    pub fn motor_position(&self, link_position: f64, joint_torque: f64) -> f64 {
        link_position + joint_torque / self.stiffness
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::FrictionParameters;

    fn joint(damping: f64) -> JointParameters {
        JointParameters {
            motor_inertia: 0.5,
            gear_ratio: 160.0,
            stiffness: 4900.0,
            damping,
            motor_constant: 10.0,
            motor_torque_limit: 80.0,
            torque_sensor_range: 40.0,
            position_lower: -1.0,
            position_upper: 1.0,
            velocity_limit: 1.0,
            friction: FrictionParameters {
                speed_range: [0.0, 1.0],
                effects: Default::default(),
            },
        }
    }

    #[test]
    fn a_gear_without_damping_is_wound_by_its_torque_at_once() {
        let wound = joint(0.0).wound(0.3, 9.8, 1e-3);
        assert!((wound - 0.002).abs() < 1e-15);
    }

    /// At 20 Hz, with 1 kHz of samples: τ/K alone is wrong by D ω/K, 5 %.
    #[test]
    fn damping_does_not_wind_it() {
        let (joint, rate, dt) = (joint(2.0), 40.0 * std::f64::consts::PI, 1e-3);
        let torque = |t: f64| {
            let (sine, cosine) = (rate * t).sin_cos();
            joint.stiffness * sine + joint.damping * rate * cosine
        };
        let (mut wound, mut worst, mut plain) = (0.0, 0.0_f64, 0.0_f64);
        for k in 1..1000 {
            let t = dt * f64::from(k);
            wound = joint.wound(wound, torque(t), dt);
            worst = worst.max((wound - (rate * t).sin()).abs());
            plain = plain.max((torque(t) / joint.stiffness - (rate * t).sin()).abs());
        }
        assert!(
            (0.04..0.06).contains(&plain) && worst < 0.01,
            "{plain} {worst}"
        );
    }
}

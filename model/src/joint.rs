//! A flexible joint as it is believed: motor, gear, elasticity, sensor, limits.

use crate::friction::FrictionParameters;
use crate::{ParameterError, check};
use serde::{Deserialize, Serialize};

/// Parameters of one joint, on the joint side of the gear unless they say otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointParameters {
    /// J of equation (2): motor, gear and link up to the torque sensor, joint side \[kg m²\].
    pub motor_inertia: f64,
    /// Motor turns per joint turn \[-\].
    pub gear_ratio: f64,
    /// Stiffness K of flex spline and torque sensor together \[Nm/rad\].
    pub stiffness: f64,
    /// Damping of the same \[Nm·s/rad\].
    pub damping: f64,
    /// k_m of equation (1), at the motor: current per motor torque \[A/Nm\].
    pub motor_constant: f64,
    /// Largest motor torque of the drive, joint side \[Nm\].
    pub motor_torque_limit: f64,
    /// Range of the torque sensor: ± \[Nm\].
    pub torque_sensor_range: f64,
    /// Lower end of the joint's range \[rad\].
    pub position_lower: f64,
    /// Upper end of the joint's range \[rad\].
    pub position_upper: f64,
    /// Largest speed allowed \[rad/s\].
    pub velocity_limit: f64,
    /// Friction, equations (3), (4).
    pub friction: FrictionParameters,
}

impl JointParameters {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("motor_inertia", self.motor_inertia, 1e-4, 1000.0, "kg m²")?;
        check("gear_ratio", self.gear_ratio, 1.0, 10_000.0, "-")?;
        check("stiffness", self.stiffness, 10.0, 1e6, "Nm/rad")?;
        check("damping", self.damping, 0.0, 1e4, "Nm·s/rad")?;
        check("motor_constant", self.motor_constant, 1e-3, 1e4, "A/Nm")?;
        check(
            "motor_torque_limit",
            self.motor_torque_limit,
            0.01,
            1e4,
            "Nm",
        )?;
        check(
            "torque_sensor_range",
            self.torque_sensor_range,
            0.01,
            1e4,
            "Nm",
        )?;
        check("position_lower", self.position_lower, -6.3, 6.3, "rad")?;
        check("position_upper", self.position_upper, -6.3, 6.3, "rad")?;
        check("velocity_limit", self.velocity_limit, 0.01, 100.0, "rad/s")?;
        if self.position_lower >= self.position_upper {
            return Err(ParameterError::Inconsistent {
                key: "position_lower".into(),
                reason: format!(
                    "{} rad is not below position_upper = {} rad; swap or mend them",
                    self.position_lower, self.position_upper
                ),
            });
        }
        self.friction
            .validate()
            .map_err(|error| error.within("friction"))
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

    /// Link-side position q = θ − τ/K \[rad\] from the motor position θ
    /// \[rad\] and the joint torque τ \[Nm\].
    pub fn link_position(&self, motor_position: f64, joint_torque: f64) -> f64 {
        motor_position - joint_torque / self.stiffness
    }

    /// Motor position θ \[rad\] that holds the link at `link_position` \[rad\]
    /// under the joint torque τ \[Nm\].
    pub fn motor_position(&self, link_position: f64, joint_torque: f64) -> f64 {
        link_position + joint_torque / self.stiffness
    }
}

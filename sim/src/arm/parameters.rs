//! Configuration of the simulated arm: a file in `config/arms/`.

use super::contact::TrueSurface;
use super::elasticity::Elasticity;
use super::environment::{Environment, GroundParameters};
use super::friction::TrueFriction;
use super::sensors::SensorParameters;
use super::thermal::ThermalParameters;
use ferntast_control::estimator::EstimatorParameters;
use ferntast_model::arm::{Arm, ArmParameters};
use ferntast_model::contour::Contour;
use ferntast_model::joint::JointParameters;
use ferntast_model::{ArmModel, JOINTS, Matrix2, ParameterError, Vector2, check};
use serde::{Deserialize, Serialize};

/// A whole file of `config/arms/`: what is believed of the arm, and what is
/// true of the simulated one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmConfig {
    /// Links and gravity.
    pub arm: ArmParameters,
    /// Joint 1 and joint 2 as they are believed.
    pub joint: [JointParameters; JOINTS],
    /// Edges and springs.
    pub contour: Contour,
    /// Contact-force estimator.
    pub estimator: EstimatorParameters,
    /// What the simulated arm really is like.
    pub truth: TruthParameters,
    /// What is different on the ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground: Option<GroundParameters>,
}

impl ArmConfig {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, with key, value, bounds, unit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.model().validate()?;
        self.estimator
            .validate()
            .map_err(|error| error.within("estimator"))?;
        self.truth
            .validate()
            .map_err(|error| error.within("truth"))?;
        if let Some(ground) = &self.ground {
            ground.validate().map_err(|error| error.within("ground"))?;
        }
        self.check_substep()
    }

    /// The fastest vibration must be resolved: h ω ≤ 1/2, where 2 is where the
    /// integration breaks down.
    fn check_substep(&self) -> Result<(), ParameterError> {
        let truth = &self.truth;
        let links = truth.arm.as_ref().unwrap_or(&self.arm);
        let contour = truth.contour.as_ref().unwrap_or(&self.contour);
        let surfaces = truth.surface;
        let heads = contour
            .spring
            .iter()
            .map(|spring| surfaces.spring.surface(spring.stiffness));
        let surface = [surfaces.lubricated, surfaces.unlubricated]
            .into_iter()
            .chain(heads)
            .map(|s| s.stiffness.max(s.tangential_stiffness))
            .fold(0.0, f64::max);
        let gear = truth.joint.iter().map(TrueJoint::largest_stiffness);
        let gear = Matrix2::identity() * gear.fold(0.0, f64::max);
        let arm = Arm::new(links);
        let joints = truth
            .joint
            .iter()
            .map(|joint| joint.largest_stiffness() / joint.motor_inertia);
        // Stretched to folded, with a surface that pushes along normal and tangent.
        let square = (0..=16)
            .map(|step| {
                let q = Vector2::new(0.0, f64::from(step) / 16.0 * std::f64::consts::PI);
                let jacobian = arm.kinematics().jacobian(&q);
                let stiffness = gear + jacobian.tr_mul(&jacobian) * surface;
                let inverse = arm.inertia(&q).try_inverse().unwrap_or_else(Matrix2::zeros);
                // The trace bounds the largest eigenvalue.
                (inverse * stiffness).trace()
            })
            .chain(joints)
            .fold(0.0, f64::max);
        let longest = 0.5 / square.sqrt();
        if truth.substep <= longest {
            return Ok(());
        }
        Err(ParameterError::Inconsistent {
            key: "truth.substep".into(),
            reason: format!(
                "{} s does not resolve the fastest vibration of these stiffnesses and inertias; \
                 set it to {longest:.1e} s or less",
                truth.substep
            ),
        })
    }

    /// What servo and estimator believe.
    pub fn model(&self) -> ArmModel {
        ArmModel {
            arm: self.arm,
            joint: self.joint.clone(),
            contour: self.contour.clone(),
        }
    }
}

/// True properties of the simulated arm; nobody but the simulation reads them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TruthParameters {
    /// Longest step of the integration \[s\].
    pub substep: f64,
    /// Joint positions at the start \[rad\].
    pub start_position: [f64; JOINTS],
    /// Date, sun and temperature.
    pub environment: Environment,
    /// The links, where they are not as `[arm]` says.
    #[serde(default)]
    pub arm: Option<ArmParameters>,
    /// The contour, where it is not as `[contour]` says.
    #[serde(default)]
    pub contour: Option<Contour>,
    /// The surfaces.
    pub surface: TrueSurfaces,
    /// Joint 1 and joint 2.
    pub joint: [TrueJoint; JOINTS],
}

/// True properties of the three kinds of surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrueSurfaces {
    /// Edge with dry-film lubricant.
    pub lubricated: TrueSurface,
    /// Edge of bare aluminium.
    pub unlubricated: TrueSurface,
    /// Heads of springs.
    pub spring: TrueSpringHead,
}

/// True properties of the head of a spring; its stiffness is the spring's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrueSpringHead {
    /// Damping along the normal \[N·s/m\].
    pub damping: f64,
    /// Coulomb coefficient \[-\].
    pub friction: f64,
    /// Stiffness of the bristle \[N/m\].
    pub tangential_stiffness: f64,
    /// Damping of the bristle \[N·s/m\].
    pub tangential_damping: f64,
}

impl TrueSpringHead {
    /// The head of a spring of `stiffness` \[N/m\] as a surface.
    pub fn surface(&self, stiffness: f64) -> TrueSurface {
        TrueSurface {
            stiffness,
            damping: self.damping,
            friction: self.friction,
            tangential_stiffness: self.tangential_stiffness,
            tangential_damping: self.tangential_damping,
            wear: None,
        }
    }
}

/// True properties of one joint, joint side of the gear unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrueJoint {
    /// Inertia J of motor and gear \[kg m²\].
    pub motor_inertia: f64,
    /// Motor turns per joint turn \[-\].
    pub gear_ratio: f64,
    /// Stiffness of flex spline and torque sensor \[Nm/rad\].
    pub stiffness: f64,
    /// Cubic stiffness K₃: τ = K (θ − q) + K₃ (θ − q)³ \[Nm/rad³\]; zero when left out.
    #[serde(default)]
    pub cubic_stiffness: f64,
    /// Damping of the same \[Nm·s/rad\].
    pub damping: f64,
    /// k_m of equation (1), at the motor \[A/Nm\].
    pub motor_constant: f64,
    /// Largest motor torque of the drive \[Nm\].
    pub motor_torque_limit: f64,
    /// Range of the torque sensor: ± \[Nm\].
    pub torque_sensor_range: f64,
    /// Friction of the gear.
    pub friction: TrueFriction,
    /// Sensors.
    pub sensor: SensorParameters,
    /// Temperature.
    pub thermal: ThermalParameters,
}

impl TrueJoint {
    /// The joint's elasticity.
    pub(super) fn elasticity(&self) -> Elasticity {
        Elasticity {
            stiffness: self.stiffness,
            cubic_stiffness: self.cubic_stiffness,
        }
    }

    /// Slope of its torque at the end of the torque sensor's range \[Nm/rad\].
    fn largest_stiffness(&self) -> f64 {
        let wound = self.elasticity().wound_by(self.torque_sensor_range);
        self.stiffness + 3.0 * self.cubic_stiffness * wound * wound
    }

    fn validate(&self) -> Result<(), ParameterError> {
        check("motor_inertia", self.motor_inertia, 1e-2, 1000.0, "kg m²")?;
        check("gear_ratio", self.gear_ratio, 1.0, 10_000.0, "-")?;
        check("stiffness", self.stiffness, 10.0, 1e5, "Nm/rad")?;
        check("cubic_stiffness", self.cubic_stiffness, 0.0, 1e9, "Nm/rad³")?;
        check("damping", self.damping, 0.0, 100.0, "Nm·s/rad")?;
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
        let within = |section: &'static str| move |error: ParameterError| error.within(section);
        self.friction.validate().map_err(within("friction"))?;
        self.sensor.validate().map_err(within("sensor"))?;
        self.thermal.validate().map_err(within("thermal"))
    }
}

impl TruthParameters {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("substep", self.substep, 1e-6, 5e-4, "s")?;
        check(
            "start_position[0]",
            self.start_position[0],
            -6.3,
            6.3,
            "rad",
        )?;
        check(
            "start_position[1]",
            self.start_position[1],
            -6.3,
            6.3,
            "rad",
        )?;
        self.environment
            .validate()
            .map_err(|error| error.within("environment"))?;
        if let Some(arm) = &self.arm {
            arm.validate().map_err(|error| error.within("arm"))?;
        }
        if let Some(contour) = &self.contour {
            contour
                .validate()
                .map_err(|error| error.within("contour"))?;
        }
        for (name, surface) in [
            ("surface.lubricated", &self.surface.lubricated),
            ("surface.unlubricated", &self.surface.unlubricated),
            // The springs' stiffnesses are checked with the contour.
            ("surface.spring", &self.surface.spring.surface(1.0)),
        ] {
            surface.validate().map_err(|error| error.within(name))?;
        }
        for (index, joint) in self.joint.iter().enumerate() {
            joint
                .validate()
                .map_err(|error| error.within(&format!("joint[{index}]")))?;
        }
        Ok(())
    }
}

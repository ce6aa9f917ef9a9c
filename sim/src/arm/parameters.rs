//! Configuration of the simulated arm: a file in `config/arms/`.

use super::JOINTS;
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
use ferntast_model::{ArmModel, Matrix2, ParameterError, Vector2, parameters};

parameters! {
    /// A whole file of `config/arms/`: what is believed of the arm, and what is
    /// true of the simulated one.
    pub struct ArmConfig {
        /// Links and gravity.
        pub arm: ArmParameters [section],
        /// The joints as they are believed, from the base on: one for each link.
        pub joint: Vec<JointParameters> [section],
        /// Edges and springs.
        pub contour: Contour [section],
        /// Contact-force estimator.
        pub estimator: EstimatorParameters [section],
        /// What the simulated arm really is like.
        pub truth: TruthParameters [section],
        /// What is different on the ground.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub ground: Option<GroundParameters> [section],
    }
    check ArmConfig::is_consistent;
}

impl ArmConfig {
    fn is_consistent(&self) -> Result<(), ParameterError> {
        self.arm.joints_of_links(&self.joint)?;
        self.substep_resolves_vibration()
    }

    /// h ω ≤ 1/2 for the fastest vibration; the integration breaks down at 2.
    fn substep_resolves_vibration(&self) -> Result<(), ParameterError> {
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

parameters! {
    /// True properties of the simulated arm; nobody but the simulation reads them.
    pub struct TruthParameters {
        /// Longest step of the integration \[s\].
        pub substep: f64 [1e-6..=5e-4, "s"],
        /// Joint positions at the start \[rad\].
        pub start_position: [f64; JOINTS] [-6.3..=6.3, "rad"],
        /// Date, sun and temperature.
        pub environment: Environment [section],
        /// The links, where they are not as `[arm]` says.
        #[serde(default)]
        pub arm: Option<ArmParameters> [section],
        /// The contour, where it is not as `[contour]` says.
        #[serde(default)]
        pub contour: Option<Contour> [section],
        /// The surfaces.
        pub surface: TrueSurfaces [section],
        /// Joint 1 and joint 2.
        pub joint: [TrueJoint; JOINTS] [section],
    }
}

parameters! {
    /// True properties of the three kinds of surface.
    #[derive(Copy)]
    pub struct TrueSurfaces {
        /// Edge with dry-film lubricant.
        pub lubricated: TrueSurface [section],
        /// Edge of bare aluminium.
        pub unlubricated: TrueSurface [section],
        /// Heads of springs.
        pub spring: TrueSpringHead [section],
    }
}

parameters! {
    /// True properties of the head of a spring; its stiffness is the spring's.
    #[derive(Copy)]
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
    check TrueSpringHead::makes_a_surface;
}

impl TrueSpringHead {
    /// The spring's stiffness is checked with the contour.
    fn makes_a_surface(&self) -> Result<(), ParameterError> {
        self.surface(1.0).validate()
    }

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

parameters! {
    /// True properties of one joint, joint side of the gear unless said otherwise.
    #[derive(Copy)]
    pub struct TrueJoint {
        /// Inertia J of motor and gear \[kg m²\].
        pub motor_inertia: f64 [1e-2..=1000.0, "kg m²"],
        /// Motor turns per joint turn \[-\].
        pub gear_ratio: f64 [1.0..=1e4, "-"],
        /// Stiffness of flex spline and torque sensor \[Nm/rad\].
        pub stiffness: f64 [10.0..=1e5, "Nm/rad"],
        /// Cubic stiffness K₃: τ = K (θ − q) + K₃ (θ − q)³ \[Nm/rad³\]; zero when left out.
        #[serde(default)]
        pub cubic_stiffness: f64 [0.0..=1e9, "Nm/rad³"],
        /// Damping of the same \[Nm·s/rad\].
        pub damping: f64 [0.0..=100.0, "Nm·s/rad"],
        /// k_m of equation (1), at the motor \[A/Nm\].
        pub motor_constant: f64 [1e-3..=1e4, "A/Nm"],
        /// Largest motor torque of the drive \[Nm\].
        pub motor_torque_limit: f64 [0.01..=1e4, "Nm"],
        /// Range of the torque sensor: ± \[Nm\].
        pub torque_sensor_range: f64 [0.01..=1e4, "Nm"],
        /// Friction of the gear.
        pub friction: TrueFriction [section],
        /// Sensors.
        pub sensor: SensorParameters [section],
        /// Temperature.
        pub thermal: ThermalParameters [section],
    }
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
}

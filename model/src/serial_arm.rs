//! A serial arm of any joints as it is believed, and the surfaces that its tip can touch.
//!
//! ROKVISS's planar arm is an [`ArmModel`](crate::ArmModel) in closed form; any other arm is
//! a [`Chain`] with joints, gravity and planes.

use crate::joint::JointParameters;
use crate::rigid_body::{Chain, MassMatrix, Placement, PositionLimits, Posture, Vector3};
use crate::{JointCount, Joints, ParameterError, check, parameters};

parameters! {
    /// A plane that the tip can touch: the section `[[surface]]` of an arm's file.
    pub struct Plane {
        /// What it is called.
        pub name: String,
        /// A point of it, base frame \[m\].
        pub point: [f64; 3] [-10.0..=10.0, "m"],
        /// Its direction towards the free side, base frame \[-\]; the length does not matter.
        pub normal: [f64; 3] [-1e3..=1e3, "-"],
        /// Stiffness along the normal \[N/m\].
        #[serde(default = "default_stiffness")]
        pub stiffness: f64 [1.0..=1e7, "N/m"],
        /// Damping along the normal \[N·s/m\].
        #[serde(default = "default_damping")]
        pub damping: f64 [0.0..=1e5, "N·s/m"],
        /// Coefficient of friction, equation (6) \[-\].
        #[serde(default = "default_friction")]
        pub friction: f64 [0.0..=5.0, "-"],
    }
    check Plane::normal_is_a_direction;
}

/// So many joints turn a tool as one likes wherever its tip is.
const JOINTS_OF_POSE: usize = 6;

fn default_stiffness() -> f64 {
    2e4
}

fn default_damping() -> f64 {
    100.0
}

fn default_friction() -> f64 {
    0.3
}

impl Plane {
    fn normal_is_a_direction(&self) -> Result<(), ParameterError> {
        let length = Vector3::from(self.normal).norm();
        check("normal (its length)", length, 1e-6, 2e3, "-")
    }

    /// Unit vector towards the free side, base frame.
    pub fn direction(&self) -> Vector3<f64> {
        Vector3::from(self.normal).normalize()
    }

    /// How far `tip` \[m\] is from it; negative behind it.
    pub fn distance(&self, tip: &Vector3<f64>) -> f64 {
        self.direction().dot(&(tip - Vector3::from(self.point)))
    }
}

/// What is believed of a serial arm and of what its tip can touch.
#[derive(Clone, Debug)]
pub struct SerialArm {
    chain: Chain,
    joints: Vec<JointParameters>,
    gravity: Vector3<f64>,
    home: Joints<f64>,
    surfaces: Vec<Plane>,
}

impl SerialArm {
    /// The arm of the links `chain`, whose armatures and ends do not count: the motors'
    /// inertias are those of `joints`, on their side of the torque sensors, and so are the
    /// ends. `gravity` \[m/s²\] is in the
    /// base frame; `home` \[rad\] or \[m\] is where it likes to be.
    ///
    /// # Errors
    ///
    /// Lists that have not one entry for each joint, a value out of its bounds, a home
    /// outside the joints' ranges.
    pub fn new(
        chain: Chain,
        joints: Vec<JointParameters>,
        gravity: [f64; 3],
        home: &[f64],
        surfaces: Vec<Plane>,
    ) -> Result<SerialArm, ParameterError> {
        let count = chain.count();
        count.check("joint", joints.len())?;
        count.check("arm.home", home.len())?;
        for (index, joint) in joints.iter().enumerate() {
            let within = |error: ParameterError| error.within(&format!("joint[{index}]"));
            joint.validate().map_err(within)?;
            let (lower, upper) = (joint.position_lower, joint.position_upper);
            check(
                &format!("arm.home[{index}]"),
                home[index],
                lower,
                upper,
                "rad",
            )?;
        }
        for value in gravity {
            check("arm.gravity", value, -20.0, 20.0, "m/s²")?;
        }
        for (index, surface) in surfaces.iter().enumerate() {
            let within = |error: ParameterError| error.within(&format!("surface[{index}]"));
            surface.validate().map_err(within)?;
        }
        let bare = Joints::filled(count, 0.0);
        let limits = Joints::from_fn(count, |joint| PositionLimits {
            lower: joints[joint].position_lower,
            upper: joints[joint].position_upper,
        });
        let chain = chain
            .with_armature(&bare)
            .and_then(|own| own.with_limits(&limits));
        let chain = chain.map_err(|error| ParameterError::Inconsistent {
            key: "joint".into(),
            reason: error.to_string(),
        })?;
        Ok(SerialArm {
            chain,
            joints,
            gravity: gravity.into(),
            home: Joints::from_slice(home)?,
            surfaces,
        })
    }

    /// How many joints it has.
    pub fn count(&self) -> JointCount {
        self.chain.count()
    }

    /// Whether it has the joints to turn its tool as it likes wherever its tip is: six or more.
    pub fn turns_tool(&self) -> bool {
        self.count().get() >= JOINTS_OF_POSE
    }

    /// Its links: what is behind the torque sensors, without motors.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Its joints, from the base on.
    pub fn joints(&self) -> &[JointParameters] {
        &self.joints
    }

    /// Acceleration of gravity, base frame \[m/s²\].
    pub fn gravity(&self) -> &Vector3<f64> {
        &self.gravity
    }

    /// Where it likes to be \[rad\] or \[m\].
    pub fn home(&self) -> &Joints<f64> {
        &self.home
    }

    /// The tip's frame there.
    pub fn home_tip(&self) -> Placement {
        self.chain.forward(&self.home)
    }

    /// What its tip can touch.
    pub fn surfaces(&self) -> &[Plane] {
        &self.surfaces
    }

    /// What the joints carry of the links' weight at `q` \[rad\] or \[m\]: \[Nm\] or \[N\].
    ///
    /// # Panics
    ///
    /// `q` has not one value for each joint.
    pub fn weight(&self, q: &Joints<f64>) -> Joints<f64> {
        self.weight_in(&self.chain.posture(q))
    }

    /// [`weight`](Self::weight) in a posture of its links.
    pub fn weight_in(&self, posture: &Posture) -> Joints<f64> {
        self.chain.weight_in(posture, &self.gravity)
    }

    /// Joint torques that the links' motion q, q̇, q̈ takes without contact.
    ///
    /// # Panics
    ///
    /// A list has not one value for each joint.
    pub fn inverse_dynamics(
        &self,
        q: &Joints<f64>,
        qd: &Joints<f64>,
        qdd: &Joints<f64>,
    ) -> Joints<f64> {
        self.inverse_dynamics_in(&self.chain.posture(q), qd, qdd)
    }

    /// [`inverse_dynamics`](Self::inverse_dynamics) in a posture of its links.
    ///
    /// # Panics
    ///
    /// A list has not one value for each joint.
    pub fn inverse_dynamics_in(
        &self,
        posture: &Posture,
        qd: &Joints<f64>,
        qdd: &Joints<f64>,
    ) -> Joints<f64> {
        self.chain
            .inverse_dynamics_in(posture, qd, qdd, &self.gravity)
    }

    /// Momentum M(q) q̇ of the links \[kg m²/s\] or \[kg m/s\].
    ///
    /// # Panics
    ///
    /// A list has not one value for each joint.
    pub fn momentum_at(&self, q: &Joints<f64>, qd: &Joints<f64>) -> Joints<f64> {
        let mass = self.chain.mass_matrix(q);
        Joints::from_fn(q.count(), |row| {
            let each = qd.iter().enumerate();
            each.map(|(column, speed)| mass[(row, column)] * speed)
                .sum()
        })
    }

    /// Mass matrix of links and motors at `q`, as a rigid gear would have it.
    ///
    /// # Panics
    ///
    /// `q` has not one value for each joint.
    pub fn mass_with_motors(&self, q: &Joints<f64>) -> MassMatrix {
        let mut mass = self.chain.mass_matrix(q);
        for (joint, own) in self.joints.iter().enumerate() {
            mass[(joint, joint)] += own.motor_inertia;
        }
        mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::FrictionParameters;
    use crate::rigid_body::{ChainJoint, JointKind, LinkInertia, Matrix3};
    use std::collections::BTreeMap;

    /// A pendulum of 2 kg on 0.5 m about the y axis, hanging along x at q = 0.
    fn pendulum() -> (Chain, JointParameters) {
        let joint = ChainJoint {
            kind: JointKind::Revolute,
            placement: Placement::identity(),
            axis: Vector3::y(),
            armature: 5.0,
            limits: PositionLimits::NONE,
            link: LinkInertia {
                mass: 2.0,
                first_moment: Vector3::new(1.0, 0.0, 0.0),
                rotational: Matrix3::identity() * 0.5,
            },
        };
        let mut tip = Placement::identity();
        tip.translation = Vector3::new(0.5, 0.0, 0.0);
        let parameters = JointParameters {
            motor_inertia: 0.2,
            gear_ratio: 100.0,
            stiffness: 1e4,
            damping: 0.0,
            motor_constant: 10.0,
            motor_torque_limit: 50.0,
            torque_sensor_range: 60.0,
            position_lower: -1.0,
            position_upper: 1.0,
            velocity_limit: 2.0,
            friction: FrictionParameters {
                speed_range: [0.01, 2.0],
                effects: BTreeMap::new(),
            },
        };
        (Chain::new(&[joint], tip).unwrap(), parameters)
    }

    #[test]
    fn it_carries_its_links_and_not_its_motors() {
        let (chain, joint) = pendulum();
        let gravity = [0.0, 0.0, -9.81];
        let arm = SerialArm::new(chain, vec![joint], gravity, &[0.0], Vec::new()).unwrap();
        // Turning about +y lowers the mass: holding it takes 2 kg · 9.81 · 0.5 m upwards.
        let weight = arm.weight(&[0.0].into());
        assert!((weight[0] + 2.0 * 9.81 * 0.5).abs() < 1e-12, "{weight:?}");
        // The file's armature is not counted, the motor is.
        let mass = arm.mass_with_motors(&[0.3].into());
        assert!((mass[(0, 0)] - 0.7).abs() < 1e-12, "{mass}");
        assert!((arm.home_tip().translation - Vector3::new(0.5, 0.0, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn lists_of_another_length_and_a_home_out_of_range_are_refused_by_name() {
        let (chain, joint) = pendulum();
        let new = |joints: usize, home: &[f64]| {
            let joints = vec![joint.clone(); joints];
            let arm = SerialArm::new(chain.clone(), joints, [0.0; 3], home, Vec::new());
            arm.map(drop).unwrap_err().to_string()
        };
        assert!(new(2, &[0.0]).starts_with("joint has 2 entries where 1 are needed"));
        assert!(new(1, &[0.0, 0.0]).starts_with("arm.home has 2 entries"));
        assert!(new(1, &[1.5]).starts_with("arm.home[0] = 1.5 rad is outside -1 … 1 rad"));
    }

    #[test]
    fn a_plane_has_a_free_side() {
        let plane: Plane =
            toml::from_str("name = \"table\"\npoint = [0.0, 0.0, 0.1]\nnormal = [0.0, 0.0, 2.0]")
                .unwrap();
        plane.validate().unwrap();
        assert!((plane.distance(&Vector3::new(5.0, 1.0, 0.3)) - 0.2).abs() < 1e-15);
        let flat = Plane {
            normal: [0.0; 3],
            ..plane
        };
        assert!(flat.validate().unwrap_err().to_string().contains("normal"));
    }
}

//! Rigid-body dynamics of the two links, after Lagrange.
//!
//! M(q) q̈ + C(q, q̇) q̇ + g(q) = τ + Jᵀ F, the left side of equation (5)
//! written out for two links in a plane. Motors and gears are not in here:
//! they turn on the other side of the torque sensor.

use crate::joint::JointParameters;
use crate::kinematics::{Kinematics, LINKS, unit};
use crate::{Matrix2, ParameterError, Vector2, parameters};

/// Standard gravity \[m/s²\].
pub const STANDARD_GRAVITY: f64 = 9.80665;

parameters! {
    /// One link, seen as a rigid body that turns about its joint.
    #[derive(Copy)]
    pub struct LinkParameters {
        /// From this joint's axis to the next one's, or to the tip \[m\].
        pub length: f64 [0.01..=10.0, "m"],
        /// Mass \[kg\].
        pub mass: f64 [0.01..=1000.0, "kg"],
        /// From the joint's axis to the centre of mass, along the link \[m\].
        pub center_of_mass: f64 [0.0..=10.0, "m"],
        /// Moment of inertia about the centre of mass \[kg m²\].
        pub inertia: f64 [1e-6..=1000.0, "kg m²"],
    }
}

parameters! {
    /// The links and the gravity that they are in.
    #[derive(Copy)]
    pub struct ArmParameters {
        /// Acceleration of gravity, base frame \[m/s²\]: zero in orbit.
        pub gravity: [f64; 2] [-20.0..=20.0, "m/s²"],
        /// Link 1 and link 2.
        pub link: [LinkParameters; LINKS] [section],
    }
}

impl ArmParameters {
    /// The same arm on the ground, its plane upright: gravity along −y.
    #[must_use]
    pub fn on_ground(mut self) -> Self {
        self.gravity = [0.0, -STANDARD_GRAVITY];
        self
    }

    /// The same arm in orbit: no gravity.
    #[must_use]
    pub fn in_orbit(mut self) -> Self {
        self.gravity = [0.0, 0.0];
        self
    }

    /// The joints of these links, out of `joints`.
    ///
    /// # Errors
    ///
    /// [`ParameterError::WrongCount`]: there is not one for each link.
    pub fn joints_of_links<'a>(
        &self,
        joints: &'a [JointParameters],
    ) -> Result<&'a [JointParameters; LINKS], ParameterError> {
        joints.try_into().map_err(|_| ParameterError::WrongCount {
            key: "joint".into(),
            found: joints.len(),
            wanted: LINKS,
            each: "link in the section [arm]",
        })
    }

    /// Geometry of these links.
    pub fn kinematics(&self) -> Kinematics {
        Kinematics::new([self.link[0].length, self.link[1].length])
    }
}

/// Lagrangian dynamics of the two links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    parameters: ArmParameters,
    kinematics: Kinematics,
    /// m₁c₁² + I₁ + m₂l₁², the constant part of M₁₁ less M₂₂ \[kg m²\].
    proximal: f64,
    /// m₂ l₁ c₂ \[kg m²\].
    coupling: f64,
    /// m₂c₂² + I₂ = M₂₂ \[kg m²\].
    distal: f64,
}

impl Arm {
    /// Dynamics of links that were checked by [`ArmParameters::validate`].
    pub fn new(parameters: &ArmParameters) -> Self {
        let [one, two] = parameters.link;
        Self {
            parameters: *parameters,
            kinematics: parameters.kinematics(),
            proximal: one.mass * one.center_of_mass.powi(2)
                + one.inertia
                + two.mass * one.length.powi(2),
            coupling: two.mass * one.length * two.center_of_mass,
            distal: two.mass * two.center_of_mass.powi(2) + two.inertia,
        }
    }

    /// The parameters that it was made from.
    pub fn parameters(&self) -> &ArmParameters {
        &self.parameters
    }

    /// Geometry of the same links.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Inertia matrix M(q) \[kg m²\], symmetric and positive definite.
    pub fn inertia(&self, q: &Vector2<f64>) -> Matrix2<f64> {
        self.inertia_at(q.y.cos())
    }

    #[inline]
    fn inertia_at(&self, cosine: f64) -> Matrix2<f64> {
        let mixed = self.coupling * cosine;
        let off_diagonal = self.distal + mixed;
        Matrix2::new(
            self.proximal + self.distal + 2.0 * mixed,
            off_diagonal,
            off_diagonal,
            self.distal,
        )
    }

    /// Coriolis and centrifugal torques C(q, q̇) q̇ \[Nm\].
    pub fn coriolis(&self, q: &Vector2<f64>, qd: &Vector2<f64>) -> Vector2<f64> {
        self.coriolis_at(q.y.sin(), qd)
    }

    #[inline]
    fn coriolis_at(&self, sine: f64, qd: &Vector2<f64>) -> Vector2<f64> {
        let h = self.coupling * sine;
        Vector2::new(-h * (2.0 * qd.x + qd.y) * qd.y, h * qd.x * qd.x)
    }

    /// Torques g(q) = ∂V/∂q that hold the links against gravity \[Nm\]; zero in orbit.
    pub fn gravity(&self, q: &Vector2<f64>) -> Vector2<f64> {
        if self.parameters.gravity == [0.0; 2] {
            return Vector2::zeros();
        }
        self.gravity_at(&unit(q.x), &unit(q.x + q.y))
    }

    /// The same with links that point along `first` and `second`, of length 1.
    #[inline]
    fn gravity_at(&self, first: &Vector2<f64>, second: &Vector2<f64>) -> Vector2<f64> {
        let [one, two] = self.parameters.link;
        let [x, y] = self.parameters.gravity;
        // −(gravity · ∂r/∂angle) for a unit lever at each angle.
        let turn = |along: &Vector2<f64>| x * along.y - y * along.x;
        let shoulder = (one.mass * one.center_of_mass + two.mass * one.length) * turn(first);
        let elbow = two.mass * two.center_of_mass * turn(second);
        Vector2::new(shoulder + elbow, elbow)
    }

    /// What a step of the dynamics takes of one posture, from the sines of two angles.
    #[inline]
    pub fn posture(&self, q: &Vector2<f64>) -> Posture<'_> {
        let (first, bend) = (unit(q.x), unit(q.y));
        // cos and sin of q₁ + q₂.
        let second = Vector2::new(
            first.x * bend.x - first.y * bend.y,
            first.y * bend.x + first.x * bend.y,
        );
        let (tip, jacobian) = self.kinematics.turned(first, second);
        Posture {
            arm: self,
            tip,
            jacobian,
            inertia: self.inertia_at(bend.x),
            gravity: self.gravity_at(&first, &second),
            sine: bend.y,
        }
    }

    /// ∂L/∂q = ½ q̇ᵀ (∂M/∂q) q̇ − g(q) \[Nm\], with the Lagrangian L = T − V of
    /// equation (5); d/dt (M q̇) − ∂L/∂q = M q̈ + C q̇ + g.
    pub fn lagrangian_slope(&self, q: &Vector2<f64>, qd: &Vector2<f64>) -> Vector2<f64> {
        // M depends on q₂ alone.
        let second = -self.coupling * q.y.sin() * qd.x * (qd.x + qd.y);
        Vector2::new(0.0, second) - self.gravity(q)
    }

    /// Joint torques \[Nm\] that the motion q, q̇, q̈ takes without contact:
    /// M q̈ + C q̇ + g.
    pub fn inverse_dynamics(
        &self,
        q: &Vector2<f64>,
        qd: &Vector2<f64>,
        qdd: &Vector2<f64>,
    ) -> Vector2<f64> {
        let posture = self.posture(q);
        posture.inertia * qdd + posture.bias(qd)
    }

    /// Kinetic energy ½ q̇ᵀ M q̇ \[J\].
    pub fn kinetic_energy(&self, q: &Vector2<f64>, qd: &Vector2<f64>) -> f64 {
        0.5 * qd.dot(&(self.inertia(q) * qd))
    }

    /// Potential energy in gravity \[J\]; zero with the links' masses at joint 1.
    pub fn potential_energy(&self, q: &Vector2<f64>) -> f64 {
        let [x, y] = self.parameters.gravity;
        let [one, two] = self.parameters.link;
        let height = |angle: f64| x * angle.cos() + y * angle.sin();
        -(one.mass * one.center_of_mass + two.mass * one.length) * height(q.x)
            - two.mass * two.center_of_mass * height(q.x + q.y)
    }
}

/// The two links in one posture.
#[derive(Clone, Copy, Debug)]
pub struct Posture<'a> {
    arm: &'a Arm,
    /// Stylus tip r_ee, base frame \[m\].
    pub tip: Vector2<f64>,
    /// J = ∂r_ee/∂q \[m/rad\].
    pub jacobian: Matrix2<f64>,
    /// M(q) \[kg m²\].
    pub inertia: Matrix2<f64>,
    /// g(q) \[Nm\].
    gravity: Vector2<f64>,
    /// sin q₂.
    sine: f64,
}

impl Posture<'_> {
    /// C(q, q̇) q̇ + g(q) \[Nm\].
    #[inline]
    pub fn bias(&self, qd: &Vector2<f64>) -> Vector2<f64> {
        self.arm.coriolis_at(self.sine, qd) + self.gravity
    }
}

/// Solves M x = b for a symmetric positive definite 2 × 2 matrix.
///
/// Written out because the general decompositions of nalgebra cost several
/// times as much at this size, in the innermost loop.
#[inline]
pub fn solve_symmetric(matrix: &Matrix2<f64>, right: &Vector2<f64>) -> Vector2<f64> {
    let determinant = matrix.m11 * matrix.m22 - matrix.m12 * matrix.m12;
    Vector2::new(
        (matrix.m22 * right.x - matrix.m12 * right.y) / determinant,
        (matrix.m11 * right.y - matrix.m12 * right.x) / determinant,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn arm() -> Arm {
        let link = |length, mass, center_of_mass, inertia| LinkParameters {
            length,
            mass,
            center_of_mass,
            inertia,
        };
        Arm::new(
            &ArmParameters {
                gravity: [0.0, 0.0],
                link: [link(0.25, 4.0, 0.15, 0.03), link(0.25, 3.0, 0.1, 0.02)],
            }
            .on_ground(),
        )
    }

    fn state() -> impl Strategy<Value = (Vector2<f64>, Vector2<f64>)> {
        let angle = -3.0..3.0f64;
        let speed = -2.0..2.0f64;
        ((angle.clone(), angle), (speed.clone(), speed))
            .prop_map(|(q, v)| (Vector2::new(q.0, q.1), Vector2::new(v.0, v.1)))
    }

    /// Kinetic energy from the velocities of the centres of mass, without M.
    fn kinetic_energy_of_points(arm: &Arm, q: &Vector2<f64>, qd: &Vector2<f64>) -> f64 {
        let [one, two] = arm.parameters.link;
        let center = |q: &Vector2<f64>| {
            let first = Vector2::new(q.x.cos(), q.x.sin());
            let both = q.x + q.y;
            (
                first * one.center_of_mass,
                first * one.length + Vector2::new(both.cos(), both.sin()) * two.center_of_mass,
            )
        };
        let h = 1e-6;
        let (after, before) = (center(&(q + qd * h)), center(&(q - qd * h)));
        let square = |a: Vector2<f64>, b: Vector2<f64>| ((a - b) / (2.0 * h)).norm_squared();
        0.5 * (one.mass * square(after.0, before.0)
            + two.mass * square(after.1, before.1)
            + one.inertia * qd.x.powi(2)
            + two.inertia * (qd.x + qd.y).powi(2))
    }

    #[test]
    fn holding_the_stretched_arm_takes_its_weight_times_its_lever() {
        let torque = arm().gravity(&Vector2::zeros());
        let weight = STANDARD_GRAVITY;
        assert!((torque.x - weight * (4.0 * 0.15 + 3.0 * 0.35)).abs() < 1e-12);
        assert!((torque.y - weight * 3.0 * 0.1).abs() < 1e-12);
        let orbit = Arm::new(&arm().parameters().in_orbit());
        assert_eq!(orbit.gravity(&Vector2::zeros()), Vector2::zeros());
    }

    #[test]
    fn a_negative_mass_is_refused_by_name() {
        let mut parameters = *arm().parameters();
        parameters.link[1].mass = -1.0;
        let error = parameters.validate().unwrap_err();
        assert_eq!(error.key(), "link[1].mass");
    }

    proptest! {
        #[test]
        fn kinetic_energy_is_that_of_the_moving_masses((q, qd) in state()) {
            let direct = kinetic_energy_of_points(&arm(), &q, &qd);
            prop_assert!((arm().kinetic_energy(&q, &qd) - direct).abs() < 1e-7 * (1.0 + direct));
        }

        #[test]
        fn gravity_is_the_slope_of_potential_energy((q, qd) in state()) {
            let h = 1e-6;
            let slope = (arm().potential_energy(&(q + qd * h)) - arm().potential_energy(&(q - qd * h))) / (2.0 * h);
            prop_assert!((arm().gravity(&q).dot(&qd) - slope).abs() < 1e-6);
        }

        #[test]
        fn the_lagrangian_has_the_slope_it_is_said_to_have((q, qd) in state()) {
            let h = 1e-6;
            let lagrangian = |q| arm().kinetic_energy(&q, &qd) - arm().potential_energy(&q);
            let slope = arm().lagrangian_slope(&q, &qd);
            for (joint, step) in [(0, Vector2::new(h, 0.0)), (1, Vector2::new(0.0, h))] {
                let difference = (lagrangian(q + step) - lagrangian(q - step)) / (2.0 * h);
                prop_assert!((slope[joint] - difference).abs() < 1e-6);
            }
        }

        /// Equation (5), left side: d/dt ∂L/∂q̇ − ∂L/∂q.
        #[test]
        fn inverse_dynamics_is_the_left_side_of_equation_5((q, qd) in state(), a in -9.0..9.0f64, b in -9.0..9.0f64) {
            let (qdd, h) = (Vector2::new(a, b), 1e-5);
            let momentum = |t: f64| {
                let (q, qd) = (q + qd * t + qdd * (0.5 * t * t), qd + qdd * t);
                arm().inertia(&q) * qd
            };
            let left = (momentum(h) - momentum(-h)) / (2.0 * h) - arm().lagrangian_slope(&q, &qd);
            prop_assert!((left - arm().inverse_dynamics(&q, &qd, &qdd)).norm() < 1e-5);
        }

        /// Ṁ − 2C is skew symmetric: Coriolis torques do the work ½ q̇ᵀ Ṁ q̇.
        #[test]
        fn coriolis_torques_balance_the_changing_inertia((q, qd) in state()) {
            let h = 1e-6;
            let change = (arm().inertia(&(q + qd * h)) - arm().inertia(&(q - qd * h))) / (2.0 * h);
            let work = 0.5 * qd.dot(&(change * qd));
            prop_assert!((arm().coriolis(&q, &qd).dot(&qd) - work).abs() < 1e-7);
        }

        #[test]
        fn inertia_is_positive_definite((q, qd) in state()) {
            let inertia = arm().inertia(&q);
            prop_assert!(inertia.m11 > 0.0 && inertia.determinant() > 0.0);
            let back = solve_symmetric(&inertia, &(inertia * qd));
            prop_assert!((back - qd).norm() < 1e-10);
        }
    }
}

//! Geometry of the two-link planar arm: where the tip is, how it moves.
//!
//! Joint positions q = (q₁, q₂) \[rad\]; q₂ counts from link 1. Base frame:
//! x along the stretched arm at q = 0, lengths in \[m\].

use crate::{Joints, Matrix2, Vector2};

/// Links of the arm that is written out here, and in [`arm`](crate::arm), in
/// closed form; each has a joint.
pub const LINKS: usize = 2;

/// The vector of an arm's two joints; `None` of an arm that has not two.
pub fn planar(joints: &Joints<f64>) -> Option<Vector2<f64>> {
    let values = <[f64; LINKS]>::try_from(&joints[..]).ok()?;
    Some(Vector2::from(values))
}

impl From<Vector2<f64>> for Joints<f64> {
    fn from(vector: Vector2<f64>) -> Joints<f64> {
        <[f64; LINKS]>::from(vector).into()
    }
}

/// To which side the elbow is bent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Elbow {
    /// q₂ ≥ 0.
    Positive,
    /// q₂ ≤ 0.
    Negative,
}

impl Elbow {
    /// The side that `joint_position` \[rad\] is bent to.
    pub fn of(joint_position: &Vector2<f64>) -> Elbow {
        if joint_position.y < 0.0 {
            Elbow::Negative
        } else {
            Elbow::Positive
        }
    }
}

/// Why a tip point has no joint positions.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum InverseError {
    /// Further from joint 1 than the stretched arm reaches.
    #[error(
        "tip ({x:.4}, {y:.4}) m is {radius:.4} m from joint 1, beyond the reach of {reach:.4} m; choose a nearer point"
    )]
    TooFar {
        /// Tip \[m\].
        x: f64,
        /// Tip \[m\].
        y: f64,
        /// Distance from joint 1 \[m\].
        radius: f64,
        /// Sum of the link lengths \[m\].
        reach: f64,
    },
    /// Nearer to joint 1 than the folded arm can come.
    #[error(
        "tip ({x:.4}, {y:.4}) m is {radius:.4} m from joint 1, nearer than the folded arm's {reach:.4} m; choose a point further out"
    )]
    TooNear {
        /// Tip \[m\].
        x: f64,
        /// Tip \[m\].
        y: f64,
        /// Distance from joint 1 \[m\].
        radius: f64,
        /// Difference of the link lengths \[m\].
        reach: f64,
    },
    /// A coordinate is NaN or infinite.
    #[error("tip ({x}, {y}) m is not finite; send numbers")]
    NotFinite {
        /// Tip \[m\].
        x: f64,
        /// Tip \[m\].
        y: f64,
    },
}

/// The direction at `angle` \[rad\] from the x axis, of length 1.
#[inline]
pub(crate) fn unit(angle: f64) -> Vector2<f64> {
    let (sine, cosine) = angle.sin_cos();
    Vector2::new(cosine, sine)
}

/// A two-link planar arm's geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    lengths: [f64; 2],
}

impl Kinematics {
    /// An arm with link lengths `lengths` \[m\].
    pub fn new(lengths: [f64; 2]) -> Self {
        Self { lengths }
    }

    /// Link lengths \[m\].
    pub fn lengths(&self) -> [f64; 2] {
        self.lengths
    }

    /// Elbow (axis of joint 2), base frame \[m\].
    #[inline]
    pub fn elbow(&self, q: &Vector2<f64>) -> Vector2<f64> {
        unit(q.x) * self.lengths[0]
    }

    /// Stylus tip r_ee, base frame \[m\].
    #[inline]
    pub fn forward(&self, q: &Vector2<f64>) -> Vector2<f64> {
        self.forward_and_jacobian(q).0
    }

    /// J = ∂r_ee/∂q \[m/rad\], 2 × 2; ṙ_ee = J q̇ and τ = Jᵀ F.
    #[inline]
    pub fn jacobian(&self, q: &Vector2<f64>) -> Matrix2<f64> {
        self.forward_and_jacobian(q).1
    }

    /// Tip \[m\] and Jacobian \[m/rad\] at once, for loops that need both.
    #[inline]
    pub fn forward_and_jacobian(&self, q: &Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        self.turned(unit(q.x), unit(q.x + q.y))
    }

    /// The same with links that point along `first` and `second`, of length 1.
    #[inline]
    pub(crate) fn turned(
        &self,
        first: Vector2<f64>,
        second: Vector2<f64>,
    ) -> (Vector2<f64>, Matrix2<f64>) {
        let forearm = second * self.lengths[1];
        let tip = first * self.lengths[0] + forearm;
        let jacobian = Matrix2::new(-tip.y, -forearm.y, tip.x, forearm.x);
        (tip, jacobian)
    }

    /// Time derivative J̇ \[m/(rad s)\] at joint velocities `qd` \[rad/s\].
    pub fn jacobian_rate(&self, q: &Vector2<f64>, qd: &Vector2<f64>) -> Matrix2<f64> {
        let elbow = self.elbow(q);
        let forearm = unit(q.x + q.y) * self.lengths[1] * (qd.x + qd.y);
        let tip = elbow * qd.x + forearm;
        Matrix2::new(-tip.x, -forearm.x, -tip.y, -forearm.y)
    }

    /// Joint positions \[rad\] that put the tip at `tip` \[m\] with the elbow
    /// to the side asked for; q₁ within (−π, π].
    ///
    /// # Errors
    ///
    /// [`InverseError`] when the point cannot be reached.
    pub fn inverse(&self, tip: &Vector2<f64>, elbow: Elbow) -> Result<Vector2<f64>, InverseError> {
        let (x, y) = (tip.x, tip.y);
        let [first, second] = self.lengths;
        let radius = x.hypot(y);
        if !radius.is_finite() {
            return Err(InverseError::NotFinite { x, y });
        }
        // Rounding alone must not put the stretched arm out of its own reach.
        let tolerance = 1e-12 * (first + second);
        if radius > first + second + tolerance {
            let reach = first + second;
            return Err(InverseError::TooFar {
                x,
                y,
                radius,
                reach,
            });
        }
        if radius < (first - second).abs() - tolerance {
            let reach = (first - second).abs();
            return Err(InverseError::TooNear {
                x,
                y,
                radius,
                reach,
            });
        }
        let cosine = (radius * radius - first * first - second * second) / (2.0 * first * second);
        let magnitude = cosine.clamp(-1.0, 1.0).acos();
        let q2 = match elbow {
            Elbow::Positive => magnitude,
            Elbow::Negative => -magnitude,
        };
        let (sine, cosine) = q2.sin_cos();
        let q1 = y.atan2(x) - (second * sine).atan2(first + second * cosine);
        // Brings q₁ back into (−π, π].
        let (sine, cosine) = q1.sin_cos();
        Ok(Vector2::new(sine.atan2(cosine), q2))
    }

    /// How far from singular \[-\]: |det J| / (l₁ l₂) = |sin q₂|, 1 at the
    /// right-angled elbow, 0 stretched or folded.
    pub fn manipulability(&self, q: &Vector2<f64>) -> f64 {
        q.y.sin().abs()
    }

    /// Solves Jᵀ F = `torque` \[Nm\] for the force at the tip \[N\], base frame.
    /// `None` when [`manipulability`](Self::manipulability) is below `least`.
    #[inline]
    pub fn tip_force(
        &self,
        q: &Vector2<f64>,
        torque: &Vector2<f64>,
        least: f64,
    ) -> Option<Vector2<f64>> {
        let jacobian = self.jacobian(q);
        let determinant = jacobian.determinant();
        if determinant.abs() <= least * self.lengths[0] * self.lengths[1] || determinant == 0.0 {
            return None;
        }
        // (Jᵀ)⁻¹ written out: cheaper than a decomposition, and it cannot fail here.
        Some(Vector2::new(
            (jacobian.m22 * torque.x - jacobian.m21 * torque.y) / determinant,
            (jacobian.m11 * torque.y - jacobian.m12 * torque.x) / determinant,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    const ARM: Kinematics = Kinematics {
        lengths: [0.3, 0.2],
    };

    #[test]
    fn the_stretched_arm_lies_along_x() {
        let tip = ARM.forward(&Vector2::zeros());
        assert!((tip - Vector2::new(0.5, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn a_right_angle_puts_the_tip_beside_the_elbow() {
        let tip = ARM.forward(&Vector2::new(0.0, FRAC_PI_2));
        assert!((tip - Vector2::new(0.3, 0.2)).norm() < 1e-15);
    }

    #[test]
    fn points_out_of_reach_are_refused() {
        let far = ARM.inverse(&Vector2::new(0.0, 0.51), Elbow::Positive);
        assert!(matches!(far, Err(InverseError::TooFar { .. })));
        let near = ARM.inverse(&Vector2::new(0.05, 0.0), Elbow::Positive);
        assert!(matches!(near, Err(InverseError::TooNear { .. })));
        let none = ARM.inverse(&Vector2::new(f64::NAN, 0.0), Elbow::Positive);
        assert!(matches!(none, Err(InverseError::NotFinite { .. })));
    }

    #[test]
    fn the_stretched_arm_is_singular() {
        assert_eq!(ARM.manipulability(&Vector2::new(0.4, 0.0)), 0.0);
        let force = ARM.tip_force(&Vector2::new(0.4, 0.0), &Vector2::new(1.0, 1.0), 0.0);
        assert!(force.is_none());
    }

    proptest! {
        #[test]
        fn inverse_undoes_forward(q1 in -PI..PI, q2 in 0.01..3.1f64, negative: bool) {
            let q = Vector2::new(q1, if negative { -q2 } else { q2 });
            let back = ARM.inverse(&ARM.forward(&q), Elbow::of(&q)).unwrap();
            let turn = (back.x - q.x).rem_euclid(2.0 * PI);
            prop_assert!(turn.min(2.0 * PI - turn) < 1e-9);
            prop_assert!((back.y - q.y).abs() < 1e-9);
        }

        #[test]
        fn jacobian_is_the_derivative(q1 in -PI..PI, q2 in -3.0..3.0f64, v1 in -1.0..1.0f64, v2 in -1.0..1.0f64) {
            let (q, qd, h) = (Vector2::new(q1, q2), Vector2::new(v1, v2), 1e-6);
            let difference = (ARM.forward(&(q + qd * h)) - ARM.forward(&(q - qd * h))) / (2.0 * h);
            prop_assert!((ARM.jacobian(&q) * qd - difference).norm() < 1e-8);
            let rate = (ARM.jacobian(&(q + qd * h)) - ARM.jacobian(&(q - qd * h))) / (2.0 * h);
            prop_assert!((ARM.jacobian_rate(&q, &qd) - rate).norm() < 1e-8);
        }

        #[test]
        fn tip_force_undoes_the_transposed_jacobian(q1 in -PI..PI, q2 in 0.1..3.0f64, x in -50.0..50.0f64, y in -50.0..50.0f64) {
            let q = Vector2::new(q1, q2);
            let force = Vector2::new(x, y);
            let torque = ARM.jacobian(&q).transpose() * force;
            let back = ARM.tip_force(&q, &torque, 0.01).unwrap();
            prop_assert!((back - force).norm() < 1e-9 * (1.0 + force.norm()) / q2.sin().abs());
        }
    }
}

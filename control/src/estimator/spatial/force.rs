//! The force at the tip that fits the joints' torques best.
//!
//! Of τ_c = J_vᵀ F + ε with errors ε that grow with a sensor's range,
//! F = (J_v W J_vᵀ + λ² 1)⁻¹ J_v W τ_c with W = diag(1/range²) is the weighted least-squares
//! estimate (Gauss-Markov), damped by a λ that counts at a singularity only.

use ferntast_model::Joints;
use ferntast_model::rigid_body::Jacobian;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// As large as the arm, about: what makes the tip's mobility a number \[m\].
pub(super) const LENGTH: f64 = 0.5;
/// λ \[m\]; of a mobility of 0.05 it changes a force by 2·10⁻⁵.
const DAMPING: f64 = 1e-4;

/// How much each joint's torque counts, for sensors of these ranges: 1 for the largest.
pub(super) fn weights(ranges: &Joints<f64>) -> Joints<f64> {
    let largest = ranges.iter().copied().fold(0.0, f64::max);
    ranges.map(|range| (largest / range).powi(2))
}

/// What moves the tip: J_v q̇ \[m/s\].
pub(super) fn velocity(jacobian: &Jacobian, qd: &Joints<f64>) -> Vector3<f64> {
    let each = qd.iter().enumerate();
    each.map(|(joint, speed)| lever(jacobian, joint) * *speed)
        .sum()
}

/// How the tip's point moves with one joint.
fn lever(jacobian: &Jacobian, joint: usize) -> Vector3<f64> {
    Vector3::new(
        jacobian[(0, joint)],
        jacobian[(1, joint)],
        jacobian[(2, joint)],
    )
}

/// Whether every eigenvalue of a symmetric `matrix` is surely above `least`: exactly then it
/// has a Cholesky factor when so much is taken from its diagonal. A hundredth more is taken, so
/// that rounding does not count. `false` says nothing. Some tenths of what eigenvalues cost.
pub(super) fn exceeds<const N: usize>(matrix: &SMatrix<f64, N, N>, least: f64) -> bool {
    let mut left = *matrix;
    for row in 0..N {
        left[(row, row)] -= 1.01 * least;
    }
    for column in 0..N {
        let pivot = left[(column, column)];
        // Not where it is no number, either.
        if pivot.is_nan() || pivot <= 1e-9 * matrix[(column, column)] {
            return false;
        }
        for row in column + 1..N {
            let share = left[(row, column)] / pivot;
            for other in column + 1..=row {
                left[(row, other)] -= share * left[(other, column)];
            }
        }
    }
    true
}

/// Forces by torques in one posture.
pub(super) struct TipForce<'a> {
    jacobian: &'a Jacobian,
    weights: &'a Joints<f64>,
    /// (J_v W J_vᵀ + λ² 1)⁻¹; zero where forces cannot be told.
    inverse: Matrix3<f64>,
    singular: bool,
}

impl<'a> TipForce<'a> {
    /// Forces are told where the tip's least mobility, by `LENGTH`, is `singularity` \[-\] or
    /// more. An arm of fewer than three joints tells what lies in its directions.
    pub(super) fn new(jacobian: &'a Jacobian, weights: &'a Joints<f64>, singularity: f64) -> Self {
        let (mut plain, mut weighted) = (Matrix3::zeros(), Matrix3::zeros());
        for (joint, weight) in weights.iter().enumerate() {
            let lever = lever(jacobian, joint);
            let square = lever * lever.transpose();
            plain += square;
            weighted += square * *weight;
        }
        let least = (singularity * LENGTH).powi(2);
        let moves = weights.len() >= 3 && exceeds(&plain, least) || {
            let mut squares: [f64; 3] = plain.symmetric_eigenvalues().into();
            squares.sort_by(|a, b| b.total_cmp(a));
            let rank = weights.len().min(3);
            // Not where it is no number, either.
            squares[rank - 1].max(0.0).sqrt() / LENGTH >= singularity
        };
        let damped = weighted + Matrix3::identity() * (DAMPING * DAMPING);
        let inverse = damped.try_inverse();
        let singular = !moves || inverse.is_none();
        Self {
            jacobian,
            weights,
            inverse: inverse.filter(|_| !singular).unwrap_or_else(Matrix3::zeros),
            singular,
        }
    }

    /// The arm is too near a singularity to tell forces: they are zero.
    pub(super) fn is_singular(&self) -> bool {
        self.singular
    }

    /// The force \[N\], base frame, that makes `torque` \[Nm\].
    pub(super) fn force(&self, torque: &Joints<f64>) -> Vector3<f64> {
        let each = torque.iter().enumerate();
        each.map(|(joint, torque)| self.of_joint(joint, *torque))
            .sum()
    }

    /// What `force` \[N\] makes of a joint's torque \[Nm\].
    pub(super) fn torque_of(&self, joint: usize, force: &Vector3<f64>) -> f64 {
        lever(self.jacobian, joint).dot(force)
    }

    /// The share of the force \[N\] that one joint's torque \[Nm\] makes.
    pub(super) fn of_joint(&self, joint: usize, torque: f64) -> Vector3<f64> {
        self.inverse * lever(self.jacobian, joint) * (self.weights[joint] * torque)
    }
}

//! Force and torque at the tip that fit the joints' torques best.
//!
//! Of τ_c = Jᵀ (F, M) + ε with all rows of J, as [`force`](super::force) does it for a force alone:
//! (F, M) = (J W Jᵀ)⁻¹ J W τ_c. It takes six joints, and a posture in which the tip can be moved and
//! turned all ways. It is less precise than the force of a contact at the tip (of a panda at home by a
//! factor of two to four), so that it counts only where such a force is not enough: where what it
//! leaves of the joints' torques is more than their sensors may have wrong. Then the one is led
//! over to the other within some tenths of a second.

use super::force::{self, LENGTH, TipForce};
use ferntast_model::Joints;
use ferntast_model::rigid_body::Jacobian;
use nalgebra::{Matrix6, SVector, Vector3, Vector6};

/// How many numbers there are to tell.
const ROWS: usize = 6;
/// Of a sensor's torque and of its range, so much may be wrong of what is left [-].
const OF_TORQUE: f64 = 0.02;
const OF_RANGE: f64 = 0.003;
/// A force alone is enough where the root mean square of what is left, by what may be wrong, is less
/// than the first, and is not where it is more than the second [-],
const ENOUGH: f64 = 1.0;
const NOT_ENOUGH: f64 = 2.0;
/// for so long [s]: of an arm that is jerked the estimate is off for as long as its filters take.
const SURE_TIME: f64 = 0.05;
/// Time constant with which one is led over to the other [s].
const LEAD_TIME: f64 = 0.05;

/// Tells a force at the tip from a force with a torque.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wrench {
    /// A force alone is not enough.
    turns: bool,
    /// For how long what is left has said otherwise \[s\].
    otherwise: f64,
    /// How far the torque counts, 0 … 1.
    share: f64,
}

impl Wrench {
    /// Force \[N\] and torque \[Nm\] about the tip, base frame, that make `torque` \[Nm\], `passed`
    /// \[s\] after the step before; `whole` are both as they fit best, where that is known, and
    /// `ranges` \[Nm\] those of the sensors.
    pub(super) fn step(
        &mut self,
        passed: f64,
        torque: &Joints<f64>,
        ranges: &Joints<f64>,
        alone: &TipForce<'_>,
        whole: Option<Vector6<f64>>,
    ) -> [[f64; 3]; 2] {
        let force = alone.force(torque);
        let Some(whole) = whole else {
            *self = Wrench::default();
            return [force.into(), [0.0; 3]];
        };
        let left = torque.iter().zip(ranges.iter()).enumerate();
        let left = left.map(|(joint, (torque, range))| {
            let wrong = OF_TORQUE * torque.abs() + OF_RANGE * range;
            ((torque - alone.torque_of(joint, &force)) / wrong).powi(2)
        });
        let left = (left.sum::<f64>() / torque.len() as f64).sqrt();
        let otherwise = match self.turns {
            true => left < ENOUGH,
            false => left > NOT_ENOUGH,
        };
        self.otherwise = if otherwise {
            self.otherwise + passed
        } else {
            0.0
        };
        if self.otherwise >= SURE_TIME {
            self.turns = !self.turns;
            self.otherwise = 0.0;
        }
        let wanted = f64::from(u8::from(self.turns));
        self.share += (wanted - self.share) * (passed / LEAD_TIME).min(1.0);
        let part = |from: usize| whole.fixed_rows::<3>(from).into_owned();
        let force: Vector3<f64> = force + (part(0) - force) * self.share;
        [force.into(), (part(3) * self.share).into()]
    }
}

/// The force \[N\] and, below it, the torque \[Nm\] about the tip, base frame, that make `torque`
/// \[Nm\]; `None` where they cannot be told: of fewer than six joints, or where the tip's least
/// mobility, moved by `LENGTH` or turned, is less than `singularity` \[-\].
pub(super) fn whole(
    jacobian: &Jacobian,
    weights: &Joints<f64>,
    singularity: f64,
    torque: &Joints<f64>,
) -> Option<Vector6<f64>> {
    if weights.len() < ROWS {
        return None;
    }
    let (mut plain, mut weighted, mut sum) = (Matrix6::zeros(), Matrix6::zeros(), Vector6::zeros());
    for (joint, (weight, torque)) in weights.iter().zip(torque.iter()).enumerate() {
        // In a unit of force that makes rows alike.
        let lever: SVector<f64, ROWS> = SVector::from_fn(|row, _| match row < 3 {
            true => jacobian[(row, joint)] / LENGTH,
            false => jacobian[(row, joint)],
        });
        let square = lever * lever.transpose();
        plain += square;
        weighted += square * *weight;
        sum += lever * (*weight * *torque);
    }
    // Not where it is no number, either.
    let told = force::exceeds(&plain, singularity * singularity)
        || plain.symmetric_eigenvalues().min() >= singularity * singularity;
    let mut whole = weighted.cholesky().filter(|_| told)?.solve(&sum);
    whole.fixed_rows_mut::<3>(0).scale_mut(1.0 / LENGTH);
    whole.iter().all(|own| own.is_finite()).then_some(whole)
}

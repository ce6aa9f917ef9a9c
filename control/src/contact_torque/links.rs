//! The links' dynamics as equation (5) needs them.

use ferntast_model::arm::Arm;
use ferntast_model::kinematics::planar;
use ferntast_model::serial_arm::SerialArm;
use ferntast_model::{Joints, Vector2};

/// Dynamics of what is behind the torque sensors. Lists are of the arm's joints.
pub(crate) trait Links {
    /// M q̈ + C q̇ + g \[Nm\].
    fn inverse_dynamics(&self, q: &Joints<f64>, qd: &Joints<f64>, qdd: &Joints<f64>)
    -> Joints<f64>;

    /// p = M q̇ \[kg m²/s\].
    fn momentum(&self, q: &Joints<f64>, qd: &Joints<f64>) -> Joints<f64>;

    /// ∂L/∂q \[Nm\].
    fn lagrangian_slope(&self, q: &Joints<f64>, qd: &Joints<f64>) -> Joints<f64>;
}

/// The planar arm's two joints, of which its estimator has seen to it that there are two.
fn both(joints: &Joints<f64>) -> Vector2<f64> {
    planar(joints).unwrap_or_else(Vector2::zeros)
}

impl Links for Arm {
    fn inverse_dynamics(
        &self,
        q: &Joints<f64>,
        qd: &Joints<f64>,
        qdd: &Joints<f64>,
    ) -> Joints<f64> {
        Arm::inverse_dynamics(self, &both(q), &both(qd), &both(qdd)).into()
    }

    fn momentum(&self, q: &Joints<f64>, qd: &Joints<f64>) -> Joints<f64> {
        (self.inertia(&both(q)) * both(qd)).into()
    }

    fn lagrangian_slope(&self, q: &Joints<f64>, qd: &Joints<f64>) -> Joints<f64> {
        Arm::lagrangian_slope(self, &both(q), &both(qd)).into()
    }
}

/// How far the arm is moved to see how its mass matrix changes \[rad\].
const APART: f64 = 1e-4;
/// Slower than this its change is nothing \[rad/s\].
const REST: f64 = 1e-9;

impl Links for SerialArm {
    fn inverse_dynamics(
        &self,
        q: &Joints<f64>,
        qd: &Joints<f64>,
        qdd: &Joints<f64>,
    ) -> Joints<f64> {
        SerialArm::inverse_dynamics(self, q, qd, qdd)
    }

    fn momentum(&self, q: &Joints<f64>, qd: &Joints<f64>) -> Joints<f64> {
        self.momentum_at(q, qd)
    }

    /// Of q̇ᵀ (Ṁ − 2 C) q̇ = 0 for all q̇ follows Ṁ = C + Cᵀ, so that
    /// ∂L/∂q = ½ ∂(q̇ᵀ M q̇)/∂q − g = Cᵀ q̇ − g = Ṁ q̇ − (C q̇ + g).
    fn lagrangian_slope(&self, q: &Joints<f64>, qd: &Joints<f64>) -> Joints<f64> {
        let bias = SerialArm::inverse_dynamics(self, q, qd, &qd.map(|_| 0.0));
        let speed = qd.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        if speed < REST {
            return bias.map(|own| -own);
        }
        let time = APART / speed;
        let moved = |by: f64| Joints::from_fn(q.count(), |joint| q[joint] + by * qd[joint]);
        let after = self.momentum_at(&moved(time), qd);
        let before = self.momentum_at(&moved(-time), qd);
        Joints::from_fn(q.count(), |joint| {
            (after[joint] - before[joint]) / (2.0 * time) - bias[joint]
        })
    }
}

//! The planar arm of two links, in closed form.

use super::tip::{Led, TipKinematics, Turn};
use super::{CommandRefusal, Range};
use ferntast_model::kinematics::{Elbow, Kinematics, planar};
use ferntast_model::{JointCount, Joints, Vector2};
use nalgebra::Vector3;

/// The plane z = 0: what is commanded of z is not looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanarTip {
    pub(super) kinematics: Kinematics,
    /// Two.
    pub(super) count: JointCount,
}

impl TipKinematics for PlanarTip {
    fn count(&self) -> JointCount {
        self.count
    }

    fn followed(&self, tip: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(tip.x, tip.y, 0.0)
    }

    fn tip(&self, joints: &Joints<f64>) -> Result<Vector3<f64>, CommandRefusal> {
        let joints = planar(joints).ok_or(CommandRefusal::NoTipModel)?;
        let tip = self.kinematics.forward(&joints);
        Ok(Vector3::new(tip.x, tip.y, 0.0))
    }

    fn joints(
        &self,
        tip: &Vector3<f64>,
        _turn: Option<&Turn>,
        posture: &Joints<f64>,
        _last: Option<&Led>,
    ) -> Result<Led, CommandRefusal> {
        let posture = planar(posture).ok_or(CommandRefusal::NoTipModel)?;
        let limit = Range::Reach;
        self.kinematics
            .inverse(&Vector2::new(tip.x, tip.y), Elbow::of(&posture))
            .map(|joints| Led {
                joints: joints.into(),
                clear: 0.0,
            })
            .map_err(|_| CommandRefusal::OutOfRange { limit })
    }
}

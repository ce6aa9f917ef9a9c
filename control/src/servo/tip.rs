//! The arm's Cartesian model: what the servo needs to be told tips.

use super::CommandRefusal;
use super::command::Range;
use ferntast_model::kinematics::{Elbow, Kinematics, LINKS, planar};
use ferntast_model::{JointCount, Joints, ParameterError, Vector2};

/// Where the tip is, and which joint positions bring it there.
#[derive(Clone, Copy, Debug)]
pub(super) struct TipModel {
    kinematics: Kinematics,
}

impl TipModel {
    /// Of an arm with so many joints.
    pub(super) fn new(
        kinematics: Kinematics,
        joints: JointCount,
    ) -> Result<TipModel, ParameterError> {
        if joints.get() == LINKS {
            return Ok(TipModel { kinematics });
        }
        Err(ParameterError::WrongCount {
            key: "joint".into(),
            found: joints.get(),
            wanted: LINKS,
            each: "link of the arm's kinematics",
        })
    }

    /// Joint positions \[rad\] that bring the tip to `tip` \[m\], base frame, with
    /// the elbow bent as in `posture` \[rad\].
    pub(super) fn joints(
        &self,
        tip: &Vector2<f64>,
        posture: &Joints<f64>,
    ) -> Result<Joints<f64>, CommandRefusal> {
        let posture = planar(posture).ok_or(CommandRefusal::NoTipModel)?;
        let limit = Range::Reach;
        self.kinematics
            .inverse(tip, Elbow::of(&posture))
            .map(Joints::from)
            .map_err(|_| CommandRefusal::OutOfRange { limit })
    }

    /// The tip \[m\], base frame, at the joint positions `joints` \[rad\].
    pub(super) fn tip(&self, joints: &Joints<f64>) -> Result<Vector2<f64>, CommandRefusal> {
        let joints = planar(joints).ok_or(CommandRefusal::NoTipModel)?;
        Ok(self.kinematics.forward(&joints))
    }
}

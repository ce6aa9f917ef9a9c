//! What the servo needs to be told tips: where the tip is, and which joint positions bring
//! it somewhere.

use std::fmt::Debug;

use super::CommandRefusal;
use ferntast_model::{JointCount, Joints};
use nalgebra::{UnitQuaternion, Vector3};

/// Where a command led.
#[derive(Clone, Copy, Debug)]
pub(super) struct Led {
    /// Joint positions \[rad\] or \[m\].
    pub(super) joints: Joints<f64>,
    /// So far the joints may go together before singularities have to be looked for again
    /// \[rad\]; zero where that is not known.
    pub(super) clear: f64,
}

/// How a command turns the tool.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    /// How it is to be turned in the end, base frame.
    pub(super) to: UnitQuaternion<f64>,
    /// So far one command turns it \[rad\].
    pub(super) most: f64,
}

/// Kinematics of an arm as commands of tips need them. Neither allocates nor panics.
pub(super) trait TipKinematics: Debug + Send + Sync {
    /// How many joints the arm has.
    fn count(&self) -> JointCount;

    /// What of a commanded tip \[m\], base frame, the arm can follow: in a plane or in space.
    fn followed(&self, tip: &Vector3<f64>) -> Vector3<f64>;

    /// The tip \[m\], base frame, at the joint positions `joints` \[rad\] or \[m\].
    fn tip(&self, joints: &Joints<f64>) -> Result<Vector3<f64>, CommandRefusal>;

    /// How the tool is turned at the joint positions `joints`, base frame; `None` of an arm that
    /// cannot turn it as it likes.
    fn orientation(&self, joints: &Joints<f64>) -> Option<UnitQuaternion<f64>> {
        let _ = joints;
        None
    }

    /// Joint positions \[rad\] or \[m\] that bring the tip to `tip` \[m\], base frame, or as far
    /// on the way there as one command leads. The arm is bent as in `posture`; `last` is what
    /// the command before came to. Without a `turn` a tool that can be turned stays as at home.
    fn joints(
        &self,
        tip: &Vector3<f64>,
        turn: Option<&Turn>,
        posture: &Joints<f64>,
        last: Option<&Led>,
    ) -> Result<Led, CommandRefusal>;
}

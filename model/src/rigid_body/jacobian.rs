//! The geometric Jacobian: how the tip moves with the joints.

use nalgebra::{SMatrix, Vector3};

use crate::{Joints, MAX_JOINTS};

use super::{chain::Chain, placement::Placement, posture::Posture};

/// One column for each joint, zero behind the last one. Rows 1 to 3: velocity of the tip
/// \[m/s per rad/s or m/s\]; rows 4 to 6: angular velocity \[rad/s per rad/s or m/s\].
pub type Jacobian = SMatrix<f64, 6, MAX_JOINTS>;

impl Chain {
    /// Geometric Jacobian of the tip's origin, in axes of the base frame, at joint
    /// positions `q` \[rad\] or \[m\]: (ṙ, ω) = J q̇, and a force and moment at the tip
    /// act on the joints by Jᵀ.
    pub fn jacobian(&self, q: &Joints<f64>) -> Jacobian {
        self.forward_and_jacobian(q).1
    }

    /// The tip's frame and Jacobian at once, for loops that need both.
    pub fn forward_and_jacobian(&self, q: &Joints<f64>) -> (Placement, Jacobian) {
        self.forward_and_jacobian_in(&self.posture(q))
    }

    /// [`forward_and_jacobian`](Self::forward_and_jacobian) in a posture of this chain.
    pub fn forward_and_jacobian_in(&self, posture: &Posture) -> (Placement, Jacobian) {
        let placements = self.links_of(posture);
        let tip = self.tip_on(&placements);
        let mut jacobian = Jacobian::zeros();
        for (joint, link) in self.links.iter().enumerate() {
            let placement = &placements[joint];
            let axis = placement.rotation * link.axis;
            let (velocity, turning) = if link.is_revolute() {
                (axis.cross(&(tip.translation - placement.translation)), axis)
            } else {
                (axis, Vector3::zeros())
            };
            jacobian
                .fixed_view_mut::<3, 1>(0, joint)
                .copy_from(&velocity);
            jacobian
                .fixed_view_mut::<3, 1>(3, joint)
                .copy_from(&turning);
        }
        (tip, jacobian)
    }
}

//! Where the joints are, found once for several functions of one posture.

use crate::{Joints, MAX_JOINTS};

use super::{Placement, chain::Chain};

/// The joints' frames, each in the frame before it, of a chain at certain joint positions:
/// for loops that need several of its functions there.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    pub(super) joints: [Placement; MAX_JOINTS],
}

impl Chain {
    /// The posture at joint positions `q` \[rad\] or \[m\].
    #[inline]
    pub fn posture(&self, q: &Joints<f64>) -> Posture {
        self.expect_joints(q);
        let mut joints = [Placement::identity(); MAX_JOINTS];
        for (joint, link) in self.links.iter().enumerate() {
            joints[joint] = link.placement(q[joint]);
        }
        Posture { joints }
    }

    /// The links' frames in the base frame.
    pub(super) fn links_of(&self, posture: &Posture) -> Joints<Placement> {
        let mut placed = Placement::identity();
        Joints::from_fn(self.count(), |joint| {
            placed = placed.then(&posture.joints[joint]);
            placed
        })
    }
}

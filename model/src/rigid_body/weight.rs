//! What the joints carry of the links' weight.

use nalgebra::Vector3;

use crate::{Joints, MAX_JOINTS};

use super::{chain::Chain, posture::Posture};

impl Chain {
    /// Joint torques \[Nm\] or \[N\] that hold the links at rest in `gravity` \[m/s², base
    /// frame\], in a posture of this chain: [`inverse_dynamics_in`](Self::inverse_dynamics_in) without
    /// motion, at a third of its cost.
    pub fn weight_in(&self, posture: &Posture, gravity: &Vector3<f64>) -> Joints<f64> {
        let placements = &posture.joints;
        let mut forces = [Vector3::zeros(); MAX_JOINTS];
        let mut moments = [Vector3::zeros(); MAX_JOINTS];
        // At rest every point accelerates as the base does, against gravity.
        let mut acceleration = -gravity;
        for (joint, link) in self.links.iter().enumerate() {
            acceleration = placements[joint].rotation.tr_mul(&acceleration);
            forces[joint] = acceleration * link.inertia.mass;
            moments[joint] = link.inertia.first_moment.cross(&acceleration);
        }
        self.carried(posture, &mut moments, &mut forces)
    }

    /// From the tip on: each joint carries what all links behind it need, given their moments
    /// \[Nm\] and forces \[N\] at their own origins, in their own frames.
    #[inline]
    pub(super) fn carried(
        &self,
        posture: &Posture,
        moments: &mut [Vector3<f64>; MAX_JOINTS],
        forces: &mut [Vector3<f64>; MAX_JOINTS],
    ) -> Joints<f64> {
        let mut torques = Joints::filled(self.count(), 0.0);
        for (joint, link) in self.links.iter().enumerate().rev() {
            torques[joint] = link.along(&moments[joint], &forces[joint]);
            if joint > 0 {
                let placement = &posture.joints[joint];
                let force = placement.rotation * forces[joint];
                moments[joint - 1] +=
                    placement.rotation * moments[joint] + placement.translation.cross(&force);
                forces[joint - 1] += force;
            }
        }
        torques
    }
}

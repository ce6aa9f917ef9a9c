//! The joint-space mass matrix.

use nalgebra::{SMatrix, Vector3};

use crate::{Joints, MAX_JOINTS};

use super::{chain::Chain, posture::Posture};

/// Symmetric, a row and a column for each joint, zero behind the last one
/// \[kg m², kg m or kg, after the two joints\].
pub type MassMatrix = SMatrix<f64, MAX_JOINTS, MAX_JOINTS>;

impl Chain {
    /// Mass matrix M(q) at joint positions `q` \[rad\] or \[m\], armatures on its diagonal;
    /// kinetic energy is ½ q̇ᵀ M q̇. The composite-rigid-body algorithm (Featherstone
    /// 2008, table 6.2).
    pub fn mass_matrix(&self, q: &Joints<f64>) -> MassMatrix {
        self.mass_matrix_in(&self.posture(q))
    }

    /// [`mass_matrix`](Self::mass_matrix) in a posture of this chain.
    pub fn mass_matrix_in(&self, posture: &Posture) -> MassMatrix {
        let placements = &posture.joints;
        let mut mass = MassMatrix::zeros();
        // All links from this one to the tip, as if they were one body, in its frame.
        let mut composite = self.links[self.links.len() - 1].inertia;
        for (joint, link) in self.links.iter().enumerate().rev() {
            if joint + 1 < self.links.len() {
                composite = link.inertia + composite.placed(&placements[joint + 1]);
            }
            // Force and moment that a unit acceleration of this joint takes.
            let (mut force, mut moment) = if link.is_revolute() {
                (
                    link.axis.cross(&composite.first_moment),
                    composite.rotational * link.axis,
                )
            } else {
                (
                    link.axis * composite.mass,
                    composite.first_moment.cross(&link.axis),
                )
            };
            mass[(joint, joint)] = link.along(&moment, &force) + self.armature()[joint];
            for before in (0..joint).rev() {
                let placement = &placements[before + 1];
                force = placement.rotation * force;
                moment = placement.rotation * moment + placement.translation.cross(&force);
                let coupling = self.links[before].along(&moment, &force);
                mass[(joint, before)] = coupling;
                mass[(before, joint)] = coupling;
            }
        }
        mass
    }

    /// Kinetic energy ½ q̇ᵀ M q̇ \[J\], link by link from their velocities, with the motors'.
    pub fn kinetic_energy(&self, q: &Joints<f64>, qd: &Joints<f64>) -> f64 {
        self.expect_joints(q);
        self.expect_joints(qd);
        let (mut velocity, mut turning) = (Vector3::zeros(), Vector3::zeros());
        let mut energy = 0.0;
        for (joint, link) in self.links.iter().enumerate() {
            let placement = link.placement(q[joint]);
            let rotation = &placement.rotation;
            velocity = rotation.tr_mul(&(velocity + turning.cross(&placement.translation)));
            turning = rotation.tr_mul(&turning);
            let rate = link.axis * qd[joint];
            if link.is_revolute() {
                turning += rate;
            } else {
                velocity += rate;
            }
            let inertia = &link.inertia;
            energy += 0.5 * inertia.mass * velocity.norm_squared()
                + velocity.dot(&turning.cross(&inertia.first_moment))
                + 0.5 * turning.dot(&(inertia.rotational * turning))
                + 0.5 * self.armature()[joint] * qd[joint] * qd[joint];
        }
        energy
    }
}

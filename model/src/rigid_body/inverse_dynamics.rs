//! Inverse dynamics: the torques that a motion takes.

use nalgebra::Vector3;

use crate::Joints;

use super::{chain::Chain, motion::LinkMotion, posture::Posture};

impl Chain {
    /// Joint torques τ \[Nm\] or \[N\] that the motion q, q̇, q̈ takes in `gravity`
    /// \[m/s², base frame\] without contact: M(q) q̈ + C(q, q̇) q̇ + g(q), with the
    /// armatures in M. With a force F at the tip, J(q)ᵀ F comes off.
    ///
    /// The recursive Newton-Euler algorithm of Luh, Walker and Paul 1980, each link's
    /// quantities in its own frame, about its frame's origin instead of its centre of
    /// mass (Featherstone 2008, table 5.1).
    pub fn inverse_dynamics(
        &self,
        q: &Joints<f64>,
        qd: &Joints<f64>,
        qdd: &Joints<f64>,
        gravity: &Vector3<f64>,
    ) -> Joints<f64> {
        self.inverse_dynamics_in(&self.posture(q), qd, qdd, gravity)
    }

    /// [`inverse_dynamics`](Self::inverse_dynamics) in a posture of this chain.
    pub fn inverse_dynamics_in(
        &self,
        posture: &Posture,
        qd: &Joints<f64>,
        qdd: &Joints<f64>,
        gravity: &Vector3<f64>,
    ) -> Joints<f64> {
        self.expect_joints(qd);
        self.expect_joints(qdd);
        let placements = &posture.joints;
        let mut forces = [Vector3::zeros(); crate::MAX_JOINTS];
        let mut moments = [Vector3::zeros(); crate::MAX_JOINTS];

        let mut motion = LinkMotion::of_base(gravity);
        for (joint, link) in self.links.iter().enumerate() {
            motion = motion.next(link, &placements[joint], qd[joint], qdd[joint]);
            let LinkMotion {
                turning,
                turning_rate,
                acceleration,
            } = motion;
            let inertia = &link.inertia;
            let (lever, rotational) = (&inertia.first_moment, &inertia.rotational);
            forces[joint] = acceleration * inertia.mass
                + turning_rate.cross(lever)
                + turning.cross(&turning.cross(lever));
            moments[joint] = rotational * turning_rate
                + turning.cross(&(rotational * turning))
                + lever.cross(&acceleration);
        }

        let mut torques = self.carried(posture, &mut moments, &mut forces);
        for (torque, (armature, qdd)) in torques
            .iter_mut()
            .zip(self.armature().iter().zip(qdd.iter()))
        {
            *torque += armature * qdd;
        }
        torques
    }
}

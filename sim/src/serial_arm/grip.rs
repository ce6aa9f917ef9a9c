//! A hand that holds the tip: a spring and a damper between the tip and where the hand wants it.
//!
//! It has no mass of its own. Its damper is taken with the velocity in the middle of a step, which
//! no step is too long for.

use ferntast_model::{
    Joints,
    rigid_body::{
        Chain, Jacobian, MassMatrix, Matrix3, Posture, Vector3, Vector6, rotation_vector,
    },
};

/// How a hand holds the tip; base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Where it wants the tip \[m\], and how fast that moves \[m/s\].
    pub position: Vector3<f64>,
    /// \[m/s\]
    pub velocity: Vector3<f64>,
    /// How it wants the tip turned: the axes of its frame.
    pub rotation: Matrix3<f64>,
    /// \[N/m\]
    pub stiffness: f64,
    /// \[N·s/m\]
    pub damping: f64,
    /// \[Nm/rad\]
    pub turning_stiffness: f64,
    /// \[Nm·s/rad\]
    pub turning_damping: f64,
}

/// A grip in a posture.
pub(super) struct Hold {
    jacobian: Jacobian,
    /// What does not go with the tip's own velocity: force \[N\] and moment \[Nm\].
    pull: Vector6<f64>,
    damping: Vector6<f64>,
}

impl Grip {
    /// In a `posture` of `chain`.
    pub(super) fn hold(&self, chain: &Chain, posture: &Posture) -> Hold {
        let (tip, jacobian) = chain.forward_and_jacobian_in(posture);
        let force =
            (self.position - tip.translation) * self.stiffness + self.velocity * self.damping;
        let away = rotation_vector(&(self.rotation * tip.rotation.transpose()));
        let moment = away * self.turning_stiffness;
        let (along, about) = (self.damping, self.turning_damping);
        Hold {
            jacobian,
            pull: Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z),
            damping: Vector6::new(along, along, along, about, about, about),
        }
    }
}

impl Hold {
    /// Adds to the equations of the velocities in the middle of a step.
    pub(super) fn add(&self, matrix: &mut MassMatrix, right: &mut Joints<f64>) {
        for joint in 0..right.len() {
            let column = self.jacobian.column(joint);
            right[joint] += column.dot(&self.pull);
            let damped = column.component_mul(&self.damping);
            for other in 0..right.len() {
                matrix[(other, joint)] += self.jacobian.column(other).dot(&damped);
            }
        }
    }

    /// Force \[N\] and moment \[Nm\] on the tip, whose joints are as fast as `velocity`.
    pub(super) fn wrench(&self, velocity: &Joints<f64>) -> Vector6<f64> {
        let mut twist = Vector6::zeros();
        for (joint, rate) in velocity.iter().enumerate() {
            twist += self.jacobian.column(joint) * *rate;
        }
        self.pull - twist.component_mul(&self.damping)
    }
}

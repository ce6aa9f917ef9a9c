//! The momentum observer.
//!
//! Equation (5) with p = ∂L/∂q̇ = M(q) q̇ reads ṗ = τ + ∂L/∂q + Jᵀ F. The
//! residual
//!
//! r = ω (p − p₀ − ∫ (τ + ∂L/∂q + r) dt)
//!
//! obeys ṙ = ω (Jᵀ F − r): it follows the contact's torque as a low-pass of
//! first order would, and never sees an acceleration (De Luca, Albu-Schäffer,
//! Haddadin, Hirzinger: Collision Detection and Safe Reaction with the
//! DLR-III Lightweight Manipulator Arm, IROS 2006).

use super::filtered_motion::FilteredMotion;
use super::links::Links;
use ferntast_model::{JointCount, Joints};
use std::f64::consts::TAU;

/// The observer with what it knows of the last step.
#[derive(Clone, Debug)]
pub(crate) struct MomentumObserver {
    omega: f64,
    /// p at the last step \[kg m²/s\].
    momentum: Joints<f64>,
    /// τ + ∂L/∂q at the last step \[Nm\].
    drive: Joints<f64>,
    /// r \[Nm\].
    residual: Joints<f64>,
    /// q \[rad\] and q̇ \[rad/s\], as late as the residual.
    position: Joints<f64>,
    velocity: Joints<f64>,
}

impl MomentumObserver {
    /// An observer of so many joints with bandwidth `cut_off` \[Hz\].
    pub(crate) fn new(cut_off: f64, joints: JointCount) -> Self {
        let none = Joints::filled(joints, 0.0);
        Self {
            omega: TAU * cut_off,
            momentum: none,
            drive: none,
            residual: none,
            position: none,
            velocity: none,
        }
    }

    /// Starts again, at rest: the contact bears what joint torques and gravity leave over.
    pub(crate) fn reset(
        &mut self,
        links: &impl Links,
        position: &Joints<f64>,
        torque: &Joints<f64>,
    ) {
        let rest = position.map(|_| 0.0);
        self.velocity = rest;
        self.position = *position;
        self.momentum = rest;
        let slope = links.lagrangian_slope(position, &rest);
        self.drive = Joints::from_fn(rest.count(), |joint| torque[joint] + slope[joint]);
        self.residual = self.drive.map(|own| -own);
    }

    /// Takes in motion and joint torques, filtered alike, `dt` \[s\] after the last ones.
    pub(crate) fn step(
        &mut self,
        links: &impl Links,
        dt: f64,
        position: &Joints<f64>,
        velocity: &Joints<f64>,
        torque: &Joints<f64>,
    ) -> FilteredMotion {
        let momentum = links.momentum(position, velocity);
        let slope = links.lagrangian_slope(position, velocity);
        let share = 1.0 - (-self.omega * dt).exp();
        for joint in 0..position.len() {
            let drive = torque[joint] + slope[joint];
            // The residual's equation, integrated exactly over the step for a contact
            // that is steady in it; the drive by the trapezoidal rule.
            let contact =
                (momentum[joint] - self.momentum[joint]) / dt - (drive + self.drive[joint]) * 0.5;
            self.residual[joint] += (contact - self.residual[joint]) * share;
            self.position[joint] += (position[joint] - self.position[joint]) * share;
            self.velocity[joint] += (velocity[joint] - self.velocity[joint]) * share;
            self.drive[joint] = drive;
        }
        self.momentum = momentum;
        FilteredMotion {
            position: self.position,
            velocity: self.velocity,
            present_velocity: *velocity,
            contact_torque: self.residual,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_model::Vector2;
    use ferntast_model::arm::{Arm, ArmParameters, LinkParameters, solve_symmetric};
    use ferntast_model::kinematics::planar;

    /// Links that swing freely under a constant torque of a contact: the
    /// residual comes to it as 1 − exp(−ωt).
    #[test]
    fn it_follows_the_contact_as_a_low_pass_of_first_order() {
        let link = LinkParameters {
            length: 0.25,
            mass: 3.0,
            center_of_mass: 0.1,
            inertia: 0.02,
        };
        let arm = Arm::new(
            &ArmParameters {
                gravity: [0.0, 0.0],
                link: [link, link],
            }
            .on_ground(),
        );
        let mut observer = MomentumObserver::new(20.0, JointCount::new(2).unwrap());
        let (mut q, mut qd) = (Vector2::new(0.3, 1.0), Vector2::zeros());
        let (torque, contact) = (Vector2::new(2.0, -1.0), Vector2::new(-3.0, 1.5));
        observer.reset(&arm, &q.into(), &(-arm.gravity(&q)).into());
        observer.residual = [0.0; 2].into();
        observer.drive = (torque - arm.gravity(&q)).into();
        let dt = 1e-5;
        for step in 1..=10_000 {
            let links = arm.posture(&q);
            qd += solve_symmetric(&links.inertia, &(torque + contact - links.bias(&qd))) * dt;
            q += qd * dt;
            let motion = observer.step(&arm, dt, &q.into(), &qd.into(), &torque.into());
            let residual = planar(&motion.contact_torque).unwrap();
            if step % 1000 == 0 {
                let grown = 1.0 - (-TAU * 20.0 * dt * f64::from(step)).exp();
                assert!((residual - contact * grown).norm() < 2e-3, "{residual}");
            }
        }
        assert!(qd.norm() > 1.0);
    }
}

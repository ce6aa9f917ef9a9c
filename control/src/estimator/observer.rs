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

use super::form::FilteredMotion;
use ferntast_model::Vector2;
use ferntast_model::arm::Arm;
use std::f64::consts::TAU;

/// The observer with what it knows of the last step.
#[derive(Clone, Debug)]
pub(super) struct MomentumObserver {
    omega: f64,
    /// p at the last step \[kg m²/s\].
    momentum: Vector2<f64>,
    /// τ + ∂L/∂q at the last step \[Nm\].
    drive: Vector2<f64>,
    /// r \[Nm\].
    residual: Vector2<f64>,
    /// q \[rad\] and q̇ \[rad/s\], as late as the residual.
    position: Vector2<f64>,
    velocity: Vector2<f64>,
}

impl MomentumObserver {
    /// An observer with bandwidth `cut_off` \[Hz\].
    pub(super) fn new(cut_off: f64) -> Self {
        Self {
            omega: TAU * cut_off,
            momentum: Vector2::zeros(),
            drive: Vector2::zeros(),
            residual: Vector2::zeros(),
            position: Vector2::zeros(),
            velocity: Vector2::zeros(),
        }
    }

    /// Starts again, at rest: the contact bears what joint torques and gravity leave over.
    pub(super) fn reset(&mut self, arm: &Arm, position: &Vector2<f64>, torque: &Vector2<f64>) {
        self.velocity = Vector2::zeros();
        self.position = *position;
        self.momentum = Vector2::zeros();
        self.drive = torque + arm.lagrangian_slope(position, &self.velocity);
        self.residual = -self.drive;
    }

    /// Takes in motion and joint torques, filtered alike, `dt` \[s\] after the last ones.
    pub(super) fn step(
        &mut self,
        arm: &Arm,
        dt: f64,
        position: &Vector2<f64>,
        velocity: &Vector2<f64>,
        torque: &Vector2<f64>,
    ) -> FilteredMotion {
        let momentum = arm.inertia(position) * velocity;
        let drive = torque + arm.lagrangian_slope(position, velocity);
        // The residual's equation, integrated exactly over the step for a contact
        // that is steady in it; the drive by the trapezoidal rule.
        let contact = (momentum - self.momentum) / dt - (drive + self.drive) * 0.5;
        let share = 1.0 - (-self.omega * dt).exp();
        self.residual += (contact - self.residual) * share;
        self.position += (position - self.position) * share;
        self.velocity += (velocity - self.velocity) * share;
        self.momentum = momentum;
        self.drive = drive;
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
    use ferntast_model::arm::{ArmParameters, LinkParameters, solve_symmetric};

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
        let mut observer = MomentumObserver::new(20.0);
        let (mut q, mut qd) = (Vector2::new(0.3, 1.0), Vector2::zeros());
        let (torque, contact) = (Vector2::new(2.0, -1.0), Vector2::new(-3.0, 1.5));
        observer.reset(&arm, &q, &-arm.gravity(&q));
        observer.residual = Vector2::zeros();
        observer.drive = torque - arm.gravity(&q);
        let dt = 1e-5;
        for step in 1..=10_000 {
            let (inertia, bias) = arm.inertia_and_bias(&q, &qd);
            qd += solve_symmetric(&inertia, &(torque + contact - bias)) * dt;
            q += qd * dt;
            let residual = observer.step(&arm, dt, &q, &qd, &torque).contact_torque;
            if step % 1000 == 0 {
                let grown = 1.0 - (-TAU * 20.0 * dt * f64::from(step)).exp();
                assert!((residual - contact * grown).norm() < 2e-3, "{residual}");
            }
        }
        assert!(qd.norm() > 1.0);
    }
}

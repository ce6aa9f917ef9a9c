//! The two forms of equation (5): how motion and joint torques tell the torque
//! of the contact, Jᵀ F.

use super::{DerivativeFilter, observer::MomentumObserver};
use ferntast_model::arm::Arm;
use ferntast_model::{JOINTS, Vector2};
use serde::{Deserialize, Serialize};

/// How the contact's torque is found from joint torques and motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// Equation (5) as it stands, with the filtered acceleration:
    /// Jᵀ F = M(q) q̈ + C(q, q̇) q̇ + g(q) − τ.
    #[default]
    Direct,
    /// The momentum p = M(q) q̇ is observed: what changes it and is neither
    /// joint torque nor ∂L/∂q is the contact. Needs no acceleration.
    MomentumObserver,
}

/// Filtered motion of the links, all as late as the torque of the contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilteredMotion {
    /// q \[rad\].
    pub(super) position: Vector2<f64>,
    /// q̇ \[rad/s\].
    pub(super) velocity: Vector2<f64>,
    /// q̇ as it should be by now \[rad/s\]: predicted over the delay, and noisier.
    pub(super) present_velocity: Vector2<f64>,
    /// Jᵀ F \[Nm\].
    pub(super) contact_torque: Vector2<f64>,
}

/// Filters all channels alike and computes the torque of the contact.
#[derive(Clone, Debug)]
pub(super) struct TorqueOfContact {
    positions: [DerivativeFilter; JOINTS],
    torques: [DerivativeFilter; JOINTS],
    observer: Option<MomentumObserver>,
    delay: f64,
}

impl TorqueOfContact {
    /// Either form with the same delay, which `cut_off` \[Hz\] decides on.
    ///
    /// The observer is itself a low-pass of first order. It gets the cut-off
    /// asked for, and the filters before it twice that: their delays, 1/ω and
    /// 2/(2ω), add up to the 2/ω that the direct form's filters have.
    pub(super) fn new(form: Form, cut_off: f64) -> Self {
        let (filter, observer) = match form {
            Form::Direct => (DerivativeFilter::new(cut_off), None),
            Form::MomentumObserver => (
                DerivativeFilter::new(2.0 * cut_off),
                Some(MomentumObserver::new(cut_off)),
            ),
        };
        Self {
            positions: [filter; JOINTS],
            torques: [filter; JOINTS],
            observer,
            delay: DerivativeFilter::new(cut_off).delay(),
        }
    }

    /// How late everything is \[s\].
    pub(super) fn delay(&self) -> f64 {
        self.delay
    }

    /// Starts again, at rest at link positions `position` \[rad\] under `torque` \[Nm\].
    pub(super) fn reset(&mut self, arm: &Arm, position: &Vector2<f64>, torque: &Vector2<f64>) {
        for joint in 0..JOINTS {
            self.positions[joint].reset(position[joint]);
            self.torques[joint].reset(torque[joint]);
        }
        if let Some(observer) = &mut self.observer {
            observer.reset(arm, position, torque);
        }
    }

    /// Takes in link positions \[rad\] and joint torques \[Nm\], `dt` \[s\] after the last ones.
    pub(super) fn step(&mut self, dt: f64, position: &Vector2<f64>, torque: &Vector2<f64>) {
        for joint in 0..JOINTS {
            self.positions[joint].step(position[joint], dt);
            self.torques[joint].step(torque[joint], dt);
        }
    }

    /// Motion and torque of the contact, after [`step`](Self::step) or [`reset`](Self::reset).
    pub(super) fn motion(&mut self, arm: &Arm, dt: f64) -> FilteredMotion {
        let channel = |read: fn(&DerivativeFilter) -> f64, from: &[DerivativeFilter; JOINTS]| {
            Vector2::new(read(&from[0]), read(&from[1]))
        };
        let position = channel(DerivativeFilter::value, &self.positions);
        let velocity = channel(DerivativeFilter::first, &self.positions);
        let acceleration = channel(DerivativeFilter::second, &self.positions);
        let torque = channel(DerivativeFilter::value, &self.torques);
        let present_velocity = velocity + acceleration * self.positions[0].delay();
        match &mut self.observer {
            None => FilteredMotion {
                position,
                velocity,
                present_velocity,
                contact_torque: arm.inverse_dynamics(&position, &velocity, &acceleration) - torque,
            },
            Some(observer) => FilteredMotion {
                present_velocity,
                ..observer.step(arm, dt, &position, &velocity, &torque)
            },
        }
    }
}

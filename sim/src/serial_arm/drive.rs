//! What drives a joint, and what of it the length of a step decides; symbols as in `plant.rs`.

use crate::arm::Gear;

/// One joint's drive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drive {
    /// J, joint side \[kg m²\] or \[kg\].
    pub inertia: f64,
    /// K; `None` is rigid.
    pub stiffness: Option<f64>,
    /// D.
    pub damping: f64,
    /// Its friction; `None` is none.
    pub friction: Option<Gear>,
}

/// What of a drive the length of a step decides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    /// m.
    pub momentum: f64,
    /// β: how the motor's velocity gives way to a torque on it.
    pub own: f64,
    /// B: how it follows the link's velocity.
    pub follows: f64,
}

impl Drive {
    /// Of a step of `dt` \[s\].
    pub fn share(&self, dt: f64) -> Share {
        let momentum = 2.0 * self.inertia / dt;
        let Some(stiffness) = self.stiffness else {
            return Share {
                momentum,
                own: 0.0,
                follows: 1.0,
            };
        };
        let coupling = 0.5 * dt * stiffness + self.damping;
        let own = 1.0 / (momentum + coupling);
        Share {
            momentum,
            own,
            follows: coupling * own,
        }
    }
}

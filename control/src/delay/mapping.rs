//! What every law but the baseline shares: scales between hand and tip, what
//! counts as live, how a force fades.

use super::{Motion, Received};
use nalgebra::Vector3;

/// Scales and deadlines. Laws reckon in *hand units*: the tip's position as
/// the hand would have it, the contact's force as the hand would feel it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    /// s_x: motion of the tip by motion of the hand \[-\].
    pub position_scale: f64,
    /// s_F: force on the hand by force on the tip \[-\].
    pub force_scale: f64,
    /// x_0: tip position when the hand is in the middle of its workspace \[m\].
    pub workspace_offset: [f64; 3],
    /// Silence after which the other end counts as lost \[s\].
    pub deadline: f64,
    /// Time in which the force on the hand fades out on loss, and in again \[s\].
    pub force_ramp: f64,
}

impl Mapping {
    /// What may be acted on.
    pub(super) fn live(&self, connected: bool, received: Option<Received>) -> Option<Received> {
        received.filter(|own| connected && own.packet.valid && own.silence <= self.deadline)
    }

    /// A tip's position in hand units \[m\].
    pub fn tip_at_hand(&self, tip: [f64; 3]) -> Vector3<f64> {
        (Vector3::from(tip) - Vector3::from(self.workspace_offset)) / self.position_scale
    }

    /// A command in hand units as position and velocity of the tip.
    pub(super) fn command(&self, position: Vector3<f64>, velocity: Vector3<f64>) -> Motion {
        let offset = Vector3::from(self.workspace_offset);
        Motion {
            position: (offset + self.position_scale * position).into(),
            velocity: (self.position_scale * velocity).into(),
        }
    }

    /// A contact force in hand units \[N\]; what is not finite counts as none.
    pub fn contact_at_hand(&self, force: [f64; 3]) -> Vector3<f64> {
        let force = self.force_scale * Vector3::from(force);
        if force.iter().all(|own| own.is_finite()) {
            force
        } else {
            Vector3::zeros()
        }
    }

    /// A stiffness at the tip in hand units \[N/m\].
    pub fn stiffness_at_hand(&self, stiffness: f64) -> f64 {
        self.force_scale * self.position_scale * stiffness
    }

    /// Power at the hand by power at the tip that corresponds to it, s_F/s_x \[-\].
    pub fn power_scale(&self) -> f64 {
        self.force_scale / self.position_scale
    }
}

/// How far a force is faded in, 0 … 1.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ForceRamp(f64);

impl ForceRamp {
    /// Faded in so far.
    pub fn at(share: f64) -> ForceRamp {
        ForceRamp(share)
    }

    pub fn step(&mut self, dt: f64, ramp: f64, live: bool) -> f64 {
        let change = if live { dt / ramp } else { -dt / ramp };
        self.0 = (self.0 + change).clamp(0.0, 1.0);
        self.0
    }
}

/// `own`, shortened to `limit` where it is longer.
pub(super) fn shortened(own: Vector3<f64>, limit: f64) -> Vector3<f64> {
    let norm = own.norm();
    if norm > limit {
        own * (limit / norm)
    } else {
        own
    }
}

/// Declares the parameters of a law: those of [`Mapping`] and its own.
macro_rules! law_parameters {
    ($(#[$meta:meta])* pub struct $name:ident { $($own:tt)* }) => {
        ferntast_model::parameters! {
            $(#[$meta])*
            pub struct $name {
                /// s_x: motion of the tip by motion of the hand \[-\].
                pub position_scale: f64 [1e-3..=1e3, "-"] = 1.0,
                /// s_F: force on the hand by force on the tip \[-\].
                pub force_scale: f64 [0.0..=1e3, "-"] = 0.05,
                /// x_0: tip position when the hand is in the middle of its
                /// workspace, follower base frame \[m\].
                pub workspace_offset: [f64; 3] [-10.0..=10.0, "m"] = [0.35355, 0.0, 0.0],
                /// Silence after which the other end counts as lost \[s\].
                pub deadline: f64 [0.002..=0.030, "s"] = 0.025,
                /// Time in which the force on the hand fades out on loss, and in
                /// again \[s\].
                pub force_ramp: f64 [0.001..=10.0, "s"] = 0.2,
                $($own)*
            }
        }

        impl $name {
            pub(in $crate::delay) fn mapping(&self) -> $crate::delay::Mapping {
                $crate::delay::Mapping {
                    position_scale: self.position_scale,
                    force_scale: self.force_scale,
                    workspace_offset: self.workspace_offset,
                    deadline: self.deadline,
                    force_ramp: self.force_ramp,
                }
            }

            /// The same law between the scales of `mapping`.
            pub(in $crate::delay) fn between(
                &self,
                mapping: &$crate::delay::Mapping,
            ) -> Self {
                let mut own = self.clone();
                own.position_scale = mapping.position_scale;
                own.force_scale = mapping.force_scale;
                own.workspace_offset = mapping.workspace_offset;
                own.deadline = mapping.deadline;
                own.force_ramp = mapping.force_ramp;
                own
            }
        }
    };
}
pub(super) use law_parameters;

/// Implements [`Parameters`](super::Parameters) for a law declared by
/// [`law_parameters`].
macro_rules! law_ends {
    ($name:ident, $text:literal, $guarantee:ident, $leader:ident, $follower:ident) => {
        impl $crate::delay::Parameters for $name {
            const NAME: &'static str = $text;
            type Leader = $leader;
            type Follower = $follower;

            fn guarantee(&self) -> $crate::delay::Guarantee {
                $crate::delay::Guarantee::$guarantee
            }

            fn mapping(&self) -> $crate::delay::Mapping {
                self.mapping()
            }

            fn samples(&self) -> [$crate::delay::Samples; 2] {
                self.samples()
            }

            fn between(&self, mapping: &$crate::delay::Mapping) -> Self {
                self.between(mapping)
            }

            fn leader(&self) -> $leader {
                $leader::new(self)
            }

            fn follower(&self) -> $follower {
                $follower::new(self)
            }
        }
    };
}
pub(super) use law_ends;

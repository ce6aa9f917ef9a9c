//! What a form of equation (5) tells.

use ferntast_model::Joints;

/// Filtered motion of the links, all as late as the torque of the contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilteredMotion {
    /// q \[rad\].
    pub(super) position: Joints<f64>,
    /// q̇ \[rad/s\].
    pub(super) velocity: Joints<f64>,
    /// q̇ as it should be by now \[rad/s\]: predicted over the delay, and noisier.
    pub(super) present_velocity: Joints<f64>,
    /// Jᵀ F \[Nm\].
    pub(super) contact_torque: Joints<f64>,
}

//! What a form of equation (5) tells.

use ferntast_model::Joints;

/// Filtered motion of the links, all as late as the torque of the contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilteredMotion {
    /// q \[rad\].
    pub(crate) position: Joints<f64>,
    /// q̇ \[rad/s\].
    pub(crate) velocity: Joints<f64>,
    /// q̇ as it should be by now \[rad/s\]: predicted over the delay, and noisier.
    pub(crate) present_velocity: Joints<f64>,
    /// Jᵀ F \[Nm\].
    pub(crate) contact_torque: Joints<f64>,
}

//! Control laws: joint servo, force observer, haptic rendering, delay compensation.
//!
//! Everything here is a pure step: state, inputs and `dt` in, outputs out. No
//! clock, no allocation, no lock and no panic in a step; what is refused or
//! limited is a value in the output. Stamps are `i64` nanoseconds since the
//! UNIX epoch (zero is invalid), durations `f64` seconds.

pub mod arming;
pub mod codec;
mod contact_torque;
pub mod delay;
pub mod estimator;
pub mod frame;
pub mod haptics;
pub mod link;
pub mod meter;
pub mod operating;
pub mod orientation;
pub mod planted;
pub mod playout;
pub mod servo;
mod short_bytes;
pub mod switching;
pub mod view;

pub use short_bytes::ShortBytes;

/// Longest time that passes in one step of a loop \[s\]: one that was held up for longer does not
/// compute on over what it has not seen (a simulated arm loses time).
pub const LONGEST_STEP: f64 = 0.020;

/// Nanoseconds as seconds.
pub(crate) fn seconds(nanos: i64) -> f64 {
    nanos as f64 / 1e9
}

/// Seconds as nanoseconds, rounded; saturates.
pub(crate) fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

/// Share of the way to its input that a low pass of first order with that `time_constant` \[s\]
/// goes within `dt` \[s\]: implicit Euler, which overshoots for no `dt`.
pub(crate) fn low_pass_share(dt: f64, time_constant: f64) -> f64 {
    dt / (dt + time_constant)
}

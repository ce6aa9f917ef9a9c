//! What goes into a twin, and what comes out of it.

use serde::Serialize;

/// The joint's channels at one time; joint side of the gear. For a prismatic joint
/// read m for rad and N for Nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwinSample {
    /// Time since any fixed moment \[s\].
    pub time: f64,
    /// q \[rad\].
    pub position: f64,
    /// τ_m \[Nm\].
    pub motor_torque: f64,
    /// τ \[Nm\], where it is measured.
    pub joint_torque: Option<f64>,
    /// T \[degC\], where it is measured.
    pub temperature: Option<f64>,
}

impl TwinSample {
    /// q, τ_m, τ and T, zero where they are not measured.
    pub(super) fn channels(&self) -> [f64; 4] {
        [
            self.position,
            self.motor_torque,
            self.joint_torque.unwrap_or(0.0),
            self.temperature.unwrap_or(0.0),
        ]
    }
}

/// One row of the regression, filtered.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TwinRow {
    pub(super) time: f64,
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) joint_torque: f64,
    pub(super) temperature: f64,
    pub(super) motor_torque: f64,
    /// J q̈ + τ.
    pub(super) driven: f64,
    pub(super) phi: Vec<f64>,
    pub(super) slides: bool,
}

/// Measured and predicted torque of one row.
#[derive(Clone, Debug, PartialEq)]
pub struct TwinOutput {
    /// Time of the row, and of the samples in the middle of its filters \[s\].
    pub time: f64,
    /// q \[rad\].
    pub position: f64,
    /// q̇ \[rad/s\].
    pub velocity: f64,
    /// τ \[Nm\].
    pub joint_torque: f64,
    /// T \[degC\].
    pub temperature: f64,
    /// Measured τ_m, filtered \[Nm\].
    pub measured: f64,
    /// τ_m by the model as identified off line \[Nm\].
    pub predicted: f64,
    /// τ_m by the model with the current estimates of its parameters \[Nm\].
    pub followed: f64,
    /// Whether the joint slides; at rest friction has no value of its own, and
    /// the row is neither learned from nor counted.
    pub slides: bool,
}

/// Fault of a sample, or of those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Flag {
    /// A number is not finite; the sample is left out.
    NotFinite,
    /// Time did not advance; the sample is left out.
    TimeBackwards,
    /// Time jumped; filters and states started again.
    Gap,
    /// The position is exactly constant while the motor torque changes.
    PositionStuck,
    /// The joint torque is exactly constant while the joint moves.
    JointTorqueStuck,
}

//! What a bench gives out.

use super::effect::Reading;
use super::{Believed, HiddenEffect, Motion};

/// A true parameter of the joint, or of what it hides.
pub type TrueParameter = crate::bench::TrueParameter<HiddenEffect>;

/// What nobody on the bench can see, one entry a log entry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrueSignals {
    /// Position reading without noise \[rad\].
    pub position: Vec<f64>,
    /// True velocity where position is measured \[rad/s\].
    pub velocity: Vec<f64>,
    /// Motor torque reading without noise \[Nm\].
    pub motor_torque: Vec<f64>,
    /// Joint torque reading without noise \[Nm\].
    pub joint_torque: Vec<f64>,
    /// \[degC\]
    pub temperature: Vec<f64>,
    /// τ_F with this session's parameters and hidden effects \[Nm\].
    pub friction: Vec<f64>,
    /// The part of τ_F that is there only because this session's parameters
    /// are not the nominal ones \[Nm\].
    pub scatter: Vec<f64>,
}

impl TrueSignals {
    pub(super) fn push(&mut self, reading: &Reading, velocity: f64, temperature: f64) {
        self.position.push(reading.position);
        self.velocity.push(velocity);
        self.motor_torque.push(reading.motor_torque);
        self.joint_torque.push(reading.joint_torque);
        self.temperature.push(temperature);
    }
}

/// One session's log: all channels one after another every
/// [`LOG_PERIOD`](super::LOG_PERIOD), all of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BenchSession {
    /// Since the first session's start \[s\].
    pub start: f64,
    /// What it ran; none only for an empty session.
    pub motion: Option<Motion>,
    /// Since this session's start \[s\].
    pub time: Vec<f64>,
    /// q \[rad\].
    pub position: Vec<f64>,
    /// τ_m \[Nm\], joint side.
    pub motor_torque: Vec<f64>,
    /// τ \[Nm\], positive when it accelerates the link towards positive q.
    pub joint_torque: Vec<f64>,
    /// \[degC\]
    pub temperature: Vec<f64>,
    /// The truth behind it.
    pub truth: TrueSignals,
}

impl BenchSession {
    pub(super) fn with_capacity(entries: usize) -> Self {
        let channel = || Vec::with_capacity(entries);
        BenchSession {
            time: channel(),
            position: channel(),
            motor_torque: channel(),
            joint_torque: channel(),
            temperature: channel(),
            truth: TrueSignals {
                position: channel(),
                velocity: channel(),
                motor_torque: channel(),
                joint_torque: channel(),
                temperature: channel(),
                friction: channel(),
                scatter: channel(),
            },
            ..BenchSession::default()
        }
    }

    pub(super) fn push(&mut self, time: f64, logged: &Reading, temperature: f64) {
        self.time.push(time);
        self.position.push(logged.position);
        self.motor_torque.push(logged.motor_torque);
        self.joint_torque.push(logged.joint_torque);
        self.temperature.push(temperature);
    }
}

/// Every session's log, and the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchRecording {
    /// What is hidden.
    pub hidden: Vec<HiddenEffect>,
    /// At what strength.
    pub strength: f64,
    /// What the experimenter believes.
    pub believed: Believed,
    /// Every true parameter.
    pub truth: Vec<TrueParameter>,
    /// In order of their start.
    pub sessions: Vec<BenchSession>,
}

impl BenchRecording {
    /// Value of the joint's own parameter `name`; 0 where there is none.
    pub(super) fn joint_parameter(&self, name: &str) -> f64 {
        self.truth
            .iter()
            .find(|parameter| parameter.effect.is_none() && parameter.name == name)
            .map_or(0.0, |parameter| parameter.value)
    }
}

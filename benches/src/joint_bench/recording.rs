//! What a bench gives out.

use super::effect::Reading;
use super::hidden::believed_effects;
use super::{Believed, HiddenEffect, Motion};
use crate::bench::exchange;

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

    pub(super) fn push_friction(&mut self, friction: f64, scatter: f64) {
        self.friction.push(friction);
        self.scatter.push(scatter);
    }
}

/// One session's log: all channels one after another every `period`, by default
/// [`LOG_PERIOD`](super::LOG_PERIOD), all of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BenchSession {
    /// Since the first session's start \[s\].
    pub start: f64,
    /// Between two log entries \[s\].
    pub period: f64,
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
    /// What would be true on the same motion with nothing hidden beyond
    /// equation (4): the scatter is the same.
    pub without_hidden: TrueSignals,
}

impl BenchSession {
    pub(super) fn with_capacity(entries: usize) -> Self {
        let channel = || Vec::with_capacity(entries);
        let signals = || TrueSignals {
            position: channel(),
            velocity: channel(),
            motor_torque: channel(),
            joint_torque: channel(),
            temperature: channel(),
            friction: channel(),
            scatter: channel(),
        };
        BenchSession {
            time: channel(),
            position: channel(),
            motor_torque: channel(),
            joint_torque: channel(),
            temperature: channel(),
            truth: signals(),
            without_hidden: signals(),
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

    /// The same session with nothing hidden beyond equation (4): noise stays.
    fn cleared(&self) -> Self {
        let (truth, other) = (&self.truth, &self.without_hidden);
        BenchSession {
            position: exchange(&self.position, &truth.position, &other.position),
            motor_torque: exchange(&self.motor_torque, &truth.motor_torque, &other.motor_torque),
            joint_torque: exchange(&self.joint_torque, &truth.joint_torque, &other.joint_torque),
            truth: other.clone(),
            ..self.clone()
        }
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
    /// The same recording with nothing hidden: all of equation (4) is believed,
    /// and what effects beyond it add is taken out of what was logged. Motion,
    /// noise and what parameters scatter by stay. The believed model, fitted to
    /// this, reaches what the true model reaches on the recording.
    ///
    /// `truth` still lists the parameters of the joint that was recorded.
    pub fn without_hidden(&self) -> Self {
        BenchRecording {
            hidden: Vec::new(),
            strength: self.strength,
            believed: Believed {
                effects: believed_effects(&[]),
                ..self.believed
            },
            truth: self.truth.clone(),
            sessions: self.sessions.iter().map(BenchSession::cleared).collect(),
        }
    }

    /// Value of the joint's own parameter `name`; 0 where there is none.
    pub(super) fn joint_parameter(&self, name: &str) -> f64 {
        self.truth
            .iter()
            .find(|parameter| parameter.effect.is_none() && parameter.name == name)
            .map_or(0.0, |parameter| parameter.value)
    }
}

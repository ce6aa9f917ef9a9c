//! What a contact bench gives out.

use super::hidden::believed_effects;
use super::sensors::Reading;
use super::{HiddenEffect, Motion};
use crate::bench::exchange;

/// A true parameter of the edge, or of what it hides.
pub type TrueParameter = crate::bench::TrueParameter<HiddenEffect>;

/// What nobody on the bench can see, one entry a log entry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrueForces {
    /// Place of the motors without noise \[m\].
    pub place: Vec<f64>,
    /// F_T without noise \[N\].
    pub tangential: Vec<f64>,
    /// F_N without noise \[N\].
    pub normal: Vec<f64>,
    /// The part of F_T that is there only because this session's parameters
    /// are not the nominal ones \[N\].
    pub scatter: Vec<f64>,
}

impl TrueForces {
    pub(super) fn push(&mut self, exact: &Reading, scatter: f64) {
        self.place.push(exact.place);
        self.tangential.push(exact.tangential);
        self.normal.push(exact.normal);
        self.scatter.push(scatter);
    }
}

/// One session's log: all channels one after another every
/// [`LOG_PERIOD`](crate::bench::LOG_PERIOD), all of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactSession {
    /// Since the first session's start \[s\].
    pub start: f64,
    /// What it ran; none only for an empty session.
    pub motion: Option<Motion>,
    /// Since this session's start \[s\].
    pub time: Vec<f64>,
    /// Along the edge, as the motors say \[m\].
    pub place: Vec<f64>,
    /// F_T \[N\], positive where it opposes a motion towards larger places.
    pub tangential: Vec<f64>,
    /// F_N \[N\], positive when it pushes the tip out.
    pub normal: Vec<f64>,
    /// \[degC\]
    pub temperature: Vec<f64>,
    /// The truth behind it.
    pub truth: TrueForces,
    /// What would be true on the same way, under the same F_N and with the same
    /// scatter, with nothing hidden beyond Coulomb and viscous friction.
    pub without_hidden: TrueForces,
}

impl ContactSession {
    pub(super) fn with_capacity(entries: usize) -> Self {
        let channel = || Vec::with_capacity(entries);
        let forces = || TrueForces {
            place: channel(),
            tangential: channel(),
            normal: channel(),
            scatter: channel(),
        };
        ContactSession {
            time: channel(),
            place: channel(),
            tangential: channel(),
            normal: channel(),
            temperature: channel(),
            truth: forces(),
            without_hidden: forces(),
            ..ContactSession::default()
        }
    }

    pub(super) fn push(&mut self, time: f64, logged: &Reading, temperature: f64) {
        self.time.push(time);
        self.place.push(logged.place);
        self.tangential.push(logged.tangential);
        self.normal.push(logged.normal);
        self.temperature.push(temperature);
    }

    /// The same session with nothing hidden beyond Coulomb and viscous friction:
    /// noise stays.
    fn cleared(&self) -> Self {
        let (truth, other) = (&self.truth, &self.without_hidden);
        ContactSession {
            tangential: exchange(&self.tangential, &truth.tangential, &other.tangential),
            truth: other.clone(),
            ..self.clone()
        }
    }
}

/// Every session's log, and the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRecording {
    /// What is hidden.
    pub hidden: Vec<HiddenEffect>,
    /// At what strength.
    pub strength: f64,
    /// Ids of the effects in the model that the experimenter believes in.
    pub believed: Vec<&'static str>,
    /// Every true parameter.
    pub truth: Vec<TrueParameter>,
    /// In order of their start.
    pub sessions: Vec<ContactSession>,
}

impl ContactRecording {
    /// The same recording with nothing hidden: Coulomb and viscous friction are
    /// believed, and what effects beyond them add is taken out of F_T. Way, F_N,
    /// noise and what parameters scatter by stay. The believed model, fitted to
    /// this, reaches what the true model reaches on the recording.
    ///
    /// `truth` still lists the parameters of the edge that was recorded.
    pub fn without_hidden(&self) -> Self {
        ContactRecording {
            hidden: Vec::new(),
            strength: self.strength,
            believed: believed_effects(&[]),
            truth: self.truth.clone(),
            sessions: self.sessions.iter().map(ContactSession::cleared).collect(),
        }
    }

    /// Value of the edge's own parameter `name`; 0 where there is none.
    pub(super) fn edge_parameter(&self, name: &str) -> f64 {
        self.truth
            .iter()
            .find(|parameter| parameter.effect.is_none() && parameter.name == name)
            .map_or(0.0, |parameter| parameter.value)
    }
}

//! What is read of an experiment's recordings, whatever it is about.

use super::WorkError;
use crate::{
    experiment::Experiment,
    recording::{self, Tally},
};

/// What is read of an experiment's recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct WhatIsRead {
    /// Mean rate of what is used \[Hz\].
    pub rate_hz: f64,
    /// Share of all samples that is used.
    pub share_used: f64,
    /// What of each recording is used.
    pub recordings: Vec<Tally>,
    /// What was noticed while reading.
    pub notes: Vec<String>,
}

impl WhatIsRead {
    /// Reads the recordings of an experiment about a joint, a contact or an arm.
    pub(super) fn of(experiment: &Experiment) -> Result<WhatIsRead, WorkError> {
        let loaded = recording::load(experiment)?;
        let sessions = loaded.dataset.sessions.iter();
        let (samples, seconds) = sessions.fold((0, 0.0), |(samples, seconds), session| {
            let count = session.len();
            (samples + count, seconds + count as f64 * session.period)
        });
        let all: usize = loaded.tallies.iter().map(|tally| tally.samples).sum();
        let used = loaded.tallies.iter();
        let used = used.map(|tally| tally.used.saturating_sub(tally.bridged));
        Ok(WhatIsRead {
            rate_hz: samples as f64 / f64::max(seconds, f64::MIN_POSITIVE),
            share_used: used.sum::<usize>() as f64 / all.max(1) as f64,
            recordings: loaded.tallies,
            notes: loaded.notes,
        })
    }
}

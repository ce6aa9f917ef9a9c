//! What of a recording can be used, and what not, for which reason.

use std::path::{Path, PathBuf};

use ferntast_identification::comparison::Reason;
use serde::Serialize;

/// Samples of a recording's position by what became of them; they add up to
/// `samples`, but for those that bridge holes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tally {
    /// The recording.
    pub file: PathBuf,
    /// All of them.
    pub samples: usize,
    /// Used.
    pub used: usize,
    /// Stretches without a gap that these are.
    pub stretches: usize,
    /// Bridged by a straight line: holes of up to ten samples.
    pub bridged: usize,
    /// Not read, since the file is too long to be held: stretches all over it are.
    pub too_much: usize,
    /// Without a number.
    pub without_number: usize,
    /// With the time of the sample before.
    pub repeated_time: usize,
    /// That repeat the position until it is measured again.
    pub repeats: usize,
    /// Wrong readings of the position.
    pub wrong_readings: usize,
    /// Where another signal has a gap, or has not begun, or has ended.
    pub without_other_signal: usize,
    /// Where `valid` says no.
    pub not_valid: usize,
    /// In stretches too short to be used.
    pub in_short_stretches: usize,
    /// How many such stretches there are.
    pub short_stretches: usize,
    /// The longest stretch \[samples\].
    #[serde(skip)]
    pub longest: usize,
}

impl Tally {
    pub(super) fn new(file: &Path) -> Tally {
        Tally {
            file: file.to_owned(),
            ..Tally::default()
        }
    }

    /// What is left out: reason and samples, where there are any.
    #[must_use]
    pub fn left_out(&self) -> Vec<(Reason, usize)> {
        let all = [
            (Reason::NotRead, self.too_much),
            (Reason::WithoutNumber, self.without_number),
            (Reason::RepeatedTime, self.repeated_time),
            (Reason::Repeats, self.repeats),
            (Reason::WrongReading, self.wrong_readings),
            (Reason::OtherSignalMissing, self.without_other_signal),
            (Reason::NotValid, self.not_valid),
            (Reason::ShortStretch, self.in_short_stretches),
        ];
        let there = all.into_iter().filter(|(_, count)| *count > 0);
        there.collect()
    }

    /// Share of the samples that is used.
    #[must_use]
    pub fn share_used(&self) -> f64 {
        let used = self.used.saturating_sub(self.bridged);
        used as f64 / self.samples.max(1) as f64
    }
}

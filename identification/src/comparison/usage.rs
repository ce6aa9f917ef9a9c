//! What of the recordings is used, and what is left out for which reason.
//!
//! A row of the regression stands for the samples around it: a sample is used
//! where its row is.

use std::collections::BTreeMap;

use ferntast_model::friction::SPEED;
use serde::Serialize;

use crate::data::{Dataset, RecordedSession};
use crate::design::{Design, PreparedModel};
use crate::numerics::filter::Kernel;
use crate::signals::{Filters, Motion, Signals, Sliding};

/// What becomes of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// Parameters are fitted to it; where no recordings are held out, it also
    /// validates while it is left out in its turn.
    Fitted,
    /// Held out: errors are measured on it.
    Validation,
    /// Fitted, but counts for no error: beyond the drive's or the sensor's limit.
    BeyondLimit,
    /// At the ends of a session, where filters look beyond it.
    FilterEdges,
    /// Near rest, where friction may have any value below the one that it slides with.
    Slow,
    /// Just after a reversal, where friction builds up.
    AfterReversal,
    /// The tip does not touch for certain.
    NoContact,
    /// An effect of the model depends on more there than is measured.
    Undetermined,
    /// Not read: the recording is longer than what is held at once.
    NotRead,
    /// Without a number.
    WithoutNumber,
    /// With the time of the sample before.
    RepeatedTime,
    /// Repeats of a value until the next is measured.
    Repeats,
    /// A wrong reading: out of line, or the same as before while the joint moved.
    WrongReading,
    /// Another signal has a gap there, has not begun or has ended.
    OtherSignalMissing,
    /// `valid` says no.
    NotValid,
    /// In a stretch too short to be used.
    ShortStretch,
}

impl Reason {
    /// In words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Fitted => "fitted",
            Self::Validation => "held out for validation",
            Self::BeyondLimit => "fitted, counted for no error: beyond a limit of drive or sensor",
            Self::FilterEdges => "at the ends of sessions, where filters look beyond",
            Self::Slow => "slower than the least speed at which the direction is certain",
            Self::AfterReversal => "just after a reversal",
            Self::NoContact => "without certain contact",
            Self::Undetermined => "not determined by what is measured, by an effect of the model",
            Self::NotRead => "not read: more than is held at once",
            Self::WithoutNumber => "without a number",
            Self::RepeatedTime => "with the time of the sample before",
            Self::Repeats => "repeats until the next value is measured",
            Self::WrongReading => "wrong readings of the position",
            Self::OtherSignalMissing => "where another signal is missing",
            Self::NotValid => "not valid",
            Self::ShortStretch => "in short stretches",
        }
    }

    /// Whether a verdict rests on it.
    #[must_use]
    pub const fn is_used(self) -> bool {
        matches!(self, Self::Fitted | Self::Validation)
    }
}

/// What is left out of the fit to measure its error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HeldOutBy {
    /// Recordings named for it.
    Recordings,
    /// Whole sessions in turn.
    Sessions,
    /// Blocks of time in turn.
    Blocks,
}

impl HeldOutBy {
    /// In words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Recordings => "recordings that are never fitted",
            Self::Sessions => "whole sessions left out in turn",
            Self::Blocks => "blocks of time left out in turn",
        }
    }

    /// What errors of the model are measured on.
    #[must_use]
    pub fn of(prepared: &PreparedModel, design: &Design) -> Self {
        match (prepared.held_out.is_empty(), design.leaves_sessions_out()) {
            (false, _) => Self::Recordings,
            (true, true) => Self::Sessions,
            (true, false) => Self::Blocks,
        }
    }
}

/// What of the recordings is used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Usage {
    /// Samples in the recordings, held-out ones too.
    pub samples: usize,
    /// Share of them that parameters are fitted to or errors measured on.
    pub share: f64,
    /// All of them by what becomes of them; they add up to `samples`.
    pub by_reason: BTreeMap<Reason, usize>,
    /// Rows of the regression that are fitted, each for several samples.
    pub rows: usize,
    /// What errors are measured on.
    pub held_out_by: HeldOutBy,
    /// Least and greatest |q̇| that is fitted; `None` of no rows.
    pub speed_range: Option<[f64; 2]>,
    /// Unit of speeds.
    pub speed_unit: &'static str,
    /// |q̇| below which the direction is not certain.
    pub least_speed: f64,
    /// Frequency \[Hz\] above which torque and columns are filtered away (−3 dB).
    pub cutoff_hz: f64,
    /// Why it is there.
    pub cutoff_reason: String,
}

impl Usage {
    /// Moves samples that never came this far into the account.
    pub fn add(&mut self, reason: Reason, samples: usize) {
        if samples == 0 {
            return;
        }
        *self.by_reason.entry(reason).or_default() += samples;
        self.samples += samples;
        self.share = self.used() as f64 / self.samples.max(1) as f64;
    }

    /// Samples that are used.
    #[must_use]
    pub fn used(&self) -> usize {
        let used = self.by_reason.iter().filter(|(reason, _)| reason.is_used());
        used.map(|(_, count)| count).sum()
    }

    /// What is left out: reason and samples, the most first.
    #[must_use]
    pub fn left_out(&self) -> Vec<(Reason, usize)> {
        let each = self
            .by_reason
            .iter()
            .map(|(reason, count)| (*reason, *count));
        let mut left: Vec<(Reason, usize)> = each.filter(|(own, _)| !own.is_used()).collect();
        left.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        left
    }

    /// Samples used, in words: "87 % of the samples".
    #[must_use]
    pub fn claim(&self) -> String {
        let percent = self.share * 100.0;
        let digits = usize::from(percent < 9.95);
        format!("{percent:.digits$} % of the samples")
    }
}

/// Accounts for every sample of `dataset`, to which the model is bound in `prepared`.
#[must_use]
pub fn find(dataset: &Dataset, prepared: &PreparedModel, design: &Design) -> Usage {
    let period = prepared.sessions.first().map_or(1.0, |s| s.period);
    let filters = &prepared.filters;
    let mut usage = Usage {
        samples: 0,
        share: 0.0,
        by_reason: BTreeMap::new(),
        rows: design.total().rows,
        held_out_by: HeldOutBy::of(prepared, design),
        speed_range: speed_range(&prepared.sessions),
        speed_unit: SPEED.of(dataset.joint),
        least_speed: match &filters.stated {
            Some(filter) => filter.least_speed,
            None => filters.rest_speed,
        },
        cutoff_hz: filters.cut_off(period),
        cutoff_reason: filters.why(),
    };
    let fitted = dataset.sessions.iter().zip(&prepared.sessions);
    let held_out = dataset.held_out.iter().zip(&prepared.held_out);
    for (recorded, signals) in fitted {
        count(&mut usage, recorded, signals, prepared, Reason::Fitted);
    }
    for (recorded, signals) in held_out {
        count(&mut usage, recorded, signals, prepared, Reason::Validation);
    }
    usage
}

fn speed_range(sessions: &[Signals]) -> Option<[f64; 2]> {
    let rows = sessions.iter().flat_map(|signals| {
        let rows = signals.rows.iter();
        rows.map(|at| signals.points[*at].velocity.abs())
    });
    let (low, high) = rows.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), speed| {
        (low.min(speed), high.max(speed))
    });
    low.is_finite().then_some([low, high])
}

/// Adds the samples of one session.
fn count(
    usage: &mut Usage,
    recorded: &RecordedSession,
    signals: &Signals,
    prepared: &PreparedModel,
    used: Reason,
) {
    let filters = &prepared.filters;
    let each = filters.thinning(recorded.period) * filters.stride.max(1);
    let mut left = recorded.len();
    let reasons = reasons(signals, prepared, used);
    for reason in reasons {
        usage.add(reason, each.min(left));
        left -= each.min(left);
    }
    usage.add(Reason::FilterEdges, left);
}

/// What becomes of each of the session's rows, those at rest among them.
fn reasons(signals: &Signals, prepared: &PreparedModel, used: Reason) -> Vec<Reason> {
    let filters = &prepared.filters;
    let motions = motions(signals, filters);
    let reach = match filters.stated {
        Some(_) => 0,
        None => Kernel::reach(filters.column),
    };
    let of_row = |row: &usize| {
        if signals.rows.binary_search(row).is_ok() {
            return match signals.unjudged_rows.binary_search(row) {
                Ok(_) => Reason::BeyondLimit,
                Err(_) => used,
            };
        }
        let near = row.saturating_sub(reach)..(row + reach + 1).min(motions.len());
        let is_near = |motion: Motion| motions[near.clone()].contains(&motion);
        let is_off = |least: f64| signals.points[near.clone()].iter().any(|p| p.load <= least);
        match filters.touching {
            Some(least) if is_off(least) => Reason::NoContact,
            _ if prepared.reversals && filters.touching.is_none() => Reason::Undetermined,
            _ if is_near(Motion::Slow) => Reason::Slow,
            _ if is_near(Motion::JustReversed) => Reason::AfterReversal,
            _ => Reason::Undetermined,
        }
    };
    signals.all_rows.iter().map(of_row).collect()
}

/// How the joint moves at every working sample.
fn motions(signals: &Signals, filters: &Filters) -> Vec<Motion> {
    let mut sliding = Sliding::default();
    let each = signals.points.iter();
    each.map(|point| match &filters.stated {
        Some(filter) if filter.is_slow(point.velocity) => Motion::Slow,
        Some(_) => Motion::Slides,
        None => sliding.motion(point, filters),
    })
    .collect()
}

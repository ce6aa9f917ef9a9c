//! Which parameter has changed, and whether by a step or by drift.

use serde::Serialize;

/// Smallest change of a parameter, in standard errors, that is significant \[1\],
const MIN_CHANGE: f64 = 5.0;
/// and smallest change of its part of the torque, as a share of the residual's band \[1\].
const MIN_TORQUE_CHANGE: f64 = 1.0;
/// Longest duration of a step, in memories of the estimator \[1\].
const MAX_STEP_DURATION: f64 = 1.0;
/// Seconds of history that are evaluated.
const MAX_HISTORY: usize = 1200;

/// A parameter whose value has changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Name of the parameter.
    pub parameter: String,
    /// Value before.
    pub before: f64,
    /// Value now.
    pub now: f64,
    /// Time at which half of the change was complete \[s\].
    pub time: f64,
    /// Duration from a tenth to nine tenths of the change \[s\].
    pub took: f64,
    /// Step or drift.
    pub kind: ChangeKind,
}

/// Course of a change in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ChangeKind {
    /// At once, within the response of the estimator.
    Step,
    /// Gradually, longer than the response of the estimator.
    Drift,
}

/// Estimates once a second, and the mean square of each column, by which changes
/// are expressed as torques.
#[derive(Clone, Debug, Default)]
pub(super) struct ChangeLog {
    times: Vec<f64>,
    /// One vector a second.
    values: Vec<Vec<f64>>,
    /// Mean square of each column.
    squares: Vec<f64>,
    rows: f64,
}

impl ChangeLog {
    /// Takes the estimates after a row.
    pub(super) fn note(&mut self, time: f64, phi: &[f64], estimates: &[f64]) {
        self.squares.resize(phi.len(), 0.0);
        self.rows += 1.0;
        let share = 1.0 / self.rows.min(2000.0);
        for (square, x) in self.squares.iter_mut().zip(phi) {
            *square += share * (x * x - *square);
        }
        if self.times.last().is_some_and(|last| time < last + 1.0) {
            return;
        }
        if self.times.len() >= MAX_HISTORY {
            self.times.remove(0);
            self.values.remove(0);
        }
        self.times.push(time);
        self.values.push(estimates.to_vec());
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// The parameter whose change is largest as a torque, if one differs from
    /// `reference`. `band` is the residual's standard deviation
    /// \[Nm\], `response` the estimator's memory in time \[s\].
    pub(super) fn find(
        &self,
        names: &[String],
        reference: &[f64],
        std_errors: &[f64],
        band: f64,
        response: f64,
    ) -> Option<Change> {
        let now = self.values.last()?;
        let moved = |i: usize| now.get(i).zip(reference.get(i)).map(|(now, was)| now - was);
        let worth = |i: usize| {
            let size = self.squares.get(i).copied().unwrap_or(0.0).sqrt();
            moved(i).map_or(0.0, |moved| moved.abs() * size)
        };
        let best = (0..names.len()).max_by(|a, b| worth(*a).total_cmp(&worth(*b)))?;
        let error = std_errors.get(best).copied().unwrap_or(f64::INFINITY);
        let way = moved(best)?;
        if way.abs() < MIN_CHANGE * error || worth(best) < MIN_TORQUE_CHANGE * band {
            return None;
        }
        let before = *reference.get(best)?;
        let reached = |share: f64| {
            let still = |values: &Vec<f64>| {
                values
                    .get(best)
                    .is_none_or(|value| (value - before) / way < share)
            };
            let last = self.values.iter().rposition(still);
            self.times.get(last.map_or(0, |last| last + 1)).copied()
        };
        let (early, half, late) = (reached(0.1)?, reached(0.5)?, reached(0.9)?);
        let took = late - early;
        Some(Change {
            parameter: names.get(best)?.clone(),
            before,
            now: before + way,
            time: half,
            took,
            kind: if took < MAX_STEP_DURATION * response {
                ChangeKind::Step
            } else {
                ChangeKind::Drift
            },
        })
    }
}

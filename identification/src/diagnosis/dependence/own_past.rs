//! A residual that its own past tells: what swings after each stroke anew, or creeps, goes with
//! no signal and keeps no step with time, and yet is no noise.

use crate::design::{Design, PreparedModel};
use crate::signals::Signals;
use crate::validation::{Score, gain_within};

/// Rows back in time by which a row is predicted. The filters make nearer ones alike.
const LAGS: std::ops::Range<usize> = 4..12;
/// Rows over which a swing is looked for.
const LONGEST_PERIOD: usize = 100;
/// Correlation a period later, at least, of what swings.
const LEAST_CORRELATION: f64 = 0.2;

/// What the past tells of a residual.
pub(super) struct OwnPast {
    /// What it explains of rows left out.
    pub(super) score: Score,
    /// Of what swings, the period of the swing \[s\].
    pub(super) period: Option<f64>,
}

/// Predicts each session's residual, with parameters of its own, by the rows before.
pub(super) fn find(prepared: &PreparedModel, design: &Design) -> OwnPast {
    let stride = prepared.filters.stride.max(1);
    let sessions = design.sessions.iter().zip(&prepared.sessions);
    let pasts: Vec<Past> = sessions
        .map(|(session, signals)| Past::new(signals, &session.own_residual(), stride))
        .collect();
    let columns: Vec<Vec<Vec<f64>>> = pasts
        .iter()
        .map(|past| LAGS.map(|lag| past.column(lag)).collect())
        .collect();
    let step = prepared
        .sessions
        .first()
        .map(|own| own.period * stride as f64);
    OwnPast {
        score: gain_within(design, &design.with(&columns)),
        period: swing(&pasts).zip(step).map(|(rows, step)| rows * step),
    }
}

/// A session's residual where its rows are in time.
struct Past {
    /// Of each row, in steps from one row to the next.
    places: Vec<usize>,
    /// At each step; zero where there is no row.
    residual: Vec<f64>,
}

impl Past {
    fn new(signals: &Signals, residual: &[f64], stride: usize) -> Self {
        let places: Vec<usize> = signals.rows.iter().map(|at| at / stride).collect();
        let mut at_steps = vec![0.0; places.last().map_or(0, |last| last + 1)];
        for (place, residual) in places.iter().zip(residual) {
            at_steps[*place] = *residual;
        }
        Self {
            places,
            residual: at_steps,
        }
    }

    /// The residual `lag` steps before each row.
    fn column(&self, lag: usize) -> Vec<f64> {
        let before = |place: &usize| Some(self.residual[place.checked_sub(lag)?]);
        let each = self.places.iter();
        each.map(|place| before(place).unwrap_or(0.0)).collect()
    }

    /// Σ r(t) r(t − lag).
    fn product(&self, lag: usize) -> f64 {
        let later = self.residual.iter().skip(lag);
        later.zip(&self.residual).map(|(a, b)| a * b).sum()
    }
}

/// Steps after which the residual is most like itself again, once it has been its opposite.
fn swing(pasts: &[Past]) -> Option<f64> {
    let product = |lag: usize| pasts.iter().map(|past| past.product(lag)).sum::<f64>();
    let all = product(0);
    let correlation: Vec<f64> = (0..=LONGEST_PERIOD).map(|lag| product(lag) / all).collect();
    let opposite = correlation.iter().position(|own| *own < 0.0)?;
    let later = opposite..correlation.len();
    let most = later.max_by(|a, b| correlation[*a].total_cmp(&correlation[*b]))?;
    let [before, at, after] = [most - 1, most, most + 1].map(|lag| correlation.get(lag).copied());
    // The vertex of the parabola through three.
    let (before, at, after) = (before?, at?, after?);
    let curvature = before - 2.0 * at + after;
    let vertex = most as f64 + 0.5 * (before - after) / curvature;
    (at > LEAST_CORRELATION && curvature < 0.0).then_some(vertex)
}

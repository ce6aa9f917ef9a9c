//! The model against the recordings.

pub mod extrapolation;
pub mod noise_floor;
pub mod parts;
pub mod residual_map;
pub mod simulation;
pub mod usage;
pub mod varies_together;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::data::error::PrepareError;
use crate::data::{Dataset, ModelSpec};
use crate::design::{Design, PreparedModel, SessionDesign};
use crate::fit::{Parameter, Rms, Soundness, fit};
use crate::preparation::prepare;
use crate::signals::Signals;
use extrapolation::Extrapolation;
use noise_floor::NoiseFloor;
use residual_map::{Residual, ResidualMap, Window};
use simulation::{Simulation, simulate};
pub use usage::{HeldOutBy, Reason, Usage};
pub use varies_together::VariesTogether;

/// Largest number of points of a session in [`Comparison::series`].
const MAX_DRAWN_POINTS: usize = 2000;

/// The model against the recordings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Samples in the recordings that are fitted.
    pub samples: usize,
    /// What of the recordings is used, and what not, for which reason.
    pub used: Usage,
    /// Errors \[Nm\].
    pub rms: Rms,
    /// RMS of the residual over the RMS of the motor torque, on the rows fitted.
    pub relative_error: f64,
    /// The same on rows left out.
    pub relative_error_held_out: f64,
    /// What was left out of the fit for the errors on rows left out.
    pub held_out_by: HeldOutBy,
    /// Parameters by name.
    pub parameters: BTreeMap<String, Parameter>,
    /// Parameters that the data do not excite: standard error above the value.
    pub not_excited: Vec<String>,
    /// Whether they can be told apart, and are possible: `condition`, `inseparable`,
    /// `implausible`.
    #[serde(flatten)]
    pub soundness: Soundness,
    /// Signals and conditions that vary together from session to session.
    pub varies_together: Vec<VariesTogether>,
    /// RMS between repeats, and variation between sessions \[Nm\].
    pub noise: NoiseFloor,
    /// Residual over each signal.
    pub residual_maps: Vec<ResidualMap>,
    /// Stretches with the largest errors.
    pub worst: Vec<Window>,
    /// Held-out data beyond the fitted range.
    pub extrapolated: Vec<Extrapolation>,
    /// Predicted motion; `None` if the model has no positive inertia.
    pub simulation: Option<Simulation>,
    /// Measured and modelled torque over time, thinned for drawing; left out of
    /// the serialised form for its length.
    #[serde(skip)]
    pub series: Vec<Series>,
}

/// Signals of one session for drawing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Name of the session.
    pub session: String,
    /// Whether it was held out.
    pub held_out: bool,
    /// Time in it \[s\].
    pub time: Vec<f64>,
    /// q \[rad\].
    pub position: Vec<f64>,
    /// q̇ \[rad/s\].
    pub velocity: Vec<f64>,
    /// q̈ \[rad/s²\].
    pub acceleration: Vec<f64>,
    /// τ, measured or modelled \[Nm\]; empty where nothing is known of it.
    pub load: Vec<f64>,
    /// Temperature \[degC\]; empty where there is none.
    pub temperature: Vec<f64>,
    /// Whether rows there count: near rest they do not.
    pub used: Vec<bool>,
    /// Measured τ_m, filtered \[Nm\].
    pub measured: Vec<f64>,
    /// Modelled τ_m \[Nm\].
    pub modelled: Vec<f64>,
}

/// Fits the model and reports its error, where it is large, and the noise.
///
/// # Errors
///
/// See [`PrepareError`].
pub fn compare(dataset: &Dataset, spec: &ModelSpec) -> Result<Comparison, PrepareError> {
    compare_drawing(dataset, spec, MAX_DRAWN_POINTS)
}

/// As [`compare()`], with up to `max_points` points of each session in
/// [`Comparison::series`].
///
/// # Errors
///
/// See [`PrepareError`].
pub fn compare_drawing(
    dataset: &Dataset,
    spec: &ModelSpec,
    max_points: usize,
) -> Result<Comparison, PrepareError> {
    let prepared = prepare(dataset, spec)?;
    Ok(compare_prepared(dataset, &prepared, max_points))
}

pub(crate) fn compare_prepared(
    dataset: &Dataset,
    prepared: &PreparedModel,
    max_points: usize,
) -> Comparison {
    let design = Design::new(prepared);
    let fitted = fit(prepared, &design);
    let shown: &[Signals] = if prepared.held_out.is_empty() {
        &prepared.sessions
    } else {
        &prepared.held_out
    };
    let residuals: Vec<Residual<'_>> = shown
        .iter()
        .map(|signals| {
            let rows = SessionDesign::new(prepared, signals, &signals.rows, 1);
            Residual {
                signals,
                rows: &signals.rows,
                values: rows.residual(&fitted.coefficients),
            }
        })
        .collect();
    let torque = torque_rms(&prepared.sessions);
    Comparison {
        samples: dataset
            .sessions
            .iter()
            .map(crate::data::RecordedSession::len)
            .sum(),
        used: usage::find(dataset, prepared, &design),
        rms: Rms {
            train: fitted.train,
            held_out: fitted.held_out,
        },
        relative_error: fitted.train / torque,
        relative_error_held_out: fitted.held_out / torque_rms(shown),
        held_out_by: HeldOutBy::of(prepared, &design),
        varies_together: varies_together::find(dataset),
        noise: noise_floor::find(prepared, &design),
        residual_maps: residual_map::maps(&residuals, &prepared.facts),
        worst: residual_map::worst(&residuals),
        extrapolated: extrapolation::find(prepared),
        simulation: simulate(prepared, shown, &fitted.coefficients),
        series: prepared
            .sessions
            .iter()
            .map(|s| series(prepared, s, false, max_points, &fitted.coefficients))
            .chain(
                prepared
                    .held_out
                    .iter()
                    .map(|s| series(prepared, s, true, max_points, &fitted.coefficients)),
            )
            .collect(),
        parameters: fitted.parameters,
        not_excited: fitted.not_excited,
        soundness: fitted.soundness,
    }
}

/// RMS of the filtered motor torque on the rows of the regression.
fn torque_rms(sessions: &[Signals]) -> f64 {
    let (mut square, mut count) = (0.0, 0_usize);
    for signals in sessions {
        let smooth = &signals.column;
        for value in smooth.at_samples(&signals.raw.motor_torque, &signals.rows) {
            square += value * value;
            count += 1;
        }
    }
    (square / count.max(1) as f64).sqrt().max(1e-300)
}

fn series(
    prepared: &PreparedModel,
    signals: &Signals,
    held_out: bool,
    max_points: usize,
    coefficients: &nalgebra::DVector<f64>,
) -> Series {
    let first = signals.all_rows.first().copied().unwrap_or(0);
    let end = signals.all_rows.last().map_or(0, |last| last + 1);
    let step = end.saturating_sub(first).div_ceil(max_points.max(1)).max(1);
    let rows: Vec<usize> = (first..end).step_by(step).collect();
    let design = SessionDesign::new(prepared, signals, &rows, 1);
    let residual = design.residual(coefficients);
    let smooth = &signals.column;
    let measured = smooth.at_samples(&signals.raw.motor_torque, &rows);
    Series {
        session: signals.name.clone(),
        held_out,
        time: rows.iter().map(|at| signals.time(*at)).collect(),
        position: rows.iter().map(|at| signals.points[*at].position).collect(),
        velocity: rows.iter().map(|at| signals.points[*at].velocity).collect(),
        acceleration: rows
            .iter()
            .map(|at| signals.points[*at].acceleration)
            .collect(),
        load: match prepared.facts.loaded {
            true => rows.iter().map(|at| signals.points[*at].load).collect(),
            false => Vec::new(),
        },
        temperature: match prepared.facts.temperature {
            true => rows
                .iter()
                .map(|at| signals.points[*at].temperature + prepared.facts.reference_temperature)
                .collect(),
            false => Vec::new(),
        },
        modelled: measured.iter().zip(&residual).map(|(m, r)| m - r).collect(),
        used: rows.iter().map(|at| is_used(signals, *at)).collect(),
        measured,
    }
}

/// Whether the row of the regression next to working sample `at` counts.
fn is_used(signals: &Signals, at: usize) -> bool {
    let after = signals.all_rows.partition_point(|row| *row < at);
    let near = [after.checked_sub(1), Some(after)];
    let near = near
        .into_iter()
        .flatten()
        .filter_map(|n| signals.all_rows.get(n));
    near.min_by_key(|row| row.abs_diff(at))
        .is_some_and(|row| signals.rows.binary_search(row).is_ok())
}

//! The model against the recordings.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::data::{Dataset, ModelSpec};
use crate::design::{Design, SessionDesign};
use crate::diagnose::Rms;
use crate::error::PrepareError;
use crate::extrapolation::{self, Extrapolation};
use crate::fit::{Parameter, fit};
use crate::noise_floor::{self, NoiseFloor};
use crate::residual_map::{self, Residual, ResidualMap, Window};
use crate::setup::Setup;
use crate::signals::Signals;
use crate::simulate::{Simulation, simulate};

/// Points of a session that are drawn, at most.
const DRAWN: usize = 2000;

/// The model against the recordings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Samples in the recordings.
    pub samples: usize,
    /// Rows of the regression: filtered, thinned, away from rest.
    pub used: usize,
    /// Errors \[Nm\].
    pub rms: Rms,
    /// RMS of the residual over the RMS of the motor torque, on the rows fitted.
    pub relative_error: f64,
    /// The same on rows left out.
    pub relative_error_held_out: f64,
    /// How rows were left out: `recordings`, `sessions` or `blocks`.
    pub held_out_by: HeldOutBy,
    /// Parameters by name.
    pub parameters: BTreeMap<String, Parameter>,
    /// Parameters that the data do not excite: standard error above the value.
    pub not_excited: Vec<String>,
    /// Condition of the normalised normal equations.
    pub condition: f64,
    /// RMS between repeats, and scatter between sessions \[Nm\].
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

/// Fits the model, and says how well it does and where it fails.
///
/// # Errors
///
/// See [`PrepareError`].
pub fn compare(dataset: &Dataset, spec: &ModelSpec) -> Result<Comparison, PrepareError> {
    compare_drawing(dataset, spec, DRAWN)
}

/// As [`compare()`], with up to `most` points of each session in
/// [`Comparison::series`].
///
/// # Errors
///
/// See [`PrepareError`].
pub fn compare_drawing(
    dataset: &Dataset,
    spec: &ModelSpec,
    most: usize,
) -> Result<Comparison, PrepareError> {
    let setup = Setup::new(dataset, spec)?;
    Ok(compare_setup(dataset, &setup, most))
}

pub(crate) fn compare_setup(dataset: &Dataset, setup: &Setup, most: usize) -> Comparison {
    let design = Design::new(setup);
    let fitted = fit(setup, &design);
    let shown: &[Signals] = if setup.held_out.is_empty() {
        &setup.sessions
    } else {
        &setup.held_out
    };
    let residuals: Vec<Residual<'_>> = shown
        .iter()
        .map(|signals| {
            let rows = SessionDesign::new(setup, signals, &signals.rows, 1);
            Residual {
                signals,
                rows: &signals.rows,
                values: difference(&rows, &fitted.coefficients),
            }
        })
        .collect();
    let torque = torque_rms(&setup.sessions);
    Comparison {
        samples: dataset.sessions.iter().map(crate::data::Session::len).sum(),
        used: design.total().rows,
        rms: Rms {
            train: fitted.train,
            held_out: fitted.held_out,
        },
        relative_error: fitted.train / torque,
        relative_error_held_out: fitted.held_out / torque_rms(shown),
        held_out_by: if !setup.held_out.is_empty() {
            HeldOutBy::Recordings
        } else if design.folds.len() == setup.sessions.len() {
            HeldOutBy::Sessions
        } else {
            HeldOutBy::Blocks
        },
        noise: noise_floor::find(
            setup,
            &design,
            crate::validation::left_out(&design, &design.own()),
        ),
        residual_maps: residual_map::maps(&residuals, &setup.facts),
        worst: residual_map::worst(&residuals),
        extrapolated: extrapolation::find(setup),
        simulation: simulate(setup, shown, &fitted.coefficients),
        series: setup
            .sessions
            .iter()
            .map(|s| series(setup, s, false, most, &fitted.coefficients))
            .chain(
                setup
                    .held_out
                    .iter()
                    .map(|s| series(setup, s, true, most, &fitted.coefficients)),
            )
            .collect(),
        parameters: fitted.parameters,
        not_excited: fitted.not_excited,
        condition: fitted.condition,
    }
}

/// Measured less modelled, row by row.
fn difference(rows: &SessionDesign, coefficients: &nalgebra::DVector<f64>) -> Vec<f64> {
    let mut residual = rows.measured.clone();
    for (column, c) in rows.base.iter().zip(coefficients.iter()) {
        residual
            .iter_mut()
            .zip(column)
            .for_each(|(r, x)| *r -= c * x);
    }
    residual
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
    setup: &Setup,
    signals: &Signals,
    held_out: bool,
    most: usize,
    coefficients: &nalgebra::DVector<f64>,
) -> Series {
    let first = signals.all_rows.first().copied().unwrap_or(0);
    let end = signals.all_rows.last().map_or(0, |last| last + 1);
    let step = end.saturating_sub(first).div_ceil(most.max(1)).max(1);
    let rows: Vec<usize> = (first..end).step_by(step).collect();
    let design = SessionDesign::new(setup, signals, &rows, 1);
    let residual = difference(&design, coefficients);
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
        load: match setup.facts.loaded {
            true => rows.iter().map(|at| signals.points[*at].load).collect(),
            false => Vec::new(),
        },
        temperature: match setup.facts.temperature {
            true => rows
                .iter()
                .map(|at| signals.points[*at].temperature + setup.facts.reference_temperature)
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

//! The model held against the joint while it moves.
//!
//! A [`Twin`] is made of the model and the recordings of an experiment, and is
//! fed samples as they come, live or played back. For each row it gives the
//! motor torque that the model as identified off line predicts, the residual,
//! and current estimates of the parameters ([`RecursiveLeastSquares`]).
//! [`Twin::assess`] diagnoses what came in so far: on which signals the residual
//! depends, and which effect is missing.
//!
//! Pure and deterministic: the same samples give the same bytes.

mod band;
mod change;
mod fastest;
mod history;
mod recent_samples;
mod sample;
mod sensors;
mod stream;
#[cfg(test)]
mod tests;

pub use change::{Change, ChangeKind};
pub use sample::{Flag, TwinOutput, TwinSample};

use ferntast_model::friction::{self, Signal};
use ferntast_model::recursive_least_squares::{
    Forgetting, Prior, PriorError, RecursiveLeastSquares, Update,
};
use serde::Serialize;

use crate::data::error::PrepareError;
use crate::data::{Dataset, ModelSpec};
use crate::design::{Design, PreparedModel};
use crate::diagnosis::{Diagnosis, diagnose};
use crate::effects::BoundTerm;
use crate::fit::{Fit, fit};
use crate::preparation::prepare;

use change::ChangeLog;
use fastest::Fastest;
use recent_samples::RecentSamples;
use sample::TwinRow;
use sensors::Sensors;
use stream::Stream;

/// Longest time \[s\] between samples of one session: after a longer one filters and
/// states start over.
const GAP: f64 = 0.5;
/// Rows over which the squared residual is averaged.
const BAND_ROWS: f64 = 200.0;

/// A parameter, off line and on line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TwinParameter {
    /// Name as in the lab.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// Value found off line, in the recordings of the experiment.
    pub off_line: f64,
    /// Current estimate.
    pub value: f64,
    /// Standard error of the current estimate.
    pub std_error: f64,
    /// Excitation \[1\]: 0 where the motion so far holds no information about the
    /// parameter, towards 1 where it determines the parameter.
    pub excitation: f64,
    /// Whether the estimate is held at a bound.
    pub at_bound: bool,
}

/// Why a twin cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TwinError {
    /// Recordings and model do not go together.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// An effect looks ahead in time, or acts on the model's own prediction.
    #[error(
        "{0} cannot be followed on line: it looks ahead in time; leave it out of the twin's model"
    )]
    NotOnLine(String),
    /// An effect reads a signal of its own.
    #[error(
        "{0} reads an extra signal, which the twin does not get; leave it out of the twin's model"
    )]
    Extra(String),
    /// The experiment states a filter of its own, over whole recordings.
    #[error(
        "the experiment states a [filter], which works on whole recordings only; leave it out of the twin's experiment"
    )]
    StatedFilter,
    /// The estimator cannot start.
    #[error(transparent)]
    Prior(#[from] PriorError),
}

/// A fitted model that runs beside the joint.
#[derive(Clone)]
pub struct Twin {
    spec: ModelSpec,
    joint: crate::data::JointType,
    stream: Stream,
    estimator: RecursiveLeastSquares,
    names: Vec<(String, String)>,
    off_line: Vec<f64>,
    off_line_errors: Vec<f64>,
    fastest: Fastest,
    /// Shapes, and T₀ where the temperature is measured: as found off line.
    fixed: Vec<TwinParameter>,
    band: f64,
    /// Mean square above which the residual has left its band \[Nm²\].
    limit: f64,
    /// Time that the estimator remembers \[s\].
    response: f64,
    changes: ChangeLog,
    recent: RecentSamples,
    last: Option<TwinSample>,
    sensors: Sensors,
    /// Whether a sensor was stuck at the last sample.
    stuck: bool,
    mean_square: f64,
    rows: Vec<TwinRow>,
    settled_rows: f64,
}

impl Twin {
    /// A twin of the joint in `dataset`, with the model `spec` fitted to it.
    ///
    /// # Errors
    ///
    /// See [`TwinError`].
    pub fn new(dataset: &Dataset, spec: &ModelSpec, memory: f64) -> Result<Self, TwinError> {
        if dataset.filter.is_some() {
            return Err(TwinError::StatedFilter);
        }
        let prepared = prepare(dataset, spec)?;
        for term in &prepared.terms {
            let id = || term.effect.description().id.clone();
            if term.effect.row().needs_prediction || term.effect.whole(&term.shape, &[]).is_some() {
                return Err(TwinError::NotOnLine(id()));
            }
            if !term.effect.extra().is_empty() {
                return Err(TwinError::Extra(id()));
            }
        }
        let design = Design::new(&prepared);
        let fitted = fit(&prepared, &design);
        let off_line: Vec<f64> = fitted.coefficients.iter().copied().collect();
        let band = fitted.train.max(1e-9);
        let total = design.total();
        let torque = (total.square() / total.rows.max(1) as f64).sqrt();
        let priors: Vec<Prior> = off_line
            .iter()
            .enumerate()
            .map(|(i, value)| {
                let size = (total.products[(i, i)] / total.rows.max(1) as f64).sqrt();
                let worth = if size > 0.0 { torque / size } else { 1.0 };
                let std_dev = worth.max(value.abs()).max(1e-9);
                Prior {
                    value: *value,
                    std_dev,
                    lower: value - 20.0 * std_dev,
                    upper: value + 20.0 * std_dev,
                }
            })
            .collect();
        let period = dataset.sessions.first().map_or(0.01, |s| s.period);
        let filters = &prepared.filters;
        let row_period = period * (filters.thinning(period) * filters.stride.max(1)) as f64;
        let forgetting = Forgetting::Variable {
            memory: (memory / row_period).max(20.0),
            least: 0.95,
        };
        let joint = dataset.joint;
        let names: Vec<(String, String)> = prepared
            .terms
            .iter()
            .flat_map(|term| term.effect.description().coefficients.clone())
            .map(|quantity| (quantity.name.clone(), quantity.unit.of(joint).to_owned()))
            .collect();
        let mut twin = Self {
            spec: spec.clone(),
            joint,
            stream: Stream::new(&prepared, period, &off_line),
            estimator: RecursiveLeastSquares::new(&priors, band, forgetting)?,
            off_line_errors: errors_of(&fitted, &names),
            fastest: Fastest::new(memory),
            fixed: fixed(&prepared),
            names,
            off_line,
            band,
            limit: f64::INFINITY,
            response: memory,
            changes: ChangeLog::default(),
            recent: RecentSamples::new(period),
            last: None,
            sensors: Sensors::new(torque, prepared.facts.travel()),
            stuck: false,
            mean_square: 0.0,
            rows: Vec::new(),
            settled_rows: 0.0,
        };
        twin.limit = twin.limit_of(dataset);
        Ok(twin)
    }

    /// Takes a sample; appends the rows that it completes to `outputs`. Returns the
    /// fault of the sample, if it has one. Outputs are finite whatever the samples.
    pub fn push(&mut self, sample: &TwinSample, outputs: &mut Vec<TwinOutput>) -> Option<Flag> {
        if !(sample.time.is_finite() && sample.channels().iter().all(|x| x.is_finite())) {
            return Some(Flag::NotFinite);
        }
        let mut flag = None;
        match self.last {
            Some(last) if sample.time <= last.time && last.time - sample.time < GAP => {
                return Some(Flag::TimeBackwards);
            }
            Some(last) if (sample.time - last.time).abs() > GAP => flag = Some(Flag::Gap),
            Some(_) => flag = self.sensors.stuck(sample),
            None => {}
        }
        if self.last.is_none() || flag == Some(Flag::Gap) {
            self.stream.restart();
            self.sensors.restart();
            self.recent.begin_session(sample);
        }
        self.last = Some(*sample);
        if matches!(flag, Some(Flag::PositionStuck | Flag::JointTorqueStuck)) {
            self.stream.restart();
            self.stuck = true;
            return flag;
        }
        if std::mem::take(&mut self.stuck) {
            // Readings of a stuck sensor are not kept for an assessment.
            self.recent.begin_session(sample);
        }
        self.recent.push(sample);
        let mut rows = std::mem::take(&mut self.rows);
        self.stream.push(sample, &mut rows);
        for row in rows.drain(..) {
            outputs.push(self.learn(&row));
        }
        self.rows = rows;
        flag
    }

    /// Time from a sample to the row around it \[s\].
    #[must_use]
    pub fn delay(&self) -> f64 {
        self.stream.delay()
    }

    /// Standard deviation of the residual that the model left off line \[Nm\].
    #[must_use]
    pub fn band(&self) -> f64 {
        self.band
    }

    /// Root mean square of the latest residuals of the model off line \[Nm\].
    #[must_use]
    pub fn residual_rms(&self) -> f64 {
        self.mean_square.sqrt()
    }

    /// Whether the residual has left its band: over the last 200 rows or so it is
    /// larger than over any as many in the model's own recordings, by a margin.
    #[must_use]
    pub fn out_of_band(&self) -> bool {
        self.settled_rows >= BAND_ROWS && self.mean_square > self.limit
    }

    /// Current parameters: the coefficients that are estimated on line, then those
    /// that keep their values off line (shapes of effects, T₀), then the fastest speed that
    /// the estimates rest on, once there is one.
    #[must_use]
    pub fn parameters(&self) -> Vec<TwinParameter> {
        self.names
            .iter()
            .enumerate()
            .map(|(i, (name, unit))| TwinParameter {
                name: name.clone(),
                unit: unit.clone(),
                off_line: self.off_line.get(i).copied().unwrap_or(0.0),
                value: self.estimator.estimate().get(i).copied().unwrap_or(0.0),
                std_error: self.estimator.std_error(i),
                excitation: self.estimator.excitation(i),
                at_bound: self.estimator.at_bound(i),
            })
            .chain(self.fixed.iter().cloned())
            .chain(self.fastest.seen().map(|fastest| {
                let unit = friction::SPEED.of(self.joint);
                constant(friction::FASTEST_SEEN, unit, fastest)
            }))
            .collect()
    }

    /// The parameter that moved away from its value off line, if one did.
    #[must_use]
    pub fn change(&self) -> Option<Change> {
        let names: Vec<String> = self.names.iter().map(|(name, _)| name.clone()).collect();
        // Both ends of the way are uncertain.
        let std_errors: Vec<f64> = self
            .off_line_errors
            .iter()
            .enumerate()
            .map(|(i, off_line)| off_line.hypot(self.estimator.std_error(i)))
            .collect();
        self.changes.find(
            &names,
            &self.off_line,
            &std_errors,
            self.band,
            self.response,
        )
    }

    /// Diagnosis of all samples kept so far: whether the model is complete, which
    /// effect is missing, on which signals the residual depends.
    /// Takes as long as `ferntast lab diagnose` on as many samples.
    ///
    /// # Errors
    ///
    /// Too few samples, nothing excited: see [`PrepareError`].
    pub fn assess(&self) -> Result<Diagnosis, PrepareError> {
        let dataset = Dataset {
            sessions: self.recent.sessions(),
            held_out: Vec::new(),
            joint: self.joint,
            filter: None,
        };
        diagnose(&dataset, &self.spec, &mut |_| {})
    }

    fn learn(&mut self, row: &TwinRow) -> TwinOutput {
        let own = |theta: &[f64]| -> f64 { row.phi.iter().zip(theta).map(|(x, t)| x * t).sum() };
        let predicted = row.driven + own(&self.off_line);
        let followed = row.driven + self.estimator.predict(&row.phi);
        if row.slides {
            let residual = row.motor_torque - predicted;
            self.settled_rows += 1.0;
            self.fastest.see(row.time, row.velocity.abs());
            let share = 1.0 / self.settled_rows.min(BAND_ROWS);
            self.mean_square += share * (residual * residual - self.mean_square);
            let update = self
                .estimator
                .update(&row.phi, row.motor_torque - row.driven);
            if matches!(update, Update::Learned { .. }) {
                self.changes
                    .note(row.time, &row.phi, self.estimator.estimate());
            } else {
                self.changes.clear();
            }
        }
        TwinOutput {
            time: row.time,
            position: row.position,
            velocity: row.velocity,
            joint_torque: row.joint_torque,
            temperature: row.temperature,
            measured: row.motor_torque,
            predicted,
            followed,
            slides: row.slides,
        }
    }
}

/// What is told beside the coefficients, and is not estimated.
fn constant(name: &str, unit: &str, value: f64) -> TwinParameter {
    TwinParameter {
        name: name.to_owned(),
        unit: unit.to_owned(),
        off_line: value,
        value,
        std_error: 0.0,
        excitation: 1.0,
        at_bound: false,
    }
}

/// Shape parameters of the model's effects, and the temperature \[degC\] from
/// from which terms that read it count.
fn fixed(prepared: &PreparedModel) -> Vec<TwinParameter> {
    let shapes = prepared.terms.iter().flat_map(|term| {
        let quantities = term.effect.description().shape.iter().zip(&term.shape);
        quantities
            .map(|(own, value)| constant(&own.name, own.unit.of(prepared.facts.joint), *value))
    });
    let warmed = |term: &BoundTerm| {
        let effect = friction::effect(term.effect.row().id);
        effect.is_some_and(|own| own.reads(Signal::Temperature))
    };
    let reference = prepared.facts.reference_temperature;
    let reference = (prepared.terms.iter().any(warmed))
        .then(|| constant(friction::REFERENCE_TEMPERATURE, "degC", reference));
    shapes.chain(reference).collect()
}

/// Standard errors of the coefficients off line; zero where there is none.
fn errors_of(fitted: &Fit, names: &[(String, String)]) -> Vec<f64> {
    let error = |(name, _): &(String, String)| {
        let parameter = fitted.parameters.get(name);
        parameter.and_then(|own| own.std_error).unwrap_or(0.0)
    };
    names.iter().map(error).collect()
}

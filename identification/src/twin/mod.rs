//! The model held against the joint while it moves.
//!
//! A [`Twin`] is made of the model and the recordings of an experiment, and is
//! fed samples as they come, live or played back. For each row it gives the
//! motor torque that the model as identified off line predicts, the residual,
//! and the parameters as they are now ([`RecursiveLeastSquares`]).
//! [`Twin::assess`] puts the lab's own question to what came in so far: which
//! signals the residual goes with, and which effect is missing.
//!
//! Pure and deterministic: the same samples give the same bytes.

mod band;
mod change;
mod history;
mod sensors;
mod stream;
#[cfg(test)]
mod tests;

pub use change::{Change, ChangeKind};

use ferntast_model::friction::{self, Signal};
use ferntast_model::recursive_least_squares::{
    Forgetting, Prior, PriorError, RecursiveLeastSquares, Update,
};
use serde::Serialize;

use crate::data::{Dataset, ModelSpec, Session};
use crate::design::Design;
use crate::diagnose::{Diagnosis, diagnose};
use crate::error::PrepareError;
use crate::fit::{Fit, fit};
use crate::setup::{BoundTerm, Setup};

use change::ChangeLog;
use sensors::Sensors;
use stream::Stream;

/// A longer silence \[s\] ends a session: filters and states start over.
const GAP: f64 = 0.5;
/// No more samples than this are kept for an assessment.
const MAX_KEPT: usize = 600_000;
/// Samples are kept, and dropped when there are too many, by pieces of this length \[s\].
const SESSION: f64 = 60.0;
/// Sessions of fewer samples are left out of an assessment.
const SHORTEST: usize = 200;
/// The squared residual is averaged over this many rows.
const BAND_ROWS: f64 = 200.0;

/// What the joint is doing at one time; joint side of the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwinSample {
    /// Since any fixed moment \[s\].
    pub time: f64,
    /// q \[rad\].
    pub position: f64,
    /// τ_m \[Nm\].
    pub motor_torque: f64,
    /// τ \[Nm\], where it is measured.
    pub joint_torque: Option<f64>,
    /// T \[degC\], where it is measured.
    pub temperature: Option<f64>,
}

impl TwinSample {
    fn channels(&self) -> [f64; 4] {
        [
            self.position,
            self.motor_torque,
            self.joint_torque.unwrap_or(0.0),
            self.temperature.unwrap_or(0.0),
        ]
    }
}

/// One row of the regression, filtered.
#[derive(Clone, Debug, PartialEq)]
struct TwinRow {
    time: f64,
    position: f64,
    velocity: f64,
    joint_torque: f64,
    temperature: f64,
    motor_torque: f64,
    /// J q̈ + τ.
    driven: f64,
    phi: Vec<f64>,
    slides: bool,
}

/// What the twin says of one row.
#[derive(Clone, Debug, PartialEq)]
pub struct TwinOutput {
    /// Time of the samples that it is about \[s\].
    pub time: f64,
    /// q \[rad\].
    pub position: f64,
    /// q̇ \[rad/s\].
    pub velocity: f64,
    /// τ \[Nm\].
    pub joint_torque: f64,
    /// T \[degC\].
    pub temperature: f64,
    /// Measured τ_m, filtered \[Nm\].
    pub measured: f64,
    /// τ_m by the model as identified off line \[Nm\].
    pub predicted: f64,
    /// τ_m by the model with the parameters as they are now \[Nm\].
    pub followed: f64,
    /// Whether the joint slides; at rest friction has no value of its own, and
    /// the row is neither learned from nor counted.
    pub slides: bool,
}

/// What is wrong with a sample, or was with those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Flag {
    /// A number is not finite; the sample is left out.
    NotFinite,
    /// Time did not advance; the sample is left out.
    TimeBackwards,
    /// Time jumped; filters and states started again.
    Gap,
    /// The position has not changed by a bit while the motor torque did.
    PositionStuck,
    /// The joint torque has not changed by a bit while the joint moved.
    JointTorqueStuck,
}

/// A parameter as it is now.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TwinParameter {
    /// Name as in the lab.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value off line.
    pub off_line: f64,
    /// Value now.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
    /// 0 where the motion told nothing of it, towards 1 where it told all \[1\].
    pub excitation: f64,
    /// Held at a bound.
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

/// The model beside the joint.
#[derive(Clone)]
pub struct Twin {
    spec: ModelSpec,
    joint: crate::data::JointType,
    period: f64,
    stream: Stream,
    estimator: RecursiveLeastSquares,
    names: Vec<(String, String)>,
    off_line: Vec<f64>,
    off_line_errors: Vec<f64>,
    /// Shapes, and T₀ where the temperature is measured: as found off line.
    fixed: Vec<TwinParameter>,
    band: f64,
    /// Mean square above which the residual has left its band \[Nm²\].
    limit: f64,
    /// Time that the estimator remembers \[s\].
    response: f64,
    changes: ChangeLog,
    kept: Vec<Session>,
    kept_samples: usize,
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
        let setup = Setup::new(dataset, spec)?;
        for term in &setup.terms {
            let id = || term.effect.description().id.clone();
            if term.effect.row().needs_prediction || term.effect.whole(&term.shape, &[]).is_some() {
                return Err(TwinError::NotOnLine(id()));
            }
            if !term.effect.extra().is_empty() {
                return Err(TwinError::Extra(id()));
            }
        }
        let design = Design::new(&setup);
        let fitted = fit(&setup, &design);
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
        let row_period = period * (setup.filters.thinning * setup.filters.stride.max(1)) as f64;
        let forgetting = Forgetting::Variable {
            memory: (memory / row_period).max(20.0),
            least: 0.95,
        };
        let joint = dataset.joint;
        let names: Vec<(String, String)> = setup
            .terms
            .iter()
            .flat_map(|term| term.effect.description().coefficients.clone())
            .map(|quantity| (quantity.name.clone(), quantity.unit.of(joint).to_owned()))
            .collect();
        let mut twin = Self {
            spec: spec.clone(),
            joint,
            period,
            stream: Stream::new(&setup, period, &off_line),
            estimator: RecursiveLeastSquares::new(&priors, band, forgetting)?,
            off_line_errors: errors_of(&fitted, &names),
            fixed: fixed(&setup),
            names,
            off_line,
            band,
            limit: f64::INFINITY,
            response: memory,
            changes: ChangeLog::default(),
            kept: Vec::new(),
            kept_samples: 0,
            last: None,
            sensors: Sensors::new(torque, setup.facts.travel()),
            stuck: false,
            mean_square: 0.0,
            rows: Vec::new(),
            settled_rows: 0.0,
        };
        twin.limit = twin.limit_of(dataset);
        Ok(twin)
    }

    /// Takes a sample; appends what it completes to `outputs`. Returns what is
    /// wrong with it, if anything. Whatever comes, all that is told is finite.
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
            self.kept.push(self.session(sample));
        }
        self.last = Some(*sample);
        if matches!(flag, Some(Flag::PositionStuck | Flag::JointTorqueStuck)) {
            self.stream.restart();
            self.stuck = true;
            return flag;
        }
        if std::mem::take(&mut self.stuck) {
            // What a stuck sensor said is not for the lab.
            self.kept.push(self.session(sample));
        }
        self.keep(sample);
        let mut rows = std::mem::take(&mut self.rows);
        self.stream.push(sample, &mut rows);
        for row in rows.drain(..) {
            outputs.push(self.learn(&row));
        }
        self.rows = rows;
        flag
    }

    /// Time from a sample to what is said of it \[s\].
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

    /// The parameters as they are now: the coefficients that are followed, then
    /// what stays as it was found off line (shapes of effects, T₀).
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

    /// The lab's question put to all samples so far: whether the model is
    /// complete, which effect is missing, which signals the residual goes with.
    /// Takes as long as `ferntast lab diagnose` on as many samples.
    ///
    /// # Errors
    ///
    /// Too few samples, nothing excited: see [`PrepareError`].
    pub fn assess(&self) -> Result<Diagnosis, PrepareError> {
        let dataset = Dataset {
            sessions: joined(&self.kept),
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

    /// An empty session that begins with `sample`.
    fn session(&self, sample: &TwinSample) -> Session {
        let first = self.kept.first().map_or(sample.time, |first| first.start);
        Session {
            name: format!("from {:.1} s", sample.time - first),
            start: sample.time,
            period: self.period,
            joint_torque: sample.joint_torque.map(|_| Vec::new()),
            temperature: sample.temperature.map(|_| Vec::new()),
            ..Session::default()
        }
    }

    /// Keeps the newest value at each time of the session's grid.
    fn keep(&mut self, sample: &TwinSample) {
        let full = self
            .kept
            .last()
            .is_some_and(|session| sample.time - session.start > SESSION && session.period > 0.0);
        if full {
            // On the grid of the piece before, so that both can be joined.
            let next = self.kept.last().map(end).unwrap_or(sample.time);
            let mut piece = self.session(sample);
            piece.start = next;
            self.kept.push(piece);
        }
        let Some(session) = self.kept.last_mut() else {
            return;
        };
        let due = ((sample.time - session.start) / session.period + 0.5).floor() + 1.0;
        while (session.len() as f64) < due {
            session.position.push(sample.position);
            session.motor_torque.push(sample.motor_torque);
            if let Some(torques) = &mut session.joint_torque {
                torques.push(sample.joint_torque.unwrap_or(0.0));
            }
            if let Some(temperatures) = &mut session.temperature {
                temperatures.push(sample.temperature.unwrap_or(0.0));
            }
            self.kept_samples += 1;
        }
        if self.kept_samples > MAX_KEPT && self.kept.len() > 1 {
            self.kept_samples -= self.kept.remove(0).len();
        }
    }
}

/// Shape parameters of the model's effects, and the temperature \[degC\] from
/// which such as read it count.
fn fixed(setup: &Setup) -> Vec<TwinParameter> {
    let fixed = |name: &str, unit: &str, value: f64| TwinParameter {
        name: name.to_owned(),
        unit: unit.to_owned(),
        off_line: value,
        value,
        std_error: 0.0,
        excitation: 1.0,
        at_bound: false,
    };
    let shapes = setup.terms.iter().flat_map(|term| {
        let quantities = term.effect.description().shape.iter().zip(&term.shape);
        quantities.map(|(own, value)| fixed(&own.name, own.unit.of(setup.facts.joint), *value))
    });
    let warmed = |term: &BoundTerm| {
        let effect = friction::effect(term.effect.row().id);
        effect.is_some_and(|own| own.reads(Signal::Temperature))
    };
    let reference = setup.facts.reference_temperature;
    let reference = (setup.terms.iter().any(warmed))
        .then(|| fixed(friction::REFERENCE_TEMPERATURE, "degC", reference));
    shapes.chain(reference).collect()
}

/// Standard errors of the coefficients off line; zero where none could be told.
fn errors_of(fitted: &Fit, names: &[(String, String)]) -> Vec<f64> {
    let error = |(name, _): &(String, String)| {
        let parameter = fitted.parameters.get(name);
        parameter.and_then(|own| own.std_error).unwrap_or(0.0)
    };
    names.iter().map(error).collect()
}

/// When the sample after the last is due \[s\].
fn end(session: &Session) -> f64 {
    session.start + session.len() as f64 * session.period
}

/// Pieces that follow each other without a gap as one session each: what is
/// one session must not count as several where sessions are compared.
fn joined(pieces: &[Session]) -> Vec<Session> {
    let mut sessions: Vec<Session> = Vec::new();
    for piece in pieces {
        match sessions.last_mut() {
            Some(last) if (piece.start - end(last)).abs() < 0.5 * piece.period => {
                last.position.extend(&piece.position);
                last.motor_torque.extend(&piece.motor_torque);
                for (all, more) in [
                    (&mut last.joint_torque, &piece.joint_torque),
                    (&mut last.temperature, &piece.temperature),
                ] {
                    if let (Some(all), Some(more)) = (all, more) {
                        all.extend(more);
                    }
                }
            }
            _ => sessions.push(piece.clone()),
        }
    }
    sessions.retain(|session| session.len() > SHORTEST);
    sessions
}

//! The model fitted to all sessions: parameters with standard errors.

pub mod addition;
mod soundness;
mod standard_errors;

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::design::{Design, PreparedModel};
use crate::effects::with_columns;
use crate::numerics::statistics::t_quantile;
use crate::validation::left_out::LeftOut;
pub use soundness::{Implausible, Pair, Soundness};
use standard_errors::Uncertainty;

/// Root mean square errors \[Nm\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rms {
    /// On the rows fitted.
    pub train: f64,
    /// On rows left out.
    pub held_out: f64,
}

/// A parameter of the fitted model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Estimate, or the value found by search.
    pub value: f64,
    /// Standard error by leaving sessions (or blocks of time) out in turn, which
    /// allows for autocorrelation; `None` for what is chosen, not measured, or
    /// searched by its influence on the measured channels.
    pub std_error: Option<f64>,
    /// Degrees of freedom of the standard error: sessions (or blocks of time), less one.
    pub freedom: Option<f64>,
    /// Interval that holds the true value with a probability of 95 %, by Student's
    /// distribution.
    pub interval_95: Option<[f64; 2]>,
    /// Unit of all.
    pub unit: String,
    /// Id of the effect that it belongs to.
    pub effect: String,
}

impl Parameter {
    /// With a standard error of so many degrees of `freedom`.
    #[must_use]
    pub fn measured(
        value: f64,
        (std_error, freedom): (f64, f64),
        unit: &str,
        effect: &str,
    ) -> Self {
        let half = t_quantile(0.975, freedom) * std_error;
        Self {
            value,
            std_error: Some(std_error),
            freedom: Some(freedom),
            interval_95: Some([value - half, value + half]),
            unit: unit.to_owned(),
            effect: effect.to_owned(),
        }
    }

    /// The same parameter counted from elsewhere: of a correction in place of the whole.
    pub fn shift(&mut self, by: f64) {
        self.value += by;
        if let Some(interval) = &mut self.interval_95 {
            interval.iter_mut().for_each(|end| *end += by);
        }
    }
}

/// A model fitted to all sessions together.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Coefficients of all columns, term by term.
    pub coefficients: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Root mean square of the residual on the rows fitted \[Nm\].
    pub train: f64,
    /// The same on rows left out: explicit held-out sessions, else folds \[Nm\].
    pub held_out: f64,
    /// The residuals that it is of.
    pub left_out: LeftOut,
    /// All parameters by name.
    pub parameters: BTreeMap<String, Parameter>,
    /// Names of parameters whose standard error exceeds their value, or which
    /// the data do not touch at all.
    pub not_excited: Vec<String>,
    /// Whether parameters can be told apart, and are possible.
    pub soundness: Soundness,
}

/// Fits the model to the rows of its sessions.
#[must_use]
pub fn fit(prepared: &PreparedModel, design: &Design) -> Fit {
    let coefficients = design.shared.clone();
    let uncertainty = Uncertainty::new(prepared, design);
    let left_out = LeftOut::new(prepared, design);
    let (parameters, not_excited, names) = name(prepared, &coefficients, &uncertainty);
    let base = design.base;
    Fit {
        train: error_on_judged_rows(design, &coefficients),
        held_out: left_out.rms(),
        left_out,
        covariance: uncertainty
            .covariance
            .view((0, 0), (base, base))
            .into_owned(),
        parameters,
        not_excited,
        soundness: Soundness::new(prepared, &uncertainty, coefficients.as_slice(), &names),
        coefficients,
    }
}

/// RMS \[Nm\] on the rows fitted that count for errors.
fn error_on_judged_rows(design: &Design, coefficients: &DVector<f64>) -> f64 {
    let (mut square, mut rows) = (0.0, 0_usize);
    for session in &design.sessions {
        let residual = session.residual(coefficients);
        for (residual, _) in (residual.iter().zip(&session.judged)).filter(|(_, judged)| **judged) {
            square += residual * residual;
            rows += 1;
        }
    }
    (square / rows.max(1) as f64).sqrt()
}

/// Where a parameter stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    /// Index of its term.
    term: usize,
    /// Its column, or that of the derivative by it; `None` where it is not measured.
    column: Option<usize>,
}

type Named = (
    BTreeMap<String, Parameter>,
    Vec<String>,
    Vec<(String, Place)>,
);

fn name(prepared: &PreparedModel, coefficients: &DVector<f64>, uncertainty: &Uncertainty) -> Named {
    let mut parameters = BTreeMap::new();
    let mut not_excited = Vec::new();
    let mut names = Vec::new();
    for (at, (term, columns)) in with_columns(&prepared.terms).enumerate() {
        let description = term.effect.description();
        let effect = &description.id;
        let joint = prepared.facts.joint;
        let mut insert = |name: &str, parameter: Parameter, column: Option<usize>| {
            // Two effects of the user's own may share a name.
            let name = if parameters.contains_key(name) {
                format!("{effect}.{name}")
            } else {
                name.to_owned()
            };
            parameters.insert(name.clone(), parameter);
            names.push((name.clone(), Place { term: at, column }));
            name
        };
        for (quantity, column) in description.coefficients.iter().zip(columns) {
            let value = coefficients[column];
            let both @ (error, _) = uncertainty.with_freedom(column);
            let parameter = Parameter::measured(value, both, quantity.unit.of(joint), effect);
            let name = insert(&quantity.name, parameter, Some(column));
            if error >= value.abs() || uncertainty.gram.products[(column, column)] <= 0.0 {
                not_excited.push(name);
            }
        }
        for (place, (quantity, value)) in description.shape.iter().zip(&term.shape).enumerate() {
            let column = uncertainty.column_of_shape(at, place);
            let unit = quantity.unit.of(joint);
            let both = column.map(|at| uncertainty.with_freedom(at));
            let parameter = match both {
                Some(both) => Parameter::measured(*value, both, unit, effect),
                None => Parameter {
                    value: *value,
                    std_error: None,
                    freedom: None,
                    interval_95: None,
                    unit: unit.to_owned(),
                    effect: effect.clone(),
                },
            };
            insert(&quantity.name, parameter, column);
        }
    }
    (parameters, not_excited, names)
}

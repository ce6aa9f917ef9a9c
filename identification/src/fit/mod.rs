//! The model fitted to all sessions: parameters with standard errors.

pub mod addition;

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::design::{Design, PreparedModel};
use crate::effects::with_columns;
use crate::numerics::gram::{Gram, pseudo_inverse};
use crate::validation::left_out::LeftOut;

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
    /// allows for autocorrelation; `None` for a shape parameter, which is searched.
    pub std_error: Option<f64>,
    /// Unit of value and standard error.
    pub unit: String,
    /// Id of the effect that it belongs to.
    pub effect: String,
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
    /// Ratio of the largest to the smallest eigenvalue of the normalised normal equations.
    pub condition: f64,
}

/// Fits the model to the rows of its sessions.
#[must_use]
pub fn fit(prepared: &PreparedModel, design: &Design) -> Fit {
    let total = design.total();
    let (coefficients, covariance) = (design.shared.clone(), design.covariance.clone());
    let left_out = LeftOut::new(prepared, design);
    let n = total.columns();
    let (_, condition) = pseudo_inverse(&total.products.view((0, 0), (n, n)).into_owned());
    let (parameters, not_excited) = name(prepared, &coefficients, &covariance, &total);
    Fit {
        train: error_on_judged_rows(design, &coefficients),
        held_out: left_out.rms(),
        left_out,
        coefficients,
        covariance,
        parameters,
        not_excited,
        condition,
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

type Named = (BTreeMap<String, Parameter>, Vec<String>);

fn name(
    prepared: &PreparedModel,
    coefficients: &DVector<f64>,
    covariance: &DMatrix<f64>,
    total: &Gram,
) -> Named {
    let mut parameters = BTreeMap::new();
    let mut not_excited = Vec::new();
    for (term, columns) in with_columns(&prepared.terms) {
        let description = term.effect.description();
        let effect = &description.id;
        let mut insert = |name: &str, parameter: Parameter| {
            // Two effects of the user's own may share a name.
            let name = if parameters.contains_key(name) {
                format!("{effect}.{name}")
            } else {
                name.to_owned()
            };
            parameters.insert(name.clone(), parameter);
            name
        };
        for (quantity, at) in description.coefficients.iter().zip(columns) {
            let (value, error) = (coefficients[at], covariance[(at, at)].max(0.0).sqrt());
            let name = insert(
                &quantity.name,
                Parameter {
                    value,
                    std_error: Some(error),
                    unit: quantity.unit.of(prepared.facts.joint).to_owned(),
                    effect: effect.clone(),
                },
            );
            if error >= value.abs() || total.products[(at, at)] <= 0.0 {
                not_excited.push(name);
            }
        }
        for (quantity, value) in description.shape.iter().zip(&term.shape) {
            insert(
                &quantity.name,
                Parameter {
                    value: *value,
                    std_error: None,
                    unit: quantity.unit.of(prepared.facts.joint).to_owned(),
                    effect: effect.clone(),
                },
            );
        }
    }
    (parameters, not_excited)
}

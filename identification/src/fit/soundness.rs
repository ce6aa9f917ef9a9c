//! Whether parameters can be believed: told apart by these data, and possible.

use nalgebra::DMatrix;
use serde::Serialize;

use super::Place;
use super::standard_errors::Uncertainty;
use crate::design::PreparedModel;
use crate::effects::with_columns;
use crate::numerics::gram::{Gram, pseudo_inverse};

/// Smallest correlation of two estimates that these data do not tell apart: the
/// variance of either is ten times what it would be with the other known.
const MIN_CORRELATION: f64 = 0.95;
/// Added to normalised squares, so that a pair that is exactly collinear is found, too.
const RIDGE: f64 = 1e-12;

/// Whether parameters can be believed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Soundness {
    /// Ratio of the largest to the smallest eigenvalue of the normalised normal
    /// equations; of no meaning in itself where pairs say more.
    pub condition: f64,
    /// Pairs of parameters that these data cannot tell apart: only a sum or a ratio
    /// of them is determined. The closest first.
    pub inseparable: Vec<Pair>,
    /// Parameters whose values no physics allows.
    pub implausible: Vec<Implausible>,
}

/// Two parameters whose estimates go together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// Their names.
    pub parameters: [String; 2],
    /// Correlation of the estimates, −1 … 1.
    pub correlation: f64,
}

/// A parameter beyond what is physically possible.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Implausible {
    /// Its name.
    pub parameter: String,
    /// Id of the effect that it belongs to.
    pub effect: String,
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub std_error: Option<f64>,
    /// The bound that it is beyond; `None` where what is possible is no range of one number.
    pub bound: Option<f64>,
    /// Unit of all.
    pub unit: String,
}

impl Pair {
    /// As a sentence.
    #[must_use]
    pub fn text(&self) -> String {
        let [a, b] = &self.parameters;
        format!(
            "these data cannot tell {a} from {b} (correlation {:+.3}): only both together are determined",
            self.correlation
        )
    }
}

impl Implausible {
    /// As a sentence.
    #[must_use]
    pub fn text(&self) -> String {
        let Self {
            parameter,
            effect,
            unit,
            ..
        } = self;
        let value = format!("{parameter} = {:.4} {unit}", self.value);
        let Some(bound) = self.bound else {
            return format!("{value}: not possible for {effect}");
        };
        let beyond = match self.std_error {
            Some(error) if error > 0.0 => {
                format!(
                    ", by {:.1} standard errors",
                    (bound - self.value).abs() / error
                )
            }
            _ => String::new(),
        };
        format!("{value} is below {bound} {unit}, which {effect} cannot be{beyond}")
    }
}

impl Soundness {
    /// Of a model whose parameters have these `names`.
    pub(super) fn new(
        prepared: &PreparedModel,
        uncertainty: &Uncertainty,
        coefficients: &[f64],
        names: &[(String, Place)],
    ) -> Self {
        let base = uncertainty.gram.columns() - uncertainty.shapes.len();
        let products = &uncertainty.gram.products;
        let (_, condition) = pseudo_inverse(&products.view((0, 0), (base, base)).into_owned());
        Self {
            condition,
            inseparable: inseparable(&uncertainty.gram, names),
            implausible: implausible(prepared, uncertainty, coefficients, names),
        }
    }
}

/// Correlations of the estimates of least squares: columns, and back.
fn correlations(gram: &Gram) -> Option<DMatrix<f64>> {
    let n = gram.columns();
    let scale = |i: usize| gram.products[(i, i)].max(0.0).sqrt();
    let normalised = DMatrix::from_fn(n, n, |i, j| {
        let size = scale(i) * scale(j);
        match (i == j, size > 0.0) {
            (true, _) => 1.0 + RIDGE,
            (false, true) => gram.products[(i, j)] / size,
            (false, false) => 0.0,
        }
    });
    let inverse = normalised.cholesky()?.inverse();
    Some(DMatrix::from_fn(n, n, |i, j| {
        inverse[(i, j)] / (inverse[(i, i)] * inverse[(j, j)]).sqrt()
    }))
}

fn inseparable(gram: &Gram, names: &[(String, Place)]) -> Vec<Pair> {
    let Some(correlations) = correlations(gram) else {
        return Vec::new();
    };
    let name = |column: usize| {
        let own = names.iter().find(|(_, place)| place.column == Some(column));
        own.map(|(name, _)| name.clone())
    };
    let mut pairs = Vec::new();
    for i in 0..gram.columns() {
        for j in 0..i {
            let correlation = correlations[(i, j)];
            if correlation.abs() < MIN_CORRELATION {
                continue;
            }
            if let (Some(a), Some(b)) = (name(j), name(i)) {
                pairs.push(Pair {
                    parameters: [a, b],
                    correlation,
                });
            }
        }
    }
    pairs.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    pairs
}

/// Coefficients below a bound of zero, where their effects have one, and effects
/// whose coefficients are not possible together.
fn implausible(
    prepared: &PreparedModel,
    uncertainty: &Uncertainty,
    coefficients: &[f64],
    names: &[(String, Place)],
) -> Vec<Implausible> {
    let mut found = Vec::new();
    for (at, (term, columns)) in with_columns(&prepared.terms).enumerate() {
        let description = term.effect.description();
        let row = term.effect.row();
        let first = found.len();
        let own = coefficients.get(columns.clone()).unwrap_or_default();
        for ((k, column), value) in columns.clone().enumerate().zip(own) {
            let lower = row.coefficients.get(k).map(|own| own.lower);
            // What is given counts, too: a correction may be negative.
            let given = match row.corrects_inertia {
                true => prepared.facts.inertia.unwrap_or(0.0),
                false => 0.0,
            };
            let is_bound = lower == Some(0.0) || row.corrects_inertia || row.is_inertia;
            if !is_bound || value + given >= 0.0 {
                continue;
            }
            let place = |(_, own): &&(String, Place)| own.term == at && own.column == Some(column);
            let Some((name, _)) = names.iter().find(place) else {
                continue;
            };
            let unit = description.coefficients.get(k).map(|own| own.unit);
            found.push(Implausible {
                parameter: name.clone(),
                effect: description.id.clone(),
                value: value + given,
                std_error: Some(uncertainty.of_coefficient(column)),
                bound: Some(0.0),
                unit: unit
                    .map_or("", |own| own.of(prepared.facts.joint))
                    .to_owned(),
            });
        }
        if found.len() == first && !term.effect.is_possible(&term.shape, own) {
            let place = |(_, own): &&(String, Place)| own.term == at;
            let Some((name, _)) = names.iter().find(place) else {
                continue;
            };
            let unit = description.coefficients.first().map(|own| own.unit);
            found.push(Implausible {
                parameter: name.clone(),
                effect: description.id.clone(),
                value: own.first().copied().unwrap_or(f64::NAN),
                std_error: Some(uncertainty.of_coefficient(columns.start)),
                bound: None,
                unit: unit
                    .map_or("", |own| own.of(prepared.facts.joint))
                    .to_owned(),
            });
        }
    }
    found
}

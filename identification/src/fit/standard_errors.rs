//! Standard errors of all parameters, those that are searched among them.
//!
//! Sessions, or blocks of time, are left out in turn (jackknife). Shape parameters
//! take part by the derivatives of their effects' columns: near the best shape s the
//! model c φ(s) is c φ + c ∂φ/∂s Δs, linear in c and Δs (Gauss–Newton). A coefficient
//! whose effect has a shape is less certain than it would be were the shape known.

use nalgebra::{DMatrix, DVector};

use crate::design::{Design, PreparedModel, columns};
use crate::effects::{BoundTerm, with_columns};
use crate::numerics::gram::Gram;
use crate::numerics::statistics::jackknife_covariance;
use crate::signals::Signals;

/// Step of a shape parameter, as a share of its value …
const STEP: f64 = 1e-4;
/// … and at least as a share of its bounds.
const LEAST_STEP: f64 = 1e-6;

/// How uncertain coefficients and shape parameters are, and how they go together.
pub struct Uncertainty {
    /// Covariance: coefficients, then shape parameters.
    pub covariance: DMatrix<f64>,
    /// Products of columns, then of the derivatives by shape parameters, and y.
    pub gram: Gram,
    /// Which shape parameters these are: term and place in its shape.
    pub shapes: Vec<(usize, usize)>,
    /// Degrees of freedom: what is left out in turn, less one.
    pub freedom: f64,
}

impl Uncertainty {
    /// Of the model fitted to `design`.
    #[must_use]
    pub fn new(prepared: &PreparedModel, design: &Design) -> Self {
        let shapes = searched(prepared);
        let grams = match shapes.is_empty() {
            true => design.own(),
            false => design.with(&derivatives(prepared, design, &shapes)),
        };
        let columns = design.base + shapes.len();
        let gram = Gram::sum(grams.iter().flatten(), columns);
        let best = gram.solve();
        let without: Vec<DVector<f64>> = (design.folds.iter())
            .map(|fold| {
                let block = |(s, b): &(usize, usize)| grams.get(*s)?.get(*b);
                let out = Gram::sum(fold.iter().filter_map(block), columns);
                gram.without(&out).solve()
            })
            .collect();
        Self {
            covariance: jackknife_covariance(&best, &without),
            gram,
            shapes,
            freedom: (design.folds.len() as f64 - 1.0).max(1.0),
        }
    }

    /// Standard error of a coefficient, by its column.
    #[must_use]
    pub fn of_coefficient(&self, column: usize) -> f64 {
        self.covariance[(column, column)].max(0.0).sqrt()
    }

    /// Column of a shape parameter, where it is searched.
    #[must_use]
    pub fn column_of_shape(&self, term: usize, place: usize) -> Option<usize> {
        let at = self.shapes.iter().position(|own| *own == (term, place))?;
        Some(self.gram.columns() - self.shapes.len() + at)
    }
}

/// Shape parameters of terms that act on torque, within bounds that leave them room.
fn searched(prepared: &PreparedModel) -> Vec<(usize, usize)> {
    let terms = prepared.terms.iter().enumerate();
    let own = terms.filter(|(_, term)| term.compensated.is_empty());
    own.flat_map(|(at, term)| {
        let bounds = term.effect.bounds(&prepared.facts);
        let places = (0..term.shape.len().min(bounds.len())).collect::<Vec<_>>();
        let has_room = move |place: &usize| bounds[*place][1] > bounds[*place][0];
        let places = places.into_iter().filter(has_room);
        places.map(move |place| (at, place))
    })
    .collect()
}

/// Σ c ∂φ/∂s, filtered: by session, shape parameter and row.
fn derivatives(
    prepared: &PreparedModel,
    design: &Design,
    shapes: &[(usize, usize)],
) -> Vec<Vec<Vec<f64>>> {
    let terms: Vec<_> = with_columns(&prepared.terms).collect();
    let of_session = |signals: &Signals| {
        let each = shapes.iter().filter_map(|(at, place)| {
            let (term, columns) = terms.get(*at)?;
            let coefficients = design.shared.rows(columns.start, columns.len());
            let coefficients: Vec<f64> = coefficients.iter().copied().collect();
            Some(derivative(prepared, signals, term, *place, &coefficients))
        });
        each.collect()
    };
    prepared.sessions.iter().map(of_session).collect()
}

fn derivative(
    prepared: &PreparedModel,
    signals: &Signals,
    term: &BoundTerm,
    place: usize,
    coefficients: &[f64],
) -> Vec<f64> {
    let inertia = prepared.facts.inertia.unwrap_or(0.0);
    let bounds = term.effect.bounds(&prepared.facts);
    let [low, high] = bounds.get(place).copied().unwrap_or_default();
    let step = (STEP * term.shape[place].abs()).max(LEAST_STEP * (high - low));
    let sum = |step: f64| {
        let mut shape = term.shape.clone();
        shape[place] += step;
        let columns = columns::filtered(
            signals,
            &prepared.filters,
            inertia,
            &term.effect,
            &shape,
            &signals.rows,
        );
        let mut sum = vec![0.0; signals.rows.len()];
        for (column, c) in columns.iter().zip(coefficients) {
            sum.iter_mut().zip(column).for_each(|(s, x)| *s += c * x);
        }
        sum
    };
    let (above, below) = (sum(step), sum(-step));
    let both = above.iter().zip(&below);
    both.map(|(above, below)| (above - below) / (2.0 * step))
        .collect()
}

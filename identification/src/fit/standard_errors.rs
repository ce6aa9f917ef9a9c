//! Standard errors of all parameters, those that are searched among them.
//!
//! Sessions are left out in turn (jackknife), since their parameters differ. Of fewer
//! than three, blocks of time take their place, whose residuals are made up for what
//! each block pulls the fit to itself (CR2: Bell and McCaffrey 2002): left out in turn,
//! the blocks in which a parameter shows most would make its error too large. A parameter
//! that shows in few of the blocks has as few degrees of freedom. Shape parameters
//! take part by the derivatives of their effects' columns: near the best shape s the
//! model c φ(s) is c φ + c ∂φ/∂s Δs, linear in c and Δs (Gauss–Newton). A coefficient
//! whose effect has a shape is less certain than it would be were the shape known.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::design::{Design, PreparedModel, columns};
use crate::effects::{BoundTerm, with_columns};
use crate::numerics::gram::Gram;
use crate::numerics::statistics::{jackknife_covariance, quantile_or_zero};
use crate::signals::Signals;

/// Step of a shape parameter, as a share of its value …
const STEP: f64 = 1e-4;
/// … and at least as a share of its bounds.
const LEAST_STEP: f64 = 1e-6;

/// Eigenvalues below this share of the largest are directions without information.
const SMALLEST: f64 = 1e-9;
/// Share of what is known of a direction that a single block may hold; beyond, nothing
/// could be said without it.
const MOST_SHARE: f64 = 0.99;
/// Share of the passages that tell the most of a width of which each tells but bounds.
const SLOWEST: f64 = 0.1;

/// How uncertain coefficients and shape parameters are, and how they go together.
pub struct Uncertainty {
    /// Covariance: coefficients, then shape parameters.
    pub covariance: DMatrix<f64>,
    /// Products of columns, then of the derivatives by shape parameters, and y.
    pub gram: Gram,
    /// Which shape parameters these are: term and place in its shape.
    pub shapes: Vec<(usize, usize)>,
    /// Degrees of freedom of each: what is left out in turn, less one; of blocks of time
    /// in which a parameter does not show alike, fewer.
    pub freedom: DVector<f64>,
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
        let outs = design.folds.iter().map(|fold| {
            let block = |(s, b): &(usize, usize)| grams.get(*s)?.get(*b);
            Gram::sum(fold.iter().filter_map(block), columns)
        });
        let most = (design.folds.len() as f64 - 1.0).max(1.0);
        let (mut covariance, freedom) = match design.errors_are_by_blocks() {
            true => {
                let (covariance, freedom) = by_blocks(&gram, &best, outs);
                (covariance, freedom.map(|own| own.clamp(1.0, most)))
            }
            false => {
                let without: Vec<DVector<f64>> =
                    outs.map(|out| gram.without(&out).solve()).collect();
                let freedom = DVector::from_element(columns, most);
                (jackknife_covariance(&best, &without), freedom)
            }
        };
        for (k, (term, place)) in shapes.iter().enumerate() {
            let at = design.base + k;
            if *place == 0 {
                covariance[(at, at)] += unseen_travel(prepared, *term).powi(2) / 3.0;
            }
        }
        Self {
            covariance,
            gram,
            shapes,
            freedom,
        }
    }

    /// Standard error of a coefficient, by its column.
    #[must_use]
    pub fn of_coefficient(&self, column: usize) -> f64 {
        self.covariance[(column, column)].max(0.0).sqrt()
    }

    /// The same with its degrees of freedom.
    #[must_use]
    pub fn with_freedom(&self, column: usize) -> (f64, f64) {
        (self.of_coefficient(column), self.freedom[column])
    }

    /// Column of a shape parameter, where it is searched.
    #[must_use]
    pub fn column_of_shape(&self, term: usize, place: usize) -> Option<usize> {
        let at = self.shapes.iter().position(|own| *own == (term, place))?;
        Some(self.gram.columns() - self.shapes.len() + at)
    }
}

/// Half the travel \[rad\] over which rows are left out around the samples at which a
/// term's torque is not determined: within it, its first shape parameter may be
/// anything, whatever the rows that are left say. The slowest of these passages tell
/// the most.
fn unseen_travel(prepared: &PreparedModel, term: usize) -> f64 {
    let Some(term) = prepared.terms.get(term) else {
        return 0.0;
    };
    let reach = prepared.filters.column_reach();
    let mut travels = Vec::new();
    for signals in &prepared.sessions {
        let points = &signals.points;
        for at in term.effect.undetermined_samples(&term.shape, points) {
            let first = points.get(at.saturating_sub(reach));
            if let (Some(first), Some(last)) = (first, points.get(at + reach)) {
                travels.push(0.5 * (last.position - first.position).abs());
            }
        }
    }
    quantile_or_zero(&mut travels, SLOWEST)
}

/// Σ Δᵢ Δᵢᵀ with Δᵢ = A⁻¹ (I − Aᵢ A⁻¹)^(−½) Xᵢᵀ eᵢ, A = XᵀX, Aᵢ = XᵢᵀXᵢ, e the residual.
///
/// Then the degrees of freedom of each variance: those of the multiple of a χ² that has its
/// mean and variance where errors are independent (Satterthwaite; Bell and McCaffrey),
/// (tr B)² / tr B² with Bᵢⱼ = wᵢᵀ (δᵢⱼ Sᵢ − Sᵢ Sⱼ) wⱼ, Sᵢ = A^(−½) Aᵢ A^(−½) and
/// wᵢ = (I − Sᵢ)^(−½) A^(−½) times the unit vector of the parameter.
fn by_blocks(
    gram: &Gram,
    best: &DVector<f64>,
    blocks: impl Iterator<Item = Gram>,
) -> (DMatrix<f64>, DVector<f64>) {
    let n = gram.columns();
    let scale = DVector::from_fn(n, |i, _| match gram.products[(i, i)] {
        square if square > 0.0 => square.sqrt().recip(),
        _ => 0.0,
    });
    let scaled =
        |gram: &Gram| DMatrix::from_fn(n, n, |i, j| gram.products[(i, j)] * scale[i] * scale[j]);
    let half = turned(&scaled(gram), |own, most| match own > SMALLEST * most {
        true => own.sqrt().recip(),
        false => 0.0,
    });
    let mut covariance = DMatrix::zeros(n, n);
    let mut shares = Vec::new();
    for block in blocks {
        let own = block.products.view((0, 0), (n, n)) * best;
        let pull = block.products.view((0, n), (n, 1)).column(0) - own;
        let share = &half * scaled(&block) * &half;
        let made_up = turned(&share, |own, _| {
            (1.0 - own.clamp(0.0, MOST_SHARE)).sqrt().recip()
        });
        let moved = &half * &made_up * &half * pull.component_mul(&scale);
        let moved = moved.component_mul(&scale);
        covariance += &moved * moved.transpose();
        shares.push((share, made_up * &half));
    }
    let freedom = DVector::from_fn(n, |parameter, _| {
        let each = shares.iter().map(|(share, made_up)| {
            let w = made_up.column(parameter).into_owned();
            let own = share * &w;
            (w.dot(&own), own)
        });
        let (own, shared): (Vec<f64>, Vec<DVector<f64>>) = each.unzip();
        let count = own.len();
        let b = DMatrix::from_fn(count, count, |i, j| {
            let both = shared[i].dot(&shared[j]);
            if i == j { own[i] - both } else { -both }
        });
        b.trace().powi(2) / b.norm_squared().max(f64::MIN_POSITIVE)
    });
    (covariance, freedom)
}

/// The symmetric matrix with its eigenvalues turned by `of`, which is told the largest, too.
fn turned(matrix: &DMatrix<f64>, of: impl Fn(f64, f64) -> f64) -> DMatrix<f64> {
    if matrix.is_empty() {
        // A model without parameters.
        return matrix.clone();
    }
    let eigen = SymmetricEigen::new(matrix.clone());
    let most = eigen.eigenvalues.max();
    let values = eigen.eigenvalues.map(|own| of(own, most));
    &eigen.eigenvectors * DMatrix::from_diagonal(&values) * eigen.eigenvectors.transpose()
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

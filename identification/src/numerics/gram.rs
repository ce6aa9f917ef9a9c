//! Least squares from Gram matrices.
//!
//! Fits, cross-validation and tests need the data only as sums of products of
//! columns over blocks of rows; those are small, so that everything after
//! them is cheap.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Eigenvalues of the (unit-scaled) Gram matrix below this share of the largest
/// are treated as zero: the data hold no information in their directions.
const MIN_EIGENVALUE_SHARE: f64 = 1e-9;

/// Products of columns, the last of which is the measured side y.
#[derive(Clone, Debug, PartialEq)]
pub struct Gram {
    /// Number of rows summed over.
    pub rows: usize,
    /// Symmetric matrix of products, (columns + 1)².
    pub products: DMatrix<f64>,
}

impl Gram {
    /// All zeros for `columns` columns and y.
    #[must_use]
    pub fn empty(columns: usize) -> Self {
        Self {
            rows: 0,
            products: DMatrix::zeros(columns + 1, columns + 1),
        }
    }

    /// Products over rows `from..to` of `columns` and `measured`.
    #[must_use]
    pub fn from_columns(columns: &[&[f64]], measured: &[f64], from: usize, to: usize) -> Self {
        let mut gram = Self::empty(columns.len());
        gram.rows = to.saturating_sub(from);
        let all: Vec<&[f64]> = columns.iter().copied().chain([measured]).collect();
        for i in 0..all.len() {
            for j in 0..=i {
                let product = dot(range(all[i], from, to), range(all[j], from, to));
                gram.products[(i, j)] = product;
                gram.products[(j, i)] = product;
            }
        }
        gram
    }

    /// This Gram with the columns `extra` inserted before y; `base` are the
    /// columns and y that it was computed from.
    #[must_use]
    pub fn with(&self, base: &[&[f64]], extra: &[&[f64]], from: usize, to: usize) -> Self {
        let (p, m) = (self.columns(), extra.len());
        let place = |i: usize| if i < p { i } else { p + m };
        let mut gram = Self::empty(p + m);
        gram.rows = self.rows;
        for i in 0..=p {
            for j in 0..=p {
                gram.products[(place(i), place(j))] = self.products[(i, j)];
            }
        }
        for (k, column) in extra.iter().enumerate() {
            let column = range(column, from, to);
            let others = base.iter().enumerate().map(|(i, c)| (place(i), *c)).chain(
                extra
                    .iter()
                    .take(k + 1)
                    .enumerate()
                    .map(|(l, c)| (p + l, *c)),
            );
            for (at, other) in others {
                let product = dot(column, range(other, from, to));
                gram.products[(p + k, at)] = product;
                gram.products[(at, p + k)] = product;
            }
        }
        gram
    }

    /// Number of columns, y not counted.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.products.nrows().saturating_sub(1)
    }

    /// Σ y².
    #[must_use]
    pub fn square(&self) -> f64 {
        let last = self.columns();
        self.products[(last, last)]
    }

    /// Adds another's rows.
    pub fn add(&mut self, other: &Self) {
        self.rows += other.rows;
        self.products += &other.products;
    }

    /// Without another's rows.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        Self {
            rows: self.rows - other.rows.min(self.rows),
            products: &self.products - &other.products,
        }
    }

    /// Sum of many.
    #[must_use]
    pub fn sum<'a>(grams: impl IntoIterator<Item = &'a Self>, columns: usize) -> Self {
        let mut sum = Self::empty(columns);
        for gram in grams {
            sum.add(gram);
        }
        sum
    }

    /// Coefficients of least squares.
    #[must_use]
    pub fn solve(&self) -> DVector<f64> {
        let n = self.columns();
        let (inverse, _) = pseudo_inverse(&self.products.view((0, 0), (n, n)).into_owned());
        inverse * self.products.view((0, n), (n, 1)).column(0)
    }

    /// Σ (y − X c)².
    #[must_use]
    pub fn squared_error(&self, coefficients: &DVector<f64>) -> f64 {
        let n = self.columns();
        let x = self.products.view((0, 0), (n, n));
        let y = self.products.view((0, n), (n, 1));
        let error = self.square() - 2.0 * y.column(0).dot(coefficients)
            + (coefficients.transpose() * x * coefficients)[(0, 0)];
        error.max(0.0)
    }

    /// Gram of the last columns and y less the part of them that the first `base`
    /// columns explain by `coefficients` (base × remaining).
    #[must_use]
    pub fn reduce(&self, base: usize, coefficients: &DMatrix<f64>) -> Self {
        let rest = self.products.nrows() - base;
        let s = &self.products;
        let bb = s.view((0, 0), (base, base));
        let br = s.view((0, base), (base, rest));
        let cross = coefficients.transpose() * br;
        let products = s.view((base, base), (rest, rest)) - &cross - cross.transpose()
            + coefficients.transpose() * bb * coefficients;
        Self {
            rows: self.rows,
            products,
        }
    }

    /// Coefficients by which the first `base` columns explain all others and y.
    #[must_use]
    pub fn explain_freely(&self, base: usize) -> DMatrix<f64> {
        let nothing = DVector::zeros(base);
        self.explain(&nothing, &nothing)
    }

    /// Coefficients by which the first columns explain all others and y, by ridge
    /// regression: those of y are drawn to `around`, one for each of the first
    /// columns, the others to zero, with the weights `hold` \[square of y over square
    /// of the coefficient\]; a weight of 0 leaves a coefficient free.
    #[must_use]
    pub fn explain(&self, around: &DVector<f64>, hold: &DVector<f64>) -> DMatrix<f64> {
        let base = around.len();
        let rest = self.products.nrows() - base;
        let own = self.products.view((0, 0), (base, base));
        let mut sides = self.products.view((0, base), (base, rest)).into_owned();
        let mut measured = sides.column_mut(rest - 1);
        measured -= own * around;
        let (inverse, _) = pseudo_inverse(&(own + DMatrix::from_diagonal(hold)));
        let mut coefficients = inverse * sides;
        let mut measured = coefficients.column_mut(rest - 1);
        measured += around;
        coefficients
    }
}

/// Inverse of a positive semidefinite matrix on the directions it has, and
/// the ratio of its largest eigenvalue to its smallest after unit scaling.
#[must_use]
pub fn pseudo_inverse(matrix: &DMatrix<f64>) -> (DMatrix<f64>, f64) {
    let n = matrix.nrows();
    if n == 0 {
        return (DMatrix::zeros(0, 0), 1.0);
    }
    let scale = DVector::from_fn(n, |i, _| {
        let d = matrix[(i, i)];
        if d > 0.0 && d.is_finite() {
            d.sqrt().recip()
        } else {
            0.0
        }
    });
    let scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] * scale[i] * scale[j]);
    if scaled.iter().any(|x| !x.is_finite()) {
        return (DMatrix::zeros(n, n), f64::INFINITY);
    }
    let eigen = SymmetricEigen::new(scaled);
    let largest = eigen.eigenvalues.max();
    let smallest = eigen.eigenvalues.min();
    let inverted = eigen.eigenvalues.map(|e| {
        if e > MIN_EIGENVALUE_SHARE * largest {
            e.recip()
        } else {
            0.0
        }
    });
    let inverse =
        &eigen.eigenvectors * DMatrix::from_diagonal(&inverted) * eigen.eigenvectors.transpose();
    let unscaled = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * scale[i] * scale[j]);
    (
        unscaled,
        if smallest > 0.0 {
            largest / smallest
        } else {
            f64::INFINITY
        },
    )
}

fn range(column: &[f64], from: usize, to: usize) -> &[f64] {
    column.get(from..to).unwrap_or(&[])
}

/// Σ a b, in eight lanes: one sum alone would wait for each addition.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut lanes = [0.0; LANES];
    let (a8, b8) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let tails = a8.remainder().iter().zip(b8.remainder());
    let tail: f64 = tails.map(|(x, y)| x * y).sum();
    for (x, y) in a8.zip(b8) {
        for lane in 0..LANES {
            lanes[lane] += x[lane] * y[lane];
        }
    }
    lanes.iter().sum::<f64>() + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let x: Vec<f64> = (0..50).map(|i| f64::from(i) / 10.0).collect();
        let ones = vec![1.0; 50];
        let y = x
            .iter()
            .map(|x| 3.0 - 2.0 * x + 0.01 * (7.0 * x).sin())
            .collect();
        (ones, x, y)
    }

    #[test]
    fn a_line_is_found() {
        let (ones, x, y) = columns();
        let gram = Gram::from_columns(&[&ones, &x], &y, 0, 50);
        let c = gram.solve();
        assert!((c[0] - 3.0).abs() < 0.01 && (c[1] + 2.0).abs() < 0.01);
        let direct: f64 = x
            .iter()
            .zip(&y)
            .map(|(x, y)| (y - c[0] - c[1] * x).powi(2))
            .sum();
        assert!((gram.squared_error(&c) - direct).abs() < 1e-9);
    }

    #[test]
    fn partialling_out_gives_the_same_coefficient_as_the_joint_fit() {
        let (ones, x, y) = columns();
        let base = Gram::from_columns(&[&ones], &y, 0, 50);
        let joint = base.with(&[&ones, &y], &[&x], 0, 50);
        assert_eq!(joint, Gram::from_columns(&[&ones, &x], &y, 0, 50));
        let reduced = joint.reduce(1, &joint.explain_freely(1));
        assert!((reduced.solve()[0] - joint.solve()[1]).abs() < 1e-9);
    }

    #[test]
    fn a_column_twice_shares_its_coefficient() {
        let (ones, x, y) = columns();
        let gram = Gram::from_columns(&[&ones, &x, &x], &y, 0, 50);
        let c = gram.solve();
        assert!((c[1] - c[2]).abs() < 1e-6 && (c[1] + c[2] + 2.0).abs() < 0.01);
    }

    /// y = 3 + 2 x, seen where x hardly varies: held to (1, 4), the level is found
    /// for the slope that is held, free of it both are.
    #[test]
    fn a_coefficient_that_is_not_excited_keeps_the_value_it_is_drawn_to() {
        let x: Vec<f64> = (0..50).map(|i| 1.0 + 1e-3 * f64::from(i % 2)).collect();
        let y: Vec<f64> = x.iter().map(|x| 3.0 + 2.0 * x).collect();
        let gram = Gram::from_columns(&[&vec![1.0; 50], &x], &y, 0, 50);
        let around = DVector::from_vec(vec![1.0, 4.0]);
        let near = |found: DMatrix<f64>, wanted: [f64; 2]| {
            let apart = (found[(0, 0)] - wanted[0]).hypot(found[(1, 0)] - wanted[1]);
            assert!(apart < 0.01, "{found}");
        };
        near(gram.explain(&around, &DVector::zeros(2)), [3.0, 2.0]);
        let hold = DVector::from_vec(vec![0.0, 1.0]);
        near(gram.explain(&around, &hold), [1.0, 4.0]);
    }
}

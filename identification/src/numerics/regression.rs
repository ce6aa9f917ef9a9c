//! Straight lines through few points, and least squares over blocks of time.

use nalgebra::{DMatrix, DVector};

use super::gram::{Gram, pseudo_inverse};
use super::statistics::jackknife_covariance;

/// Coefficients with standard errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficients {
    /// One for each column.
    pub values: Vec<f64>,
    /// Their standard errors.
    pub errors: Vec<f64>,
    /// Root mean square of the residual, in the unit of the measured side.
    pub rms: f64,
}

/// Least squares of `measured` on `columns` (each as long as it) for
/// independent rows: errors from what is left. `None` when there are not more
/// rows than columns.
#[must_use]
pub fn least_squares(columns: &[&[f64]], measured: &[f64]) -> Option<Coefficients> {
    let (rows, count) = (measured.len(), columns.len());
    if rows <= count || columns.iter().any(|column| column.len() != rows) {
        return None;
    }
    let gram = Gram::from_columns(columns, measured, 0, rows);
    let solution = gram.solve();
    let squares = gram.squared_error(&solution).max(0.0);
    let variance = squares / (rows - count) as f64;
    let products: DMatrix<f64> = gram.products.view((0, 0), (count, count)).into_owned();
    let (inverse, _) = pseudo_inverse(&products);
    Some(Coefficients {
        errors: (0..count)
            .map(|i| (inverse[(i, i)].max(0.0) * variance).sqrt())
            .collect(),
        values: solution.iter().copied().collect(),
        rms: (squares / rows as f64).sqrt(),
    })
}

/// Least squares for rows that follow each other in time: errors by leaving
/// out each of `blocks` stretches in turn, which allows for autocorrelation.
#[must_use]
pub fn by_blocks(columns: &[&[f64]], measured: &[f64], blocks: usize) -> Option<Coefficients> {
    let (rows, count) = (measured.len(), columns.len());
    if rows < blocks.max(2) || rows <= count || columns.iter().any(|column| column.len() != rows) {
        return None;
    }
    let total = Gram::from_columns(columns, measured, 0, rows);
    let solution = total.solve();
    let without: Vec<DVector<f64>> = (0..blocks)
        .map(|block| {
            let (from, to) = (block * rows / blocks, (block + 1) * rows / blocks);
            total
                .without(&Gram::from_columns(columns, measured, from, to))
                .solve()
        })
        .collect();
    let covariance = jackknife_covariance(&solution, &without);
    Some(Coefficients {
        errors: (0..count)
            .map(|i| covariance[(i, i)].max(0.0).sqrt())
            .collect(),
        rms: (total.squared_error(&solution).max(0.0) / rows as f64).sqrt(),
        values: solution.iter().copied().collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Anscombe's first data set: y = 3.0001 + 0.5001 x, standard errors 1.1247 and 0.1179.
    #[test]
    fn it_agrees_with_anscombe() {
        let x = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0];
        let y = [
            8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68,
        ];
        let line = least_squares(&[&[1.0; 11], &x], &y).unwrap();
        assert!((line.values[0] - 3.0001).abs() < 1e-4 && (line.values[1] - 0.5001).abs() < 1e-4);
        assert!((line.errors[0] - 1.1247).abs() < 1e-4 && (line.errors[1] - 0.1179).abs() < 1e-4);
        let blocks = by_blocks(&[&[1.0; 11], &x], &y, 11).unwrap();
        assert!((blocks.values[1] - line.values[1]).abs() < 1e-9);
        assert!(blocks.errors[1] > 0.05 && blocks.errors[1] < 0.25);
    }

    #[test]
    fn too_few_rows_give_no_coefficients() {
        assert!(least_squares(&[&[1.0, 1.0], &[0.0, 1.0]], &[1.0, 2.0]).is_none());
        assert!(by_blocks(&[&[1.0]], &[1.0], 5).is_none());
    }
}

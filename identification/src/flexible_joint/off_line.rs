//! Batch least squares.

use nalgebra::{Matrix2, Vector2};

use super::Row;

/// Lags over which the correlation of the residual is summed.
const MOST_LAGS: usize = 300;

/// A parameter found off line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Its value.
    pub value: f64,
    /// Its standard error, the correlation of the residual allowed for.
    pub std_error: f64,
}

/// Least squares over rows of one regression; `None` where they do not
/// determine both parameters.
///
/// The covariance is that of Newey and West (Econometrica 55, 1987):
/// R⁻¹ S R⁻¹, S the long-run covariance of φ e.
#[must_use]
pub fn off_line(rows: &[Row]) -> Option<[Estimate; 2]> {
    let phi = |row: &Row| Vector2::new(row.phi[0], row.phi[1]);
    // Columns of unit size, since k_1 and k_2 are ten powers of ten apart.
    let size = rows
        .iter()
        .fold(Vector2::zeros(), |sum: Vector2<f64>, row| {
            sum + phi(row).component_mul(&phi(row))
        })
        .map(f64::sqrt);
    if rows.len() < 10 || size.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    let scaled = |row: &Row| phi(row).component_div(&size);
    let (mut information, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for row in rows {
        information += scaled(row) * scaled(row).transpose();
        right += scaled(row) * row.measured;
    }
    if information.determinant() < 1e-9 {
        return None;
    }
    let inverse: Matrix2<f64> = information.try_inverse()?;
    let theta = inverse * right;
    let moments: Vec<Vector2<f64>> = rows
        .iter()
        .map(|row| scaled(row) * (row.measured - scaled(row).dot(&theta)))
        .collect();
    let lags = MOST_LAGS.min(rows.len() / 10);
    let mut long_run = Matrix2::zeros();
    for lag in 0..=lags {
        let product = moments[lag..]
            .iter()
            .zip(&moments)
            .fold(Matrix2::zeros(), |sum, (a, b)| sum + a * b.transpose());
        let weight = 1.0 - lag as f64 / (lags + 1) as f64;
        long_run += if lag == 0 {
            product
        } else {
            (product + product.transpose()) * weight
        };
    }
    let covariance = inverse * long_run * inverse;
    Some([0, 1].map(|i| Estimate {
        value: theta[i] / size[i],
        std_error: covariance[(i, i)].max(0.0).sqrt() / size[i],
    }))
}

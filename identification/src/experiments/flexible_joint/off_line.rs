//! Batch least squares.

use super::Row;
use crate::numerics::regression::by_blocks;

/// Stretches of time that are left out in turn for the standard errors.
const BLOCKS: usize = 20;
/// Squared correlation of the two columns above which their parameters cannot be
/// distinguished \[1\].
const MAX_SQUARED_CORRELATION: f64 = 1.0 - 1e-9;

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
#[must_use]
pub fn off_line(rows: &[Row]) -> Option<[Estimate; 2]> {
    let column = |k: usize| -> Vec<f64> { rows.iter().map(|row| row.phi[k]).collect() };
    let (first, second) = (column(0), column(1));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let squared_correlation =
        product(&first, &second).powi(2) / (product(&first, &first) * product(&second, &second));
    // Not a number where a column is zero.
    if squared_correlation.is_nan() || squared_correlation >= MAX_SQUARED_CORRELATION {
        return None;
    }
    let measured: Vec<f64> = rows.iter().map(|row| row.measured).collect();
    let found = by_blocks(&[&first, &second], &measured, BLOCKS)?;
    let estimate = |k: usize| {
        Some(Estimate {
            value: *found.values.get(k)?,
            std_error: *found.errors.get(k)?,
        })
    };
    Some([estimate(0)?, estimate(1)?])
}

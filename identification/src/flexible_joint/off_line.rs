//! Batch least squares.

use super::Row;
use crate::regression::by_blocks;

/// Stretches of time that are left out in turn for the standard errors.
const BLOCKS: usize = 20;
/// Columns that are more alike than this do not tell their parameters apart \[1\].
const MAX_ALIKE: f64 = 1.0 - 1e-9;

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
    let alike =
        product(&first, &second).powi(2) / (product(&first, &first) * product(&second, &second));
    // Where a column is zero, their likeness is no number.
    if alike.is_nan() || alike >= MAX_ALIKE {
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

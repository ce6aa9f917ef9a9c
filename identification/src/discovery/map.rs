//! What a formula says beside what was measured, over its signals.

use serde::Serialize;

use super::rows::Rows;
use super::term::{Signal, Term};
use crate::data::JointType;
use crate::numerics::gram::Gram;
use crate::numerics::statistics::quantile_or_zero;

/// Bins of a curve, …
const BINS_OF_CURVE: usize = 24;
/// … and of each axis of a map.
const BINS_OF_MAP: usize = 16;
/// Rows in a bin, at least.
const MIN_ROWS: usize = 4;

/// Mean residual, and mean of the formula, in bins of its first signal or its first two.
/// Of both, the part that the model itself explains is taken out, so that one can be
/// held against the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FormulaMap {
    /// The signals.
    pub signals: Vec<String>,
    /// Their units.
    pub units: Vec<String>,
    /// Middle of the bins of each signal.
    pub axes: Vec<Vec<f64>>,
    /// Mean residual \[Nm\], row by row of the first signal; `None` where there are
    /// no data.
    pub measured: Vec<Option<f64>>,
    /// Mean of the formula \[Nm\] in the same bins.
    pub formula: Vec<Option<f64>>,
}

/// The map of a formula with these `terms`, over the signals that it reads.
pub(super) fn draw(
    rows: &Rows,
    terms: &[Term],
    signals: &[Signal],
    read: &[usize],
    joint: JointType,
) -> FormulaMap {
    let columns: Vec<Vec<f64>> = terms.iter().filter_map(|own| rows.column_of(own)).collect();
    let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let fitted = Gram::from_columns(&views, &rows.residual, 0, rows.count()).solve();
    let formula = |row: usize| -> f64 {
        let each = columns.iter().zip(fitted.iter());
        each.map(|(column, c)| c * column[row]).sum()
    };
    let chosen: Vec<usize> = read.iter().take(2).copied().collect();
    let bins = match chosen.as_slice() {
        [_] => BINS_OF_CURVE,
        _ => BINS_OF_MAP,
    };
    let values: Vec<&[f64]> = chosen
        .iter()
        .filter_map(|at| rows.channels.get(*at))
        .map(|own| own.values.as_slice())
        .collect();
    let edges: Vec<(f64, f64)> = values
        .iter()
        .map(|own| {
            let mut all = own.to_vec();
            let low = quantile_or_zero(&mut all, 0.005);
            (low, quantile_or_zero(&mut all, 0.995))
        })
        .collect();
    let mut sums = vec![(0.0, 0.0, 0_usize); bins.pow(values.len() as u32)];
    for row in 0..rows.count() {
        let mut cell = 0;
        for (own, (low, high)) in values.iter().zip(&edges) {
            let share = (own[row] - low) / (high - low).max(1e-300);
            cell = cell * bins + ((share.max(0.0) * bins as f64) as usize).min(bins - 1);
        }
        if let Some((measured, by_formula, count)) = sums.get_mut(cell) {
            *measured += rows.residual[row];
            *by_formula += formula(row);
            *count += 1;
        }
    }
    let mean = |sum: f64, count: usize| (count >= MIN_ROWS).then(|| sum / count as f64);
    let middle = |(low, high): &(f64, f64)| -> Vec<f64> {
        let at = |bin: usize| low + (high - low) * (bin as f64 + 0.5) / bins as f64;
        (0..bins).map(at).collect()
    };
    let of = |text: fn(&Signal, JointType) -> String| -> Vec<String> {
        let own = chosen.iter().filter_map(|at| signals.get(*at));
        own.map(|own| text(own, joint)).collect()
    };
    FormulaMap {
        signals: of(|own, _| own.of_results.clone()),
        units: of(|own, joint| match own.place_unit {
            Some(unit) => unit.to_owned(),
            None => own.unit.text(joint),
        }),
        axes: edges.iter().map(middle).collect(),
        measured: sums
            .iter()
            .map(|(sum, _, count)| mean(*sum, *count))
            .collect(),
        formula: sums
            .iter()
            .map(|(_, sum, count)| mean(*sum, *count))
            .collect(),
    }
}

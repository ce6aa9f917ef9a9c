//! What LeRobot wants to know of every feature, to normalise it.

use std::collections::BTreeMap;

/// Name and share of each quantile.
const QUANTILES: [(&str, f64); 5] = [
    ("q01", 0.01),
    ("q10", 0.10),
    ("q50", 0.50),
    ("q90", 0.90),
    ("q99", 0.99),
];

/// By name, a number of each element of the feature; `count` has one.
pub type Statistics = BTreeMap<&'static str, Vec<f64>>;

/// Of a feature whose elements have these values.
pub fn statistics(elements: &[Vec<f64>]) -> Statistics {
    let mut all = Statistics::new();
    for values in elements {
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let count = sorted.len().max(1) as f64;
        let mean = sorted.iter().sum::<f64>() / count;
        let square = sorted.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / count;
        let mut put = |name, value| all.entry(name).or_default().push(value);
        put("min", sorted.first().copied().unwrap_or(f64::NAN));
        put("max", sorted.last().copied().unwrap_or(f64::NAN));
        put("mean", mean);
        put("std", square.sqrt());
        for (name, share) in QUANTILES {
            put(name, quantile(&sorted, share));
        }
    }
    let count = elements.first().map_or(0, Vec::len) as f64;
    all.insert("count", vec![count]);
    all
}

/// By a straight line between the values beside it.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let at = |place: f64| sorted.get(place as usize).copied().unwrap_or(f64::NAN);
    let (below, above) = (at(place.floor()), at(place.ceil()));
    below + (above - below) * place.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_whole_numbers() {
        let values: Vec<f64> = (0..101).map(f64::from).collect();
        let found = statistics(&[values]);
        for (name, expected) in [
            ("min", 0.0),
            ("max", 100.0),
            ("mean", 50.0),
            // (n² − 1)/12 for n numbers in a row.
            ("std", 850.0_f64.sqrt()),
            ("q01", 1.0),
            ("q50", 50.0),
            ("count", 101.0),
        ] {
            assert!((found[name][0] - expected).abs() < 1e-12, "{name}");
        }
    }
}

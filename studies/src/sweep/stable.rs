//! How far each law goes.

use serde::Serialize;

use super::Row;

/// The largest round trip up to which a law is stable against an environment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LargestStable<'a> {
    /// The law.
    pub law: &'a str,
    /// The environment.
    pub environment: &'a str,
    /// Without jitter and loss \[ms\]; `None` when it is unstable at every one.
    pub ideal_ms: Option<f64>,
    /// With any jitter and loss of the sweep, and any seed \[ms\].
    pub worst_ms: Option<f64>,
}

/// For each law and environment, in the order of the rows. Delays above one at
/// which a trial was unstable do not count, though they may be stable.
pub fn largest_stable(rows: &[Row]) -> Vec<LargestStable<'_>> {
    let mut pairs: Vec<(&str, &str)> = Vec::new();
    for row in rows {
        let pair = (&*row.law, &*row.environment);
        if !pairs.contains(&pair) {
            pairs.push(pair);
        }
    }
    let of = |(law, environment)| {
        let own = || {
            rows.iter()
                .filter(move |row| row.law == law && row.environment == environment)
        };
        LargestStable {
            law,
            environment,
            ideal_ms: largest(own().filter(|row| row.is_ideal())),
            worst_ms: largest(own()),
        }
    };
    pairs.into_iter().map(of).collect()
}

fn largest<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Option<f64> {
    let broken = rows
        .clone()
        .filter(|row| !row.stable)
        .map(|row| row.rtt_ms)
        .fold(f64::INFINITY, f64::min);
    rows.map(|row| row.rtt_ms)
        .filter(|rtt| *rtt < broken)
        .max_by(f64::total_cmp)
}

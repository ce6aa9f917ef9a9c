//! How much evidence names a joint.
//!
//! Of a series without any change the best of the ramps that may have begun on any day is,
//! once a day, beyond h standard deviations at a rate that falls as that of the upcrossings
//! of a smooth Gaussian process with one parameter more (the onset), h exp(−h² / 2) times a
//! constant (Siegmund, "Sequential Analysis", 1985, chapter XI; Leadbetter, Lindgren and
//! Rootzén 1983, chapter 13). The constant was measured on series of the model itself.

/// The constant \[1/d\].
const CONSTANT: f64 = 0.2;
/// The model is not the truth: so much less often than is tolerated.
const MARGIN: f64 = 10.0;
const DAYS_A_YEAR: f64 = 365.25;

/// False alarms that `series` series give in a year \[1/year\] with the threshold `h`,
/// where the model of a series is the truth.
pub fn false_alarms(series: usize, h: f64) -> f64 {
    series as f64 * DAYS_A_YEAR * CONSTANT * h * (-0.5 * h * h).exp()
}

/// The threshold at which `series` series give `tolerated` false alarms a year at most, with
/// a margin for what the model does not know.
pub fn threshold(series: usize, tolerated: f64) -> f64 {
    let wanted = tolerated / MARGIN;
    // Falls all the way from h = 1.
    let (mut low, mut high) = (1.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match false_alarms(series.max(1), middle) > wanted {
            true => low = middle,
            false => high = middle,
        }
    }
    high.max(3.0)
}

/// The normal score of Student's `t` with that freedom: as improbable, to one percent
/// of itself (Wallace, "Bounds on normal approximations to Student's and the chi-square
/// distributions", 1959).
pub(super) fn normal_score(t: f64, freedom: f64) -> f64 {
    let share = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    t.signum() * share * (freedom * (t * t / freedom).ln_1p()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Student's distribution: with 10 degrees of freedom, P(t > 4.587) = 5e-4 and with 5
    /// P(t > 6.869) = 5e-4, as P(z > 3.2905) (tables).
    #[test]
    fn scores_are_those_of_tables() {
        for (t, freedom) in [(4.587, 10.0), (6.869, 5.0), (3.373, 120.0)] {
            let score = normal_score(t, freedom);
            assert!((score - 3.2905).abs() < 0.03, "{score}");
            assert_eq!(normal_score(-t, freedom), -score);
        }
    }

    #[test]
    fn more_series_and_fewer_alarms_need_more() {
        let one = threshold(10, 1.0);
        let more = threshold(1000, 1.0);
        let stricter = threshold(1000, 0.1);
        assert!(3.0 < one && one < more && more < stricter && stricter < 7.0);
        let left = false_alarms(1000, more);
        assert!((left - 0.1).abs() < 1e-6, "{left}");
    }
}

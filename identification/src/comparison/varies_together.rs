//! Signals and conditions that vary together from session to session, so that an effect
//! of one cannot be told from an effect of the other.
//!
//! Compared are the sessions' means: of every signal that differs between sessions by more
//! than it varies within them, of the date, and of the conditions that are stated. The
//! correlation is Pearson's r, its p-value by t = r √((n − 2)/(1 − r²)) with n − 2 degrees
//! of freedom, corrected for the number of pairs (Bonferroni).

use serde::Serialize;

use crate::data::{Dataset, RecordedSession};
use crate::numerics::statistics::f_tail;

/// Fewest sessions for a statement.
const MIN_SESSIONS: usize = 4;
/// |r| from which two variables distort estimates of each other's effect (Dormann et al.,
/// Ecography 36, 2013: 0.7).
const MIN_CORRELATION: f64 = 0.7;
/// |r| from which the variance of such an estimate is five times as large, 1/(1 − r²) = 5.
const HOPELESS: f64 = 0.894_427;
/// Probability that chance alone makes a statement, over all pairs together.
const SIGNIFICANCE: f64 = 0.01;
/// Shortest span of dates \[days\] over which anything ages, as for the effects of date.
const MIN_DAYS: f64 = 0.5;

/// Two signals or conditions that vary together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VariesTogether {
    /// Their names: as in the residual maps, else those of the conditions.
    pub signals: [String; 2],
    /// Correlation of the sessions' means, −1 … 1.
    pub correlation: f64,
    /// Number of sessions.
    pub sessions: usize,
    /// Probability of as large a correlation by chance, corrected for all pairs.
    pub p_value: f64,
}

impl VariesTogether {
    /// What it means, as a sentence.
    #[must_use]
    pub fn text(&self) -> String {
        let [one, other] = &self.signals;
        let how = match self.correlation > 0.0 {
            true => format!("{one} and {other} rise together"),
            false => format!("{one} falls as {other} rises"),
        };
        let told = match self.correlation.abs() >= HOPELESS {
            true => "cannot be told",
            false => "can hardly be told",
        };
        format!(
            "{how} (correlation {:.2} over {} sessions): an effect of one {told} from an effect of the other",
            self.correlation, self.sessions
        )
    }
}

/// What varies together in the sessions that are fitted, the closest pair first.
#[must_use]
pub fn find(dataset: &Dataset) -> Vec<VariesTogether> {
    let all = varying(dataset);
    let mut pairs = Vec::new();
    for (number, (one, means)) in all.iter().enumerate() {
        for (other, its_means) in &all[number + 1..] {
            let both: Vec<(f64, f64)> = (means.iter().zip(its_means))
                .filter_map(|(a, b)| Some(((*a)?, (*b)?)))
                .collect();
            if let Some(correlation) = correlation(&both) {
                pairs.push(VariesTogether {
                    signals: [one.clone(), other.clone()],
                    correlation,
                    sessions: both.len(),
                    p_value: p_value(correlation, both.len()),
                });
            }
        }
    }
    let tried = pairs.len() as f64;
    for pair in &mut pairs {
        pair.p_value = (pair.p_value * tried).min(1.0);
    }
    pairs.retain(|pair| pair.correlation.abs() >= MIN_CORRELATION && pair.p_value < SIGNIFICANCE);
    pairs.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    pairs
}

/// Every signal and condition that differs between sessions, with its mean in each;
/// `None` in a session that does not have it.
fn varying(dataset: &Dataset) -> Vec<(String, Vec<Option<f64>>)> {
    let sessions = &dataset.sessions;
    type Channel = fn(&RecordedSession) -> Option<&Vec<f64>>;
    let own: [(&str, Channel); 4] = [
        ("temperature", |s| s.temperature.as_ref()),
        ("position", |s| Some(&s.position)),
        ("load", |s| s.joint_torque.as_ref()),
        ("load", |s| s.normal_force.as_ref()),
    ];
    let mut found: Vec<(String, Vec<Option<f64>>)> = Vec::new();
    let mut keep = |name: &str, channels: Vec<Option<&Vec<f64>>>| {
        if let Some(means) = slow_means(&channels) {
            found.push((name.to_owned(), means));
        }
    };
    for (name, channel) in own {
        let channels = sessions.iter().map(channel).collect();
        keep(dataset.joint.signal(name), channels);
    }
    for name in names(sessions.iter().map(|own| own.extra.keys())) {
        keep(
            name,
            sessions.iter().map(|own| own.extra.get(name)).collect(),
        );
    }
    let days: Vec<f64> = sessions.iter().map(|own| own.start / 86_400.0).collect();
    if span(&days) > MIN_DAYS {
        found.push(("date".to_owned(), days.into_iter().map(Some).collect()));
    }
    for name in names(sessions.iter().map(|own| own.conditions.keys())) {
        let stated = sessions.iter().map(|own| own.conditions.get(name).copied());
        found.push((name.to_owned(), stated.collect()));
    }
    found
}

/// All names, each once.
fn names<'a>(each: impl Iterator<Item = impl Iterator<Item = &'a String>>) -> Vec<&'a str> {
    let mut names: Vec<&str> = each.flatten().map(String::as_str).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The mean in each session, of a signal whose means differ by more than it varies within
/// a session.
fn slow_means(channels: &[Option<&Vec<f64>>]) -> Option<Vec<Option<f64>>> {
    let moments = |values: &Vec<f64>| -> Option<(f64, f64)> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square = values.iter().map(|own| (own - mean).powi(2)).sum::<f64>();
        (count > 0.0).then_some((mean, square / count))
    };
    let each: Vec<Option<(f64, f64)>> = (channels.iter())
        .map(|values| values.and_then(moments))
        .collect();
    let known: Vec<(f64, f64)> = each.iter().flatten().copied().collect();
    let count = known.len() as f64;
    let mean = known.iter().map(|own| own.0).sum::<f64>() / count;
    let between = known.iter().map(|own| (own.0 - mean).powi(2)).sum::<f64>() / count;
    let within = known.iter().map(|own| own.1).sum::<f64>() / count;
    (between > within).then(|| each.into_iter().map(|own| Some(own?.0)).collect())
}

fn span(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if low <= high { high - low } else { 0.0 }
}

/// Pearson's r; `None` of too few points, or where one of the two does not vary.
fn correlation(points: &[(f64, f64)]) -> Option<f64> {
    let count = points.len() as f64;
    let mean = |side: fn(&(f64, f64)) -> f64| points.iter().map(side).sum::<f64>() / count;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |term: fn(f64, f64) -> f64| -> f64 {
        points.iter().map(|(x, y)| term(x - mx, y - my)).sum()
    };
    let scale = (sum(|x, _| x * x) * sum(|_, y| y * y)).sqrt();
    (points.len() >= MIN_SESSIONS && scale > 0.0)
        .then(|| (sum(|x, y| x * y) / scale).clamp(-1.0, 1.0))
}

/// Two-sided p-value of a correlation over so many points.
fn p_value(correlation: f64, points: usize) -> f64 {
    let freedom = points as f64 - 2.0;
    let square = correlation * correlation;
    // t² is F-distributed with one degree of freedom above.
    f_tail(square * freedom / (1.0 - square), 1.0, freedom)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Sessions of 200 samples with these temperatures, days and gains.
    fn dataset(each: &[(f64, f64, Option<f64>)]) -> Dataset {
        let session = |&(temperature, day, gain): &(f64, f64, Option<f64>)| {
            let wave = |size: f64| (0..200).map(move |n| size * (0.1 * f64::from(n)).sin());
            RecordedSession {
                start: day * 86_400.0,
                period: 0.01,
                position: wave(1.0).collect(),
                motor_torque: wave(5.0).collect(),
                temperature: Some(wave(0.2).map(|own| own + temperature).collect()),
                extra: BTreeMap::from([("supply".to_owned(), wave(0.5).collect())]),
                conditions: gain.map(|own| ("kp".to_owned(), own)).into_iter().collect(),
                ..RecordedSession::default()
            }
        };
        Dataset {
            sessions: each.iter().map(session).collect(),
            ..Dataset::default()
        }
    }

    #[test]
    fn temperature_that_rises_with_the_gain_is_said() {
        // The means of the XL330's sixteen runs: r = 0.934 (NumPy).
        let runs = [
            (100.0, [28.99, 28.16, 29.00, 28.98]),
            (200.0, [29.07, 29.00, 30.34, 29.33]),
            (400.0, [32.00, 30.47, 33.78, 32.21]),
            (800.0, [36.56, 33.79, 39.02, 36.59]),
        ];
        let runs: Vec<_> = (runs.iter())
            .flat_map(|(gain, four)| four.map(|own| (own, 0.0, Some(*gain))))
            .collect();
        let found = find(&dataset(&runs));
        let [pair] = found.as_slice() else {
            panic!("{found:?}");
        };
        assert_eq!(pair.signals, ["temperature", "kp"]);
        assert!((pair.correlation - 0.934).abs() < 0.002, "{pair:?}");
        assert_eq!(
            pair.text(),
            "temperature and kp rise together (correlation 0.93 over 16 sessions): an effect of one cannot be told \
             from an effect of the other"
        );
    }

    #[test]
    fn temperature_that_falls_with_the_date_is_said() {
        let days = [0.0, 30.0, 61.0, 92.0, 122.0, 150.0];
        let each = days.map(|day| (25.0 - 0.1 * day, day, None));
        let found = find(&dataset(&each));
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].signals, ["temperature", "date"]);
        assert!(
            found[0]
                .text()
                .starts_with("temperature falls as date rises (correlation -1.00 over 6")
        );
    }

    #[test]
    fn dates_out_of_order_with_temperature_are_no_matter() {
        let temperatures = [3.0, 21.0, -5.0, 14.0, 26.0, 9.0];
        let each: Vec<_> = (temperatures.iter().zip(0..))
            .map(|(own, number)| (*own, 17.0 * f64::from(number), Some(100.0)))
            .collect();
        assert_eq!(find(&dataset(&each)), []);
    }

    #[test]
    fn three_sessions_are_too_few_and_a_condition_may_be_unknown_in_some() {
        let each = [0.0, 1.0, 2.0, 3.0, 4.0].map(|n| (20.0 + n, 0.0, (n < 3.0).then_some(n)));
        assert_eq!(find(&dataset(&each)), []);
        let known = each.map(|(t, day, _)| (t, day, Some(t)));
        assert_eq!(find(&dataset(&known)).len(), 1);
        assert_eq!(find(&dataset(&known[..3])), []);
    }

    /// Anscombe's first set: r = 0.816, p = 0.00217 with nine degrees of freedom.
    #[test]
    fn its_p_value_is_that_of_tables() {
        assert!((p_value(0.816_421, 11) - 0.00217).abs() < 1e-5);
    }
}

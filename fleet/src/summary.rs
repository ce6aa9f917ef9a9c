//! A day of a joint, as a line of JSON.

use std::collections::BTreeMap;

use chrono::{Days, NaiveDate};
use serde::{Deserialize, Serialize};

/// What the twin of a joint said on a day.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DaySummary {
    /// The day in UTC, as `2026-11-25`.
    pub day: String,
    /// Which robot.
    pub robot: String,
    /// Which of its joints.
    pub joint: String,
    /// Mean temperature \[degC\]; left out where it is not measured.
    #[serde(
        rename = "temperature_degC",
        default,
        skip_serializing_if = "Option::is_none"
    )]
    pub temperature: Option<f64>,
    /// Words of the twin that it is the mean of, 1 or more: lines of the same day are put
    /// together by it.
    #[serde(default = "one")]
    pub samples: u64,
    /// Parameters that the motion told something of, by name.
    pub parameters: BTreeMap<String, ParameterOfDay>,
}

fn one() -> u64 {
    1
}

/// A parameter on a day, in the lab's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterOfDay {
    /// Mean.
    pub value: f64,
    /// Standard error that the twin told, mean.
    pub std_error: f64,
}

/// Why a text holds no days.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SummaryError {
    /// A line is none.
    #[error(
        "line {line}: {reason}; a line is {{\"day\": \"2026-11-25\", \"robot\": \"left\", \"joint\": \"joint_2\", \
         \"temperature_degC\": 12.1, \"parameters\": {{\"b0\": {{\"value\": 12.3, \"std_error\": 0.1}}}}}}"
    )]
    Line {
        /// Which, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
}

impl DaySummary {
    /// Its day, from 1970-01-01 on; days before that are negative.
    ///
    /// # Errors
    ///
    /// What is wrong with it, in words.
    pub fn number(&self) -> Result<i64, String> {
        let date = NaiveDate::parse_from_str(&self.day, "%Y-%m-%d")
            .map_err(|error| format!("day {:?}: {error}; write 2026-11-25", self.day))?;
        Ok(date.signed_duration_since(NaiveDate::default()).num_days())
    }

    fn check(&self) -> Result<(), String> {
        self.number()?;
        if self.robot.is_empty() || self.joint.is_empty() {
            return Err("robot and joint need a name".to_owned());
        }
        if self.samples < 1 {
            return Err(
                "samples = 0 is the mean of nothing; give 1 or more, or leave it out".to_owned(),
            );
        }
        let bad = |own: &ParameterOfDay| {
            !(own.value.is_finite() && own.std_error.is_finite() && own.std_error >= 0.0)
        };
        match self.parameters.iter().find(|(_, own)| bad(own)) {
            Some((name, own)) => Err(format!(
                "{name}: value {} and std_error {} have to be numbers, the second not negative",
                own.value, own.std_error
            )),
            None => Ok(()),
        }
    }

    /// Takes another line of the same joint and day.
    fn add(&mut self, other: &DaySummary) {
        let (own, more) = (self.samples as f64, other.samples as f64);
        let mean = |a: f64, b: f64| (own * a + more * b) / (own + more).max(1.0);
        self.temperature = match (self.temperature, other.temperature) {
            (Some(a), Some(b)) => Some(mean(a, b)),
            (a, b) => a.or(b),
        };
        for (name, value) in &other.parameters {
            let place = self.parameters.entry(name.clone()).or_insert(*value);
            place.value = mean(place.value, value.value);
            place.std_error = mean(place.std_error, value.std_error);
        }
        self.samples = self.samples.saturating_add(other.samples);
    }
}

/// The date of a day from 1970 on, as a summary has it.
pub(crate) fn date(day: i64) -> String {
    let origin = NaiveDate::default();
    let days = Days::new(day.unsigned_abs());
    let date = match day < 0 {
        true => origin.checked_sub_days(days),
        false => origin.checked_add_days(days),
    };
    date.unwrap_or(origin).format("%Y-%m-%d").to_string()
}

/// Reads lines of JSON; empty ones are passed over.
///
/// # Errors
///
/// [`SummaryError`], of the first line that is none.
pub fn read(text: &str) -> Result<Vec<DaySummary>, SummaryError> {
    let lines = text.lines().enumerate();
    let lines = lines.filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(i, line)| {
            let bad = |reason: String| SummaryError::Line {
                line: i + 1,
                reason,
            };
            let own: DaySummary =
                serde_json::from_str(line).map_err(|error| bad(error.to_string()))?;
            own.check().map_err(bad)?;
            Ok(own)
        })
        .collect()
}

/// Summaries by their days, in order; of a joint's day one, put together. Those without a
/// valid day are left out.
pub fn days(all: &[DaySummary]) -> BTreeMap<i64, Vec<DaySummary>> {
    let mut found: BTreeMap<i64, BTreeMap<(&str, &str), DaySummary>> = BTreeMap::new();
    for own in all {
        let Ok(day) = own.number() else {
            continue;
        };
        let place = found
            .entry(day)
            .or_default()
            .entry((&own.robot, &own.joint));
        place
            .and_modify(|first| first.add(own))
            .or_insert_with(|| own.clone());
    }
    let joints = |(day, own): (i64, BTreeMap<_, DaySummary>)| (day, own.into_values().collect());
    found.into_iter().map(joints).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = r#"{"day":"1970-01-03","robot":"left","joint":"joint_2","temperature_degC":10.0,"samples":3,"parameters":{"b0":{"value":12.0,"std_error":0.1}}}"#;

    #[test]
    fn lines_are_what_was_written() {
        let read = read(&format!("{LINE}\n\n")).expect("a line");
        assert_eq!(read.len(), 1);
        assert_eq!(read[0].number(), Ok(2));
        assert_eq!(date(2), "1970-01-03");
        assert_eq!(date(-1), "1969-12-31");
        assert_eq!(serde_json::to_string(&read[0]).expect("JSON"), LINE);
    }

    #[test]
    fn two_lines_of_a_day_are_their_mean() {
        let other = LINE
            .replace("12.0", "16.0")
            .replace("10.0", "14.0")
            .replace("\"samples\":3", "\"samples\":1");
        let all = read(&format!("{LINE}\n{other}")).expect("lines");
        let days = days(&all);
        let day = &days[&2];
        assert_eq!(day.len(), 1);
        assert_eq!(day[0].parameters["b0"].value, 13.0);
        assert_eq!(day[0].temperature, Some(11.0));
        assert_eq!(day[0].samples, 4);
    }

    #[test]
    fn lines_of_more_words_than_can_be_counted_are_their_mean_still() {
        let most = LINE.replace("\"samples\":3", &format!("\"samples\":{}", u64::MAX));
        let other = most.replace("12.0", "16.0");
        let days = days(&read(&format!("{most}\n{other}")).expect("lines"));
        let own = &days[&2][0];
        assert_eq!((own.samples, own.parameters["b0"].value), (u64::MAX, 14.0));
    }

    #[test]
    fn what_is_no_line_is_refused_with_its_number() {
        for (wrong, words) in [
            (LINE.replace("1970-01-03", "yesterday"), "2026-11-25"),
            (LINE.replace("0.1", "-0.1"), "b0"),
            (LINE.replace("left", ""), "robot"),
            (
                LINE.replace("joint_2", "joint_2\",\"colour\":\"red"),
                "colour",
            ),
            (LINE.replace("\"samples\":3", "\"samples\":0"), "samples"),
            ("{".to_owned(), "line 2"),
        ] {
            let error = read(&format!("{LINE}\n{wrong}"))
                .expect_err("refused")
                .to_string();
            assert!(error.contains(words) && error.contains("line 2"), "{error}");
        }
    }
}

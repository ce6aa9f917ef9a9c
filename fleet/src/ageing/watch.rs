//! All joints of all robots.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::group::{Change, Group, Value};
use super::spread::Spread;
use super::threshold::threshold;

/// What is told, and how often it may be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WatchSettings {
    /// False alarms that are tolerated of the whole fleet \[1/year\].
    pub false_alarms: f64,
    /// The least change that is told, as a share of the siblings' size \[1\].
    pub least_change: f64,
    /// The least step that is told: smaller ones another load makes \[1\].
    pub least_step: f64,
}

impl Default for WatchSettings {
    fn default() -> WatchSettings {
        WatchSettings {
            false_alarms: 1.0,
            least_change: 0.05,
            least_step: 0.3,
        }
    }
}

/// A parameter of a robot's joint on a day.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading<'a> {
    /// Which robot.
    pub robot: &'a str,
    /// Which of its joints; siblings are the joints of the same name.
    pub joint: &'a str,
    /// Which parameter.
    pub parameter: &'a str,
    /// Its value, in a unit of its own.
    pub value: f64,
    /// Standard error that the twin tells, in the same unit.
    pub std_error: f64,
    /// Mean temperature of the joint on that day \[degC\]; `None` where it is not measured.
    pub temperature: Option<f64>,
}

/// By how much in its square the evidence of a ramp has to be beyond that of any step.
const BEYOND_STEP: f64 = 10.0;

/// The course of a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// More every day.
    Ramp,
    /// At once, and then no more.
    Step,
}

/// How a parameter of a joint changes beside its siblings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Standing {
    /// Which robot.
    pub robot: String,
    /// Which joint.
    pub joint: String,
    /// Which parameter.
    pub parameter: String,
    /// Its course.
    pub kind: Kind,
    /// The last day without a change, if there is one: a number of days, as it was given.
    #[serde(skip)]
    pub after: i64,
    /// Change since then beside the siblings, in the parameter's unit.
    pub change: f64,
    /// The same as a share of the siblings' size \[1\].
    pub share: f64,
    /// Evidence of a change, in standard deviations of a normal distribution; its sign is the change's.
    pub evidence: f64,
}

/// A joint that ages differently.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The day on which it was named.
    pub day: i64,
    /// The parameter with the most evidence, and then the others of the joint that change, too.
    pub parameters: Vec<Standing>,
    /// How much evidence it takes.
    pub threshold: f64,
}

/// Why a day is not taken.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DayError {
    /// It is not after the last one.
    #[error("day {day} was given after day {newest}; give days in their order, each once")]
    Order {
        /// The day given.
        day: i64,
        /// The newest day that was taken.
        newest: i64,
    },
}

/// Follows a fleet day by day.
#[derive(Clone, Debug)]
pub struct Watch {
    settings: WatchSettings,
    /// By joint and parameter.
    groups: BTreeMap<(String, String), Group>,
    newest: Option<i64>,
}

impl Watch {
    /// Before the first day.
    pub fn new(settings: WatchSettings) -> Watch {
        Watch {
            settings,
            groups: BTreeMap::new(),
            newest: None,
        }
    }

    /// How much evidence names a joint now.
    pub fn threshold(&self) -> f64 {
        let series = self.groups.values().map(Group::members).sum();
        threshold(series, self.settings.false_alarms)
    }

    /// Takes what was read on a day; gives the joints that age differently, of each name
    /// one at most: the next may be so because of it. Values that are no numbers are left out.
    ///
    /// # Errors
    ///
    /// [`DayError`].
    pub fn day(&mut self, day: i64, readings: &[Reading]) -> Result<Vec<Finding>, DayError> {
        if let Some(newest) = self.newest.filter(|newest| day <= *newest) {
            return Err(DayError::Order { day, newest });
        }
        self.newest = Some(day);
        let mut values: BTreeMap<(&str, &str), Vec<Value>> = BTreeMap::new();
        for own in readings {
            let temperature = own.temperature.filter(|t| t.is_finite());
            if own.value.is_finite() && own.std_error.is_finite() && own.std_error >= 0.0 {
                let value = Value {
                    robot: own.robot,
                    value: own.value,
                    std_error: own.std_error,
                    temperature,
                };
                values
                    .entry((own.joint, own.parameter))
                    .or_default()
                    .push(value);
            }
        }
        let mut told = BTreeSet::new();
        for ((joint, parameter), values) in values {
            let key = (joint.to_owned(), parameter.to_owned());
            let group = self.groups.entry(key.clone());
            group
                .or_insert_with(|| Group::new(&values))
                .take(day, &values);
            told.insert(key);
        }
        let threshold = self.threshold();
        let mut standings = self.standings_of(|key| told.contains(key));
        let mut findings = Vec::new();
        while let Some(worst) = standings
            .iter()
            .find(|own| self.is_told(own, threshold))
            .cloned()
        {
            let same = |own: &&Standing| own.robot == worst.robot && own.joint == worst.joint;
            // Half the evidence is enough for what goes along.
            let with = standings.iter().filter(same);
            let with = with.filter(|own| own.evidence.abs() > 0.5 * threshold);
            let parameters: Vec<Standing> = with.cloned().collect();
            for ((joint, _), group) in &mut self.groups {
                if *joint == worst.joint {
                    group.restart(&worst.robot, day);
                }
            }
            standings.retain(|own| own.joint != worst.joint);
            findings.push(Finding {
                day,
                parameters,
                threshold,
            });
        }
        Ok(findings)
    }

    fn is_told(&self, own: &Standing, threshold: f64) -> bool {
        let least = match own.kind {
            Kind::Ramp => self.settings.least_change,
            Kind::Step => self.settings.least_step,
        };
        own.evidence.abs() >= threshold && own.share.abs() >= least
    }

    /// How everything stood on the newest day, most evidence first.
    pub fn standings(&self) -> Vec<Standing> {
        self.standings_of(|_| true)
    }

    fn standings_of(&self, is_asked: impl Fn(&(String, String)) -> bool) -> Vec<Standing> {
        let newest = self.newest.unwrap_or_default();
        let groups = self.groups.iter().filter(|(key, _)| is_asked(key));
        let all: Vec<_> = groups
            .flat_map(|(key, group)| group.changes().map(move |own| (key, group.size, own)))
            .collect();
        // What happens to a joint happens to all of its parameters: together they tell its course.
        let mut beyond: BTreeMap<(&str, &str), f64> = BTreeMap::new();
        for ((joint, _), _, (robot, change)) in &all {
            let sum = beyond.entry((joint.as_str(), *robot)).or_default();
            *sum += change.ramp.score.powi(2) - change.step.score.powi(2);
        }
        let standing = |((joint, parameter), size, (robot, change)): &(
            &(String, String),
            f64,
            (&str, Change),
        )| {
            let ramp = beyond[&(joint.as_str(), *robot)] >= BEYOND_STEP;
            let (kind, course, share) = match ramp {
                true => (
                    Kind::Ramp,
                    change.ramp,
                    change.ramp.size * (newest - change.ramp.after) as f64,
                ),
                false => (Kind::Step, change.step, change.step.size),
            };
            Standing {
                robot: (*robot).to_owned(),
                joint: joint.clone(),
                parameter: parameter.clone(),
                kind,
                after: course.after,
                change: share * size,
                share,
                evidence: course.score,
            }
        };
        let mut all: Vec<Standing> = all.iter().map(standing).collect();
        all.sort_by(|a, b| b.evidence.abs().total_cmp(&a.evidence.abs()));
        all
    }

    /// How the robots differ in a parameter of a joint, once that was fitted.
    pub fn spread(&self, joint: &str, parameter: &str) -> Option<&Spread> {
        let key = (joint.to_owned(), parameter.to_owned());
        self.groups.get(&key).and_then(Group::spread)
    }
}

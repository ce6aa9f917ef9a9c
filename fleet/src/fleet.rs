//! Days brought before the watch.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::ageing::{DayError, Finding, Kind, Reading, Standing, Watch, WatchSettings};
use crate::summary::{DaySummary, date};

/// A joint that was named.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Named {
    /// Which robot.
    pub robot: String,
    /// Which of its joints.
    pub joint: String,
    /// The day on which it was named.
    pub day: String,
    /// Since when it changes.
    pub since: String,
    /// The course of the change.
    pub kind: Kind,
    /// Evidence, in standard deviations, and how much of it names a joint.
    pub evidence: f64,
    /// See [`Named::evidence`].
    pub threshold: f64,
    /// The parameters that change beside the siblings', most evidence first.
    pub parameters: Vec<Standing>,
}

/// What a fleet is told to be like.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Told {
    /// Days that were looked at.
    pub days: usize,
    /// The first and the last of them.
    pub from: Option<String>,
    /// See [`Told::from`].
    pub to: Option<String>,
    /// Robots.
    pub robots: usize,
    /// Joints of all robots.
    pub joints: usize,
    /// How much evidence names a joint now.
    pub threshold: f64,
    /// The joints that age differently, as they were named.
    pub named: Vec<Named>,
    /// How the joints stand today, most evidence first.
    pub standing: Vec<Standing>,
}

/// A fleet.
#[derive(Clone, Debug)]
pub struct Fleet {
    watch: Watch,
    joints: BTreeSet<(String, String)>,
    days: Vec<i64>,
    named: Vec<Named>,
}

impl Fleet {
    /// Before the first day.
    pub fn new(settings: WatchSettings) -> Fleet {
        Fleet {
            watch: Watch::new(settings),
            joints: BTreeSet::new(),
            days: Vec::new(),
            named: Vec::new(),
        }
    }

    /// Takes a day of all joints; gives those that are named.
    ///
    /// # Errors
    ///
    /// [`DayError`]: a day that is not after the last one.
    pub fn day(&mut self, day: i64, summaries: &[DaySummary]) -> Result<&[Named], DayError> {
        let readings = summaries.iter().flat_map(|own| {
            own.parameters.iter().map(|(parameter, value)| Reading {
                robot: &own.robot,
                joint: &own.joint,
                parameter,
                value: value.value,
                std_error: value.std_error,
                temperature: own.temperature,
            })
        });
        let readings: Vec<Reading> = readings.collect();
        let found = self.watch.day(day, &readings)?;
        for own in summaries {
            self.joints.insert((own.robot.clone(), own.joint.clone()));
        }
        self.days.push(day);
        let before = self.named.len();
        self.named.extend(found.into_iter().filter_map(named));
        Ok(&self.named[before..])
    }

    /// What is to be told, with the `most` joints' parameters that stand out.
    pub fn told(&self, most: usize) -> Told {
        let robots: BTreeSet<&String> = self.joints.iter().map(|(robot, _)| robot).collect();
        let mut standing = self.watch.standings();
        standing.truncate(most);
        Told {
            days: self.days.len(),
            from: self.days.first().map(|day| date(*day)),
            to: self.days.last().map(|day| date(*day)),
            robots: robots.len(),
            joints: self.joints.len(),
            threshold: self.watch.threshold(),
            named: self.named.clone(),
            standing,
        }
    }

    /// The newest day that was taken, from 1970 on.
    pub fn newest(&self) -> Option<i64> {
        self.days.last().copied()
    }

    /// Takes days in their order, as [`summary::days`](crate::days) gives them.
    ///
    /// # Errors
    ///
    /// As [`Fleet::day`].
    pub fn days(&mut self, days: &BTreeMap<i64, Vec<DaySummary>>) -> Result<(), DayError> {
        days.iter()
            .try_for_each(|(day, own)| self.day(*day, own).map(|_| ()))
    }
}

fn named(own: Finding) -> Option<Named> {
    let first = own.parameters.first()?;
    Some(Named {
        robot: first.robot.clone(),
        joint: first.joint.clone(),
        day: date(own.day),
        since: date(first.after),
        kind: first.kind,
        evidence: first.evidence,
        threshold: own.threshold,
        parameters: own.parameters,
    })
}

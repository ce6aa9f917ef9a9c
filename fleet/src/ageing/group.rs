//! The same parameter of the same joint on all robots.

use super::filter::Filter;
use super::fit::fit;
use super::location::middle;
use super::onsets::{Best, Course};
use super::pass::{NAMED, pass, step};
use super::series::{Observation, Series, WARMTH};
use super::spread::Spread;
use super::threshold::normal_score;

/// Days with values before the spread is fitted, and anybody can be named.
const FIRST_FIT: usize = 6;
/// Days that are kept \[d\].
const KEPT: i64 = 400;

/// A step is done with, and the level unknown again, where it is sure, at least so many days
/// old, and no ramp is as good, by so much in the square of the evidence.
const SURE_STEP: f64 = 4.5;
const STEP_HOLDS: i64 = 6;
const BEYOND_RAMP: f64 = 6.0;

/// A change of one series; sizes are shares of the siblings' size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    /// The best ramp; its score is what a normal distribution has as often.
    pub ramp: Course,
    /// The best step, likewise.
    pub step: Course,
}

/// Siblings.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// What their values are shares of, in the parameter's unit.
    pub size: f64,
    reference: f64,
    robots: Vec<String>,
    series: Vec<Series>,
    filters: Vec<Filter>,
    spread: Spread,
    fitted: bool,
    days: usize,
    next_fit: usize,
    newest: i64,
}

/// A value in the parameter's unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Value<'a> {
    pub robot: &'a str,
    pub value: f64,
    pub std_error: f64,
    pub temperature: Option<f64>,
}

impl Group {
    /// A group whose first values are `values`.
    pub fn new(values: &[Value]) -> Group {
        let size = middle(values.iter().map(|own| own.value.abs())).unwrap_or(0.0);
        let errors = middle(values.iter().map(|own| own.std_error)).unwrap_or(0.0);
        // A parameter around zero has no size of its own.
        let size = size.max(3.0 * errors).max(1e-12);
        Group {
            size,
            reference: middle(values.iter().filter_map(|own| own.temperature)).unwrap_or(0.0),
            robots: Vec::new(),
            series: Vec::new(),
            filters: Vec::new(),
            spread: Spread::before(errors / size),
            fitted: false,
            days: 0,
            next_fit: FIRST_FIT,
            newest: i64::MIN,
        }
    }

    /// Takes a day's values.
    pub fn take(&mut self, day: i64, values: &[Value]) {
        let mut today = Vec::new();
        for own in values {
            let place = self.place(own.robot);
            if today.iter().any(|(other, _)| *other == place) {
                continue;
            }
            let warmth = own
                .temperature
                .map_or(0.0, |t| (t - self.reference) / WARMTH);
            let observation = Observation {
                day,
                value: own.value / self.size,
                std_error: own.std_error / self.size,
                warmth,
            };
            today.push((place, observation));
        }
        if today.is_empty() {
            return;
        }
        for (place, observation) in &today {
            self.series[*place].days.push(*observation);
        }
        self.newest = day;
        self.days += 1;
        if self.days < self.next_fit {
            step(
                &mut self.filters,
                &self.series,
                &self.spread,
                &today,
                |_, _, _| {},
            );
        } else {
            self.fit(day);
        }
        if self.fitted {
            self.settle_steps();
        }
    }

    fn fit(&mut self, day: i64) {
        self.next_fit = (self.days + self.days / 4).max(self.days + 1);
        for own in &mut self.series {
            own.forget_before(day - KEPT);
        }
        self.spread = fit(&self.series, &self.spread, !self.fitted);
        self.fitted = true;
        self.filters = pass(&self.series, &self.spread, true).filters;
    }

    fn place(&mut self, robot: &str) -> usize {
        let place = self.robots.iter().position(|own| own == robot);
        place.unwrap_or_else(|| {
            self.robots.push(robot.to_owned());
            self.series.push(Series::default());
            self.filters.push(Filter::new(&self.spread, true));
            self.robots.len() - 1
        })
    }

    /// How many robots told something within the last days.
    pub fn members(&self) -> usize {
        let told = |own: &&Series| {
            own.days
                .last()
                .is_some_and(|last| self.newest - last.day < NAMED)
        };
        self.series.iter().filter(told).count()
    }

    /// How the robots differ, once that was fitted.
    pub fn spread(&self) -> Option<&Spread> {
        self.fitted.then_some(&self.spread)
    }

    /// Robots that told something on the newest day, and how they change.
    pub fn changes(&self) -> impl Iterator<Item = (&str, Change)> {
        let all = self.robots.iter().enumerate();
        all.filter_map(|(place, robot)| {
            let told = self.fitted && self.series[place].days.last()?.day == self.newest;
            told.then_some(())?;
            Some((robot.as_str(), self.change(place)?))
        })
    }

    fn change(&self, place: usize) -> Option<Change> {
        let filter = &self.filters[place];
        let Best { ramp, step } = filter.best()?;
        let (scale, freedom) = filter.scale(self.spread.alike);
        let normal = |own: Course| Course {
            score: normal_score(own.score / scale, freedom),
            ..own
        };
        Some(Change {
            ramp: normal(ramp),
            step: normal(step),
        })
    }

    /// Levels are unknown again where a step is done with.
    fn settle_steps(&mut self) {
        for place in 0..self.robots.len() {
            let Some(Change { ramp, step }) = self.change(place) else {
                continue;
            };
            let old = self.newest - step.after > STEP_HOLDS;
            let better = step.score * step.score - ramp.score * ramp.score > BEYOND_RAMP;
            if old && better && step.score.abs() > SURE_STEP {
                self.series[place].restarts.push(self.newest);
                self.filters[place].restart();
            }
        }
    }

    /// A robot was named on `day`: its level is unknown again, and it says nothing of its siblings.
    pub fn restart(&mut self, robot: &str, day: i64) {
        if let Some(place) = self.robots.iter().position(|own| own == robot) {
            self.series[place].named.push(day);
            self.series[place].restarts.push(day);
            self.filters[place].restart();
        }
    }
}

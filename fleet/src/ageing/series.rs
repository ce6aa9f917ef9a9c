//! One parameter of one robot's joint over the days.

/// Temperatures are counted in steps of this \[K\], so that slopes and curvatures are of like size.
pub(super) const WARMTH: f64 = 10.0;

/// A day's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observation {
    /// Day, from any origin.
    pub day: i64,
    /// Value as a share of the siblings' size \[1\].
    pub value: f64,
    /// Its standard error as told by the twin, as such a share \[1\].
    pub std_error: f64,
    /// Temperature from the siblings' reference, in steps of [`WARMTH`]; zero where none is known.
    pub warmth: f64,
}

/// The days of one robot, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Series {
    pub days: Vec<Observation>,
    /// Days on which it was named.
    pub named: Vec<i64>,
    /// Days after which its level was unknown again: it was named, or had made a step.
    pub restarts: Vec<i64>,
}

impl Series {
    /// Whether it was named on one of the `days` before `day`, or on it.
    pub fn is_named(&self, day: i64, days: i64) -> bool {
        let named = self.named.iter().rev().find(|own| **own <= day);
        named.is_some_and(|own| day - own < days)
    }

    /// Forgets what is older than `first`.
    pub fn forget_before(&mut self, first: i64) {
        self.days.retain(|own| own.day >= first);
    }
}

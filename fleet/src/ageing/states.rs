//! The states of the model of one series, and what a day does to them.
//!
//! y = level + slope w + curvature w² + wander + e, w the temperature; the level moves by
//! the drift and a random walk, the wander fades as an autoregression of first order.

use super::series::Observation;
use super::spread::Spread;

const STATES: usize = 5;
const LEVEL: usize = 0;
const DRIFT: usize = 1;
pub(super) const SLOPE: usize = 2;
pub(super) const CURVATURE: usize = 3;
const WANDER: usize = 4;

/// A value for each state.
pub(super) type Vector = [f64; STATES];

/// Variance of a level that nothing is known of: shares of the siblings' size are near 1.
const UNKNOWN_LEVEL: f64 = 4.0;
/// What is left of the wander after a day \[1\].
const WANDER_KEEPS: f64 = 0.75;

/// How far a day's value is from what was expected.
#[derive(Clone, Copy, Debug)]
pub(super) struct Innovation {
    pub residual: f64,
    pub variance: f64,
}

/// What the siblings did together on a day, and its variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Common {
    pub value: f64,
    pub variance: f64,
}

impl Innovation {
    /// Less what the siblings did together.
    pub fn without(self, common: Common) -> Innovation {
        Innovation {
            residual: self.residual - common.value,
            variance: (self.variance + common.variance).max(1e-18),
        }
    }

    /// In standard deviations.
    pub fn standard(self) -> f64 {
        self.residual / self.variance.sqrt()
    }
}

/// What is believed of the states.
#[derive(Clone, Debug)]
pub(super) struct States {
    pub mean: Vector,
    pub covariance: [Vector; STATES],
    day: Option<i64>,
}

/// What is left of the wander after a number of days \[1\].
fn kept(days: f64) -> f64 {
    // Nearly every step is one of a day, and a power costs as much as the rest of it.
    if days == 1.0 {
        WANDER_KEEPS
    } else {
        WANDER_KEEPS.powf(days)
    }
}

/// Moves states on by a number of days.
pub(super) fn moved(days: f64) -> impl Fn(&mut Vector) {
    let keeps = kept(days);
    move |states: &mut Vector| {
        states[LEVEL] += days * states[DRIFT];
        states[WANDER] *= keeps;
    }
}

impl States {
    /// Before the first day.
    pub fn new(spread: &Spread) -> States {
        let mut covariance = [[0.0; STATES]; STATES];
        covariance[LEVEL][LEVEL] = UNKNOWN_LEVEL;
        covariance[DRIFT][DRIFT] = spread.drift;
        covariance[SLOPE][SLOPE] = spread.slope;
        covariance[CURVATURE][CURVATURE] = spread.curvature;
        covariance[WANDER][WANDER] = spread.wander;
        let mut mean = [0.0; STATES];
        mean[SLOPE] = spread.mean_slope;
        mean[CURVATURE] = spread.mean_curvature;
        States {
            mean,
            covariance,
            day: None,
        }
    }

    /// The level is unknown from now on.
    pub fn forget_level(&mut self) {
        self.covariance[LEVEL][LEVEL] += UNKNOWN_LEVEL;
    }

    /// Goes on to `day`; gives by how many days.
    pub fn predict(&mut self, day: i64, spread: &Spread) -> f64 {
        let days = self.day.map_or(0, |own| (day - own).max(0)) as f64;
        self.day = Some(day);
        if days == 0.0 {
            return days;
        }
        let keeps = kept(days);
        let moved = moved(days);
        moved(&mut self.mean);
        // F P Fᵀ: rows, then columns.
        self.covariance.iter_mut().for_each(&moved);
        for column in 0..STATES {
            self.covariance[LEVEL][column] += days * self.covariance[DRIFT][column];
            self.covariance[WANDER][column] *= keeps;
        }
        self.covariance[LEVEL][LEVEL] += days * spread.walk;
        self.covariance[WANDER][WANDER] += (1.0 - keeps * keeps) * spread.wander;
        days
    }

    /// What `own` says beyond what was expected.
    pub fn innovation(&self, own: &Observation, spread: &Spread) -> Innovation {
        let h = row(own.warmth);
        Innovation {
            residual: own.value - dot(&h, &self.mean),
            variance: dot(&h, &self.times(&h)) + spread.noise_of(own.std_error),
        }
    }

    /// P h.
    pub fn times(&self, h: &Vector) -> Vector {
        self.covariance.map(|row| dot(&row, h))
    }
}

/// What an observation at that warmth sees of the states.
pub(super) fn row(warmth: f64) -> Vector {
    let mut h = [0.0; STATES];
    h[LEVEL] = 1.0;
    h[SLOPE] = warmth;
    h[CURVATURE] = warmth * warmth;
    h[WANDER] = 1.0;
    h
}

/// aᵀ b.
pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

//! Likelihood ratios of a ramp and of a step, for every day on which they may have begun.
//!
//! A step is what another load or a repair does: a ramp counts as far as it explains more
//! than the best step.

use super::states::{Vector, dot};

/// Days back on which every onset is tried \[d\].
const RECENT: i64 = 30;
/// Beyond them one of so many is kept.
const THINNED: i64 = 4;
/// The oldest onset that is kept \[d\].
const OLDEST: i64 = 90;
/// A ramp is told after so many values of its own at least, a step after so many.
const RAMP_VALUES: u32 = 6;
const STEP_VALUES: u32 = 2;

/// What may have begun after a day.
#[derive(Clone, Debug)]
struct Onset {
    /// The last day without a change.
    after: i64,
    ramp: Evidence,
    step: Evidence,
    values: u32,
}

/// Of a change of a given course and of size 1.
#[derive(Clone, Debug, Default)]
struct Evidence {
    /// What the filter took it for.
    taken: Vector,
    /// Σ g ν / V and Σ g² / V, g being what it leaves in the innovations ν of variance V.
    product: f64,
    information: f64,
}

impl Evidence {
    /// A value that the change moves by `moves`.
    fn update(&mut self, moves: f64, h: &Vector, gain: &Vector, residual: f64, variance: f64) {
        let left = moves - dot(h, &self.taken);
        self.product += left * residual / variance;
        self.information += left * left / variance;
        for (taken, k) in self.taken.iter_mut().zip(gain) {
            *taken += k * left;
        }
    }
}

/// A change that explains the innovations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Course {
    /// The last day without a change.
    pub after: i64,
    /// Its size, of a ramp a day.
    pub size: f64,
    /// Standard deviations of the size from zero, with its sign.
    pub score: f64,
}

/// The best ramp and the best step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Best {
    pub ramp: Course,
    pub step: Course,
}

/// The onsets that are tried.
#[derive(Clone, Debug)]
pub(super) struct Onsets {
    all: Vec<Onset>,
    on: bool,
}

impl Onsets {
    /// None so far; they are not followed where only the model is fitted.
    pub fn new(on: bool) -> Onsets {
        Onsets {
            all: Vec::new(),
            on,
        }
    }

    /// What came before does not count any more.
    pub fn clear(&mut self) {
        self.all.clear();
    }

    /// What was taken for something else moves on as the states do.
    pub fn predict(&mut self, moved: impl Fn(&mut Vector)) {
        for own in &mut self.all {
            moved(&mut own.ramp.taken);
            moved(&mut own.step.taken);
        }
    }

    /// A value of `day`, seen by `h` and learnt by `gain`; `residual` is bounded, `variance` its own.
    pub fn update(&mut self, day: i64, h: &Vector, gain: &Vector, residual: f64, variance: f64) {
        if !self.on {
            return;
        }
        self.all.retain(|own| {
            let age = day - own.after;
            age <= RECENT || (age <= OLDEST && own.after.rem_euclid(THINNED) == 0)
        });
        self.all.push(Onset {
            after: day - 1,
            ramp: Evidence::default(),
            step: Evidence::default(),
            values: 0,
        });
        for own in &mut self.all {
            let days = (day - own.after) as f64;
            own.ramp.update(days, h, gain, residual, variance);
            own.step.update(1.0, h, gain, residual, variance);
            own.values += 1;
        }
    }

    /// The ramp and the step with the most evidence.
    pub fn best(&self) -> Option<Best> {
        let told = |least: u32| self.all.iter().filter(move |own| own.values >= least);
        let of = |own: &Onset, evidence: &Evidence| {
            (evidence.information > 0.0).then(|| Course {
                after: own.after,
                size: evidence.product / evidence.information,
                score: evidence.product / evidence.information.sqrt(),
            })
        };
        let more = |a: &Course, b: &Course| a.score.abs().total_cmp(&b.score.abs());
        Some(Best {
            ramp: told(RAMP_VALUES)
                .filter_map(|own| of(own, &own.ramp))
                .max_by(more)?,
            step: told(STEP_VALUES)
                .filter_map(|own| of(own, &own.step))
                .max_by(more)?,
        })
    }
}

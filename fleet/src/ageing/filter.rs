//! The model of one series, followed from day to day by a Kalman filter.
//!
//! What is believed of it, and how that goes on from one day to the next: `states.rs`.

use super::onsets::{Best, Onsets};
use super::series::Observation;
use super::spread::Spread;
use super::states::{CURVATURE, Common, Innovation, SLOPE, States, moved, row};

/// Innovations beyond so many standard deviations count as this.
pub(super) const BOUND: f64 = 3.0;
/// By so much at most a neighbouring day that was odd in the same direction moves the bound.
const MOST_MOVED: f64 = 12.0;
/// A squared difference beyond this counts as this: one odd day is no noise scale.
const MOST_DIFFERENCE: f64 = 6.0;
/// How many of n successive differences are worth as much as independent values.
const WORTH: f64 = 2.0 / 3.0;

/// The filter. A single odd day is bounded; one among others that were as odd in the same
/// direction is none. That is known a day later: the newest day is learnt provisionally, and
/// once more with the next one.
#[derive(Clone, Debug)]
pub(super) struct Filter {
    settled: Core,
    newest: Option<(Observation, Common)>,
    core: Core,
}

impl Filter {
    /// Before the first day; ramps are followed where `onsets` says so.
    pub fn new(spread: &Spread, onsets: bool) -> Filter {
        let core = Core::new(spread, onsets);
        Filter {
            settled: core.clone(),
            newest: None,
            core,
        }
    }

    /// Goes on to `day`.
    pub fn predict(&mut self, day: i64, spread: &Spread) {
        self.core.predict(day, spread);
    }

    /// What `own` says beyond what was expected, without what the siblings do together.
    pub fn innovation(&self, own: &Observation, spread: &Spread) -> Innovation {
        self.core.innovation(own, spread)
    }

    /// Learns from `own`. Gives the standardized innovation and its variance, where the level
    /// was known before.
    pub fn update(
        &mut self,
        own: &Observation,
        common: Common,
        spread: &Spread,
    ) -> Option<(f64, f64)> {
        if let Some((before, its_common)) = self.newest {
            self.settled.predict(before.day, spread);
            // What the next day says where the day between is not believed.
            let mut without = self.settled.states();
            without.predict(own.day, spread);
            let next = without.innovation(own, spread).without(common).standard();
            self.settled.update(&before, its_common, Some(next), spread);
        }
        self.core.clone_from(&self.settled);
        self.core.predict(own.day, spread);
        self.newest = Some((*own, common));
        self.core.update(own, common, None, spread)
    }

    /// Its noise beside that of its siblings \[1\], a standard deviation, and how sure that is,
    /// in degrees of freedom; `alike` is what the siblings are worth.
    pub fn scale(&self, alike: f64) -> (f64, f64) {
        self.core.scale(alike)
    }

    /// The mean square of its own differences, and how many there are.
    pub fn own_scale(&self) -> Option<(f64, f64)> {
        let core = &self.core;
        (core.counted >= 3.0).then(|| (core.differences / core.counted, core.counted))
    }

    /// The ramp and the step with the most evidence.
    pub fn best(&self) -> Option<Best> {
        self.core.onsets.best()
    }

    /// The level is unknown from now on: it was named, and may be repaired.
    pub fn restart(&mut self) {
        self.core.restart();
        self.settled.clone_from(&self.core);
        self.newest = None;
    }

    /// Slope and curvature as found beyond `spread`'s means, and how much of what is
    /// unknown of them was learnt, from 0 to 1.
    pub fn learnt(&self, spread: &Spread) -> [(f64, f64); 2] {
        let States {
            mean, covariance, ..
        } = &self.core.states;
        let of =
            |i: usize, center: f64, prior: f64| (mean[i] - center, 1.0 - covariance[i][i] / prior);
        [
            of(SLOPE, spread.mean_slope, spread.slope),
            of(CURVATURE, spread.mean_curvature, spread.curvature),
        ]
    }
}

/// The filter with what it says of noise and changes.
#[derive(Clone, Debug)]
struct Core {
    states: States,
    /// Values since the level was unknown.
    seen: u32,
    before: Option<f64>,
    /// Halved squares of successive differences of standardized innovations: a noise scale
    /// that a slow change does not touch (von Neumann 1941).
    differences: f64,
    counted: f64,
    onsets: Onsets,
}

impl Core {
    fn new(spread: &Spread, onsets: bool) -> Core {
        Core {
            states: States::new(spread),
            seen: 0,
            before: None,
            differences: 0.0,
            counted: 0.0,
            onsets: Onsets::new(onsets),
        }
    }

    fn states(&self) -> States {
        self.states.clone()
    }

    fn predict(&mut self, day: i64, spread: &Spread) {
        let days = self.states.predict(day, spread);
        self.onsets.predict(moved(days));
    }

    fn innovation(&self, own: &Observation, spread: &Spread) -> Innovation {
        self.states.innovation(own, spread)
    }

    /// Learns from `own`; `next` is what the day after it says, standardized, where it is known.
    fn update(
        &mut self,
        own: &Observation,
        common: Common,
        next: Option<f64>,
        spread: &Spread,
    ) -> Option<(f64, f64)> {
        let innovation = self.innovation(own, spread).without(common);
        let Innovation { residual, variance } = innovation;
        let u = innovation.standard();
        let (scale, _) = self.scale(spread.alike);
        let as_odd = |other: Option<f64>| other.map_or(0.0, |other| other * u.signum());
        let neighbour = as_odd(self.before).max(as_odd(next));
        let bound = BOUND * scale + neighbour.clamp(0.0, MOST_MOVED);
        let weight = if u.abs() > bound {
            bound / u.abs()
        } else {
            1.0
        };
        let h = row(own.warmth);
        let ph = self.states.times(&h);
        let gain = ph.map(|x| x * weight / variance);
        self.onsets
            .update(own.day, &h, &gain, weight * residual, variance);
        for (i, k) in gain.iter().enumerate() {
            self.states.mean[i] += k * residual;
            for (j, x) in ph.iter().enumerate() {
                self.states.covariance[i][j] -= k * x;
            }
        }
        self.seen += 1;
        if self.seen < 2 {
            return None;
        }
        if let Some(before) = self.before {
            self.differences += ((u - before).powi(2) / 2.0).min(MOST_DIFFERENCE);
            self.counted += 1.0;
        }
        self.before = Some(u);
        Some((u, variance))
    }

    fn scale(&self, alike: f64) -> (f64, f64) {
        let freedom = alike + WORTH * self.counted;
        let squared = (alike + WORTH * self.differences) / freedom;
        (squared.sqrt().clamp(0.8, 4.0), freedom)
    }

    fn restart(&mut self) {
        self.states.forget_level();
        self.seen = 0;
        self.before = None;
        self.onsets.clear();
    }
}

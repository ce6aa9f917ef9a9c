//! Compliance of a surface by all that happened in the last second.

use super::compliance::{CORRELATION, Known, SOFTEST, STIFFEST};

/// Memory of the chord [s],
const CHORD: f64 = 1.0;
/// after the first moments of a contact, in which the arm brakes [s].
pub(super) const CHORD_WAIT: f64 = 0.1;
/// It takes so much of it [s]
const CHORD_LEAST: f64 = 0.2;
/// and, at the tip, a standard deviation of the force of so much [N] to tell something,
pub(super) const CHORD_SPREAD: f64 = 0.1;
/// which is known no better than this [-].
const CHORD_ERROR: f64 = 0.07;
/// What the chord tells comes to count within this time [s].
const CHORD_GROWTH: f64 = 0.2;
/// What it told is forgotten with this time constant [s].
const CHORD_LIFE: f64 = 10.0;

/// Compliance as the slope of depth over force in the last second of a contact: what a soft
/// surface shows to a tip that goes in evenly, of which a [`Slope`] learns nothing. A surface
/// that moves by itself misleads it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Chord {
    /// For how long [s].
    time: f64,
    /// Means of force and depth [N, m].
    force: f64,
    depth: f64,
    /// Variances and covariance [N², N·m, m²].
    spread: f64,
    common: f64,
    scatter: f64,
    /// The best that it told,
    pub best: Option<Known>,
    /// and how far that counts by now, 0 … 1: the tip goes after it.
    pub counts: f64,
}

impl Chord {
    /// After `dt` \[s\], at `depth` \[m\] under `force` \[N\] whose standard deviation has to be
    /// `spread` \[N\], and no less than that of its `noise` \[N\].
    pub fn add(&mut self, dt: f64, depth: f64, force: f64, spread: f64, noise: f64) {
        self.time += dt;
        let share = dt / self.time.min(CHORD);
        let (apart, away) = (force - self.force, depth - self.depth);
        self.force += share * apart;
        self.depth += share * away;
        let rest = 1.0 - share;
        self.spread = rest * (self.spread + share * apart * apart);
        self.common = rest * (self.common + share * apart * away);
        self.scatter = rest * (self.scatter + share * away * away);
        if let Some(best) = &mut self.best {
            best.weight *= 1.0 - dt / CHORD_LIFE;
            self.counts = (self.counts + dt / CHORD_GROWTH).min(1.0);
        }
        // Noise of the force makes its spread larger, and the slope by as much smaller.
        let told = self.spread - noise * noise;
        let least = spread.max(noise);
        if self.time < CHORD_LEAST || told < least * least || self.common <= 0.0 {
            return;
        }
        let slope = self.common / told;
        let left = (self.scatter - self.common * slope).max(0.0) / told;
        // Of so many values that tell something each by itself.
        let error = left * CORRELATION / self.time.min(CHORD) / (slope * slope);
        let told = Known {
            compliance: slope.clamp(1.0 / STIFFEST, 1.0 / SOFTEST),
            weight: 1.0 / (error + CHORD_ERROR * CHORD_ERROR),
        };
        if self.best.is_none_or(|best| told.weight > best.weight) {
            self.best = Some(told);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chord_does_not_move_what_is_known_well() {
        let known = |stiffness: f64, error: f64| Known {
            compliance: 1.0 / stiffness,
            weight: 1.0 / (error * error),
        };
        let stiffness = |own: Known| 1.0 / own.compliance;
        let both = known(2000.0, 0.01).with(known(200.0, CHORD_ERROR), 1.0);
        assert!((1880.0..2000.0).contains(&stiffness(both)), "{both:?}");
        let both = known(40_000.0, 1e6).with(known(200.0, CHORD_ERROR), 1.0);
        assert!((stiffness(both) / 200.0 - 1.0).abs() < 1e-6, "{both:?}");
        // A surface that moves under a hand that gives way: no compliance at all.
        let mut chord = Chord::default();
        for k in 0..1000 {
            let force = 5.0 + (3e-3 * f64::from(k)).sin();
            chord.add(1e-3, 0.01 - force / 300.0, force, CHORD_SPREAD, 0.0);
        }
        assert!(chord.best.is_none(), "{chord:?}");
    }
}

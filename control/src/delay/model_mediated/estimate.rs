//! The surface that the tip touches, as the follower's end estimates it: a plane
//! with stiffness and friction, in hand units.
//!
//! With the depth s = −n·x along the surface's normal n the contact's force is
//! F_N = K (s − s₀). Its compliance 1/K is the slope of depth over force, by least squares
//! (recursive identification of contact: Haddadi and Hashtrudi-Zaad 2012, "Real-time
//! identification of Hunt–Crossley dynamic models of contact environments", IEEE T-RO 28).
//! Noise of the force makes that slope too small, so a surface seems too stiff and never
//! too soft: the place of one that seems too soft, s − F_N/K, runs ahead of the tip that
//! goes after it. Two such slopes are combined by what each knows: one of what changes
//! unevenly, for stiff surfaces and ones that move by themselves, and one of all that happened in
//! the last second, for soft ones. A tip that rests tells nothing of K, but with K known where the surface is.

use nalgebra::Vector3;

/// Softest and stiffest surface that is distinguished [N/m].
pub(super) const SOFTEST: f64 = 10.0;
const STIFFEST: f64 = 40_000.0;
/// What changes evenly is what is slower than this [rad/s].
const EVEN: f64 = 25.0;
/// Time constant of the window [s].
const MEMORY: f64 = 0.3;
/// At the tip, forces that change by less than this tell nothing of compliance: some times
/// their noise [N].
const SPREAD: f64 = 0.3;
/// What of a depth is not the line's, at least [m], and the time over which the filters of
/// the force correlate it [s].
const NOISE: f64 = 5e-6;
const CORRELATION: f64 = 0.016;
/// A line is not all that a surface is: its stiffness is known no better [-],
const LEAST_ERROR: f64 = 0.01;
/// and at a new contact no better than this [-].
const ANEW: f64 = 0.2;
/// Memory of the chord [s],
const CHORD: f64 = 1.0;
/// after the first moments of a contact, in which the arm brakes [s].
const CHORD_WAIT: f64 = 0.1;
/// It takes so much of it [s]
const CHORD_LEAST: f64 = 0.2;
/// and, at the tip, a standard deviation of the force of so much [N] to tell something,
const CHORD_SPREAD: f64 = 0.1;
/// which is known no better than this [-].
const CHORD_ERROR: f64 = 0.07;
/// What the chord tells comes to count within this time [s].
const CHORD_GROWTH: f64 = 0.2;
/// What it told is forgotten with this time constant [s].
const CHORD_LIFE: f64 = 10.0;
/// A contact tells its normal in its first moments, before friction bends the
/// force aside [s].
const ONSET: f64 = 0.05;
/// A surface that is known keeps its normal until it was pushed so much from another
/// direction [N s]: what an arm that shakes feigns is shorter.
const OTHER: f64 = 0.1;
/// Cosine of the angle within which a force belongs to the surface that is
/// known: 40°, friction bends it aside by up to that.
pub(super) const SAME: f64 = 0.77;
/// Slower than this the tip does not slide [m/s].
const SLIDING: f64 = 5e-3;
/// A tip that is free this far behind the surface shows that it has gone [m].
const GONE: f64 = 1e-3;

/// A plane with stiffness and friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceModel {
    /// n: out of the surface, unit length.
    pub normal: Vector3<f64>,
    /// s₀: the surface is where −n·x = s₀ \[m\].
    pub place: f64,
    /// K \[N/m\]; zero: no surface is known.
    pub stiffness: f64,
    /// Coulomb coefficient \[-\].
    pub friction: f64,
}

/// A value, smoothed without lag while it changes evenly (as the tracker of the servo).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Even {
    /// The value.
    pub value: f64,
    /// Its rate [1/s].
    pub rate: f64,
}

impl Even {
    /// At rest.
    pub fn at(value: f64) -> Even {
        Even { value, rate: 0.0 }
    }

    /// After `dt` \[s\], with natural frequency `frequency` \[rad/s\]. Gives what of `value`
    /// is not even.
    pub fn step(&mut self, dt: f64, frequency: f64, value: f64) -> f64 {
        let error = value - self.value;
        self.rate += frequency * frequency * error * dt;
        self.value += (self.rate + 2.0 * frequency * error) * dt;
        error
    }
}

/// Compliance as the slope of depth over force, both less what of them changes evenly: a
/// surface that moves by itself changes them evenly over some hundredths of a second, a
/// tip that meets it or is pushed does not. Recursive least squares whose weights are what
/// these values tell, so that it forgets only for something that is known better.
#[derive(Clone, Copy, Debug)]
struct Slope {
    force: Option<Even>,
    depth: Even,
    /// [m/N]
    compliance: f64,
    /// One by the variance of the compliance [N²/m²].
    information: f64,
    /// Variance of the depth about the line [m²].
    scatter: f64,
}

impl Slope {
    const UNKNOWN: Slope = Slope {
        force: None,
        depth: Even {
            value: 0.0,
            rate: 0.0,
        },
        compliance: 1.0 / STIFFEST,
        information: 0.0,
        scatter: 0.0,
    };

    fn known(&self) -> Known {
        Known {
            compliance: self.compliance,
            weight: self.information * self.compliance * self.compliance,
        }
    }

    /// A new contact, maybe with something else than where `known` is from.
    fn anew(known: Known) -> Slope {
        let weight = known.weight.min(1.0 / (ANEW * ANEW));
        Slope {
            compliance: known.compliance,
            information: weight / (known.compliance * known.compliance),
            ..Slope::UNKNOWN
        }
    }

    /// After `dt` \[s\], at `depth` \[m\] under `force` \[N\] of which changes from `spread`
    /// \[N\] on count.
    fn add(&mut self, dt: f64, depth: f64, force: f64, spread: f64) {
        let Some(even) = &mut self.force else {
            (self.force, self.depth) = (Some(Even::at(force)), Even::at(depth));
            return;
        };
        let apart = even.step(dt, EVEN, force);
        let away = self.depth.step(dt, EVEN, depth);
        let left = away - self.compliance * apart;
        self.scatter += EVEN * dt * (left * left - self.scatter);
        if apart.abs() < spread {
            return;
        }
        let told = apart * apart / self.scatter.max(NOISE * NOISE) * dt / CORRELATION;
        self.information += told;
        let compliance = self.compliance + told / self.information * left / apart;
        self.compliance = compliance.clamp(1.0 / STIFFEST, 1.0 / SOFTEST);
        let best = (LEAST_ERROR * self.compliance).powi(-2);
        self.information = self.information.min(best);
    }
}

/// What is known of a compliance.
#[derive(Clone, Copy, Debug)]
struct Known {
    /// [m/N]
    compliance: f64,
    /// One by its relative variance [-].
    weight: f64,
}

impl Known {
    /// Of both, where `other` counts by `part` of 1: what is known well of a stiff surface holds,
    /// whatever a chord tells.
    fn with(self, other: Known, part: f64) -> Known {
        let weight = self.weight + part * other.weight;
        let share = part * other.weight / (self.weight + other.weight);
        let ratio = other.compliance / self.compliance;
        Known {
            compliance: self.compliance * ratio.powf(share),
            weight,
        }
    }
}

/// Compliance as the slope of depth over force in the last second of a contact: what a soft
/// surface shows to a tip that goes in evenly, of which a [`Slope`] learns nothing. A surface
/// that moves by itself misleads it.
#[derive(Clone, Copy, Debug, Default)]
struct Chord {
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
    best: Option<Known>,
    /// and how far that counts by now, 0 … 1: the tip goes after it.
    counts: f64,
}

impl Chord {
    /// After `dt` \[s\], at `depth` \[m\] under `force` \[N\] whose standard deviation has to be
    /// `spread` \[N\].
    fn add(&mut self, dt: f64, depth: f64, force: f64, spread: f64) {
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
        if self.time < CHORD_LEAST || self.spread < spread * spread || self.common <= 0.0 {
            return;
        }
        let slope = self.common / self.spread;
        let left = (self.scatter - self.common * slope).max(0.0) / self.spread;
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

/// Estimates a [`SurfaceModel`] from tip and contact force.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceEstimator {
    model: Option<SurfaceModel>,
    slope: Slope,
    chord: Chord,
    /// For how long [s].
    touching: f64,
    /// Impulse of the force in the first moments of the contact [N s].
    pushed: Vector3<f64>,
    /// The normal is being found.
    settling: bool,
    /// Where the contact began [m].
    began: Vector3<f64>,
    last: Option<Vector3<f64>>,
    scale: Scale,
}

/// Forces at the hand's scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Of the hand's by those at the tip [-].
    pub force: f64,
    /// Smaller ones are no contact [N].
    pub threshold: f64,
    /// Those of a surface stiffer than what the tip searches its way through are larger [N].
    pub searched: f64,
}

impl SurfaceEstimator {
    /// Knows no surface; a new one counts as a stiff one.
    pub fn new(scale: Scale) -> Self {
        SurfaceEstimator {
            model: None,
            slope: Slope::UNKNOWN,
            chord: Chord::default(),
            touching: 0.0,
            pushed: Vector3::zeros(),
            settling: false,
            began: Vector3::zeros(),
            last: None,
            scale,
        }
    }

    /// Of the compliance.
    fn known(&self) -> Known {
        let slope = self.slope.known();
        let chord = &self.chord;
        chord
            .best
            .map_or(slope, |told| slope.with(told, chord.counts))
    }

    /// After `dt` \[s\], the tip at `tip` \[m\] under the contact's `force` \[N\].
    pub fn step(
        &mut self,
        dt: f64,
        tip: Vector3<f64>,
        force: Vector3<f64>,
    ) -> Option<SurfaceModel> {
        let size = force.norm();
        let moved = self.last.map_or(Vector3::zeros(), |last| tip - last);
        self.last = Some(tip);
        if size < self.scale.threshold || dt <= 0.0 {
            self.touching = 0.0;
            if let Some(model) = &mut self.model {
                let depth = -model.normal.dot(&tip);
                model.place = model.place.max(depth - GONE);
            }
            return self.model;
        }
        let mut model = self.model.unwrap_or(SurfaceModel {
            stiffness: STIFFEST,
            ..SurfaceModel::default()
        });
        if self.touching == 0.0 {
            self.slope = Slope::anew(self.known());
            self.chord = Chord::default();
            self.pushed = Vector3::zeros();
            self.settling = self.model.is_none();
            self.began = tip;
        }
        if self.touching < ONSET {
            self.pushed += force * dt;
            let impulse = self.pushed.norm();
            let other = model.normal.dot(&self.pushed) < SAME * impulse;
            if other && impulse > OTHER && !self.settling {
                self.settling = true;
                self.slope = Slope::UNKNOWN;
                self.chord = Chord::default();
            }
            if self.settling {
                model.normal = self.pushed.try_normalize(1e-9).unwrap_or(force / size);
            }
        }
        self.touching += dt;
        let depth = -model.normal.dot(&tip);
        let normal_force = force.dot(&model.normal).max(0.0);
        // Depth from where the contact began: it changes little as the normal is found.
        let gone = model.normal.dot(&(self.began - tip));
        // What the arm feigns as it brakes is less than what it searches with.
        let spread = match normal_force > self.scale.searched {
            true => self.scale.force * SPREAD,
            false => f64::INFINITY,
        };
        self.slope.add(dt, gone, normal_force, spread);
        if self.touching > CHORD_WAIT {
            let spread = self.scale.force * CHORD_SPREAD;
            self.chord.add(dt, gone, normal_force, spread);
        }
        model.stiffness = 1.0 / self.known().compliance;
        model.place = depth - normal_force / model.stiffness;
        let slid = moved - model.normal * model.normal.dot(&moved);
        let way = slid.norm();
        if way > SLIDING * dt && normal_force > self.scale.threshold {
            let ratio = -force.dot(&slid) / way / normal_force;
            let share = dt / (dt + MEMORY);
            model.friction += share * (ratio.clamp(0.0, 2.0) - model.friction);
        }
        self.model = Some(model);
        self.model
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALE: Scale = Scale {
        force: 1.0,
        threshold: 0.1,
        searched: 2.4,
    };

    #[test]
    fn it_finds_place_stiffness_normal_and_friction() {
        // A plane through (0, 0.01, 0), its normal at 30°, 1500 N/m, μ = 0.2.
        let normal = Vector3::new(0.5, 0.75_f64.sqrt(), 0.0);
        let along = Vector3::new(normal.y, -normal.x, 0.0);
        let mut estimator = SurfaceEstimator::new(SCALE);
        let place = -normal.y * 0.01;
        let mut model = None;
        for k in 0..3000 {
            let time = f64::from(k) * 1e-3;
            let depth = 0.004 * (2.0 * time).sin().abs();
            let slide = 0.03 * (time - 0.5).max(0.0);
            let tip = -normal * (place + depth) + along * slide;
            let mut force = normal * 1500.0 * depth;
            if time > 0.5 {
                force -= along * 0.2 * 1500.0 * depth;
            }
            model = estimator.step(1e-3, tip, force);
        }
        let model = model.unwrap();
        assert!((model.normal - normal).norm() < 0.02, "{model:?}");
        assert!((model.stiffness / 1500.0 - 1.0).abs() < 0.1, "{model:?}");
        assert!((model.place - place).abs() < 5e-4, "{model:?}");
        assert!((model.friction - 0.2).abs() < 0.1, "{model:?}");
    }

    #[test]
    fn a_surface_that_gives_way_is_followed() {
        let mut estimator = SurfaceEstimator::new(SCALE);
        let at = |depth: f64| Vector3::new(depth, 0.0, 0.0);
        let force = |size: f64| Vector3::new(-size, 0.0, 0.0);
        for k in 0..1000 {
            let depth = 5e-6 * f64::from(k);
            estimator.step(1e-3, at(depth), force(1000.0 * depth));
        }
        let model = estimator.step(1e-3, at(0.005), force(5.0)).unwrap();
        assert!(model.place.abs() < 1e-4, "{model:?}");
        // Now the tip is free 2 cm behind.
        let model = estimator.step(1e-3, at(0.02), Vector3::zeros()).unwrap();
        assert!((model.place - 0.019).abs() < 1e-9, "{model:?}");
    }

    #[test]
    fn what_changes_evenly_is_followed_without_lag_and_what_does_not_is_left() {
        let mut even = Even::at(0.0);
        let rate = 0.02;
        let mut left = 1.0;
        for k in 1..=1000 {
            left = even.step(1e-3, EVEN, rate * 1e-3 * f64::from(k));
        }
        assert!(f64::abs(left) < 1e-3 * rate / EVEN, "{left}");
        assert!((even.rate / rate - 1.0).abs() < 1e-3, "{even:?}");
        let left = even.step(1e-3, EVEN, even.value + 0.01);
        assert!((left - 0.01).abs() < 1e-9, "{left}");
    }

    /// Onset of a contact: 0 to 10 N within some 50 ms.
    fn onset(slope: &mut Slope, stiffness: f64) {
        for k in 0..400 {
            let time = 1e-3 * f64::from(k);
            let force = 10.0 * (1.0 - (-time / 0.03).exp());
            slope.add(1e-3, force / stiffness, force, SPREAD);
        }
    }

    #[test]
    fn a_stiffness_is_known_after_an_onset() {
        for stiffness in [100.0, 2000.0, 20_000.0] {
            let mut slope = Slope::UNKNOWN;
            onset(&mut slope, stiffness);
            let known = 1.0 / slope.compliance / stiffness;
            assert!((0.95..1.05).contains(&known), "{stiffness} N/m: {known}");
        }
    }

    #[test]
    fn noise_of_the_force_makes_a_surface_stiffer_and_never_softer() {
        let stiffness = 2000.0;
        let mut slope = Slope::UNKNOWN;
        for k in 0..3000 {
            let time = 1e-3 * f64::from(k);
            let force = 5.0 + 0.5 * (40.0 * time).sin();
            // As large as a fifth of what it changes by, and not in the depth.
            let noise = 0.1 * (97.0 * time).sin();
            slope.add(1e-3, force / stiffness, force + noise, SPREAD);
        }
        let known = 1.0 / slope.compliance / stiffness;
        assert!((1.0..1.2).contains(&known), "{known}");
    }

    #[test]
    fn a_surface_that_moves_does_not_move_the_stiffness() {
        let stiffness = 2000.0;
        let mut slope = Slope::UNKNOWN;
        onset(&mut slope, stiffness);
        // The surface goes to and fro by 5 mm at 0.5 Hz; the tip, which is pressed as if by
        // a spring as stiff, goes half of the way, so that depth falls as the force rises.
        for k in 0..4000 {
            let turn = std::f64::consts::PI * 1e-3 * f64::from(k);
            let place = 0.0025 * (1.0 - turn.cos());
            let depth = 10.0 / stiffness - 0.5 * place;
            let force = 10.0 + 0.5 * stiffness * place;
            slope.add(1e-3, depth, force, SPREAD);
        }
        let known = 1.0 / slope.compliance / stiffness;
        assert!((0.95..1.05).contains(&known), "{known}");
    }

    /// The tip goes into a soft spring at 30 mm/s for half a second, then rests.
    #[test]
    fn a_soft_surface_is_known_from_a_tip_that_goes_in_evenly() {
        let mut estimator = SurfaceEstimator::new(SCALE);
        let mut model = None;
        for k in 0..2000 {
            let time = 1e-3 * f64::from(k);
            let depth = 0.01 + 0.03 * time.min(0.5);
            let noise = 0.08 * (400.0 * time).sin();
            let force = 100.0 * depth + noise;
            let (tip, force) = (Vector3::x() * depth, Vector3::x() * -force);
            model = estimator.step(1e-3, tip, force);
            if k == 0 {
                assert_eq!(model.map(|own| own.stiffness), Some(STIFFEST));
            }
        }
        let model = model.unwrap();
        // Noise of the force makes it stiffer.
        assert!((98.0..115.0).contains(&model.stiffness), "{model:?}");
    }

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
            chord.add(1e-3, 0.01 - force / 300.0, force, CHORD_SPREAD);
        }
        assert!(chord.best.is_none(), "{chord:?}");
    }

    #[test]
    fn a_known_surface_keeps_its_normal_until_it_is_pushed_from_elsewhere_for_long() {
        let mut estimator = SurfaceEstimator::new(SCALE);
        let tip = Vector3::zeros();
        let mut touch = |force: [f64; 3], steps: usize| {
            estimator.step(1e-3, tip, Vector3::zeros());
            let models = (0..steps).map(|_| estimator.step(1e-3, tip, force.into()));
            models.last().flatten().unwrap().normal
        };
        assert!((touch([-5.0, 0.0, 0.0], 100) + Vector3::x()).norm() < 1e-9);
        // 0.08 N s, as of an arm that shakes.
        assert!((touch([0.0, 8.0, 0.0], 10) + Vector3::x()).norm() < 1e-9);
        // 0.16 N s.
        assert!((touch([0.0, 8.0, 0.0], 20) - Vector3::y()).norm() < 1e-9);
    }
}

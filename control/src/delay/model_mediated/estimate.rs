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

use super::chord::{CHORD_SPREAD, CHORD_WAIT, Chord};
use super::compliance::{Known, SPREAD, STIFFEST, Slope};
use super::noise::Noise;
use nalgebra::Vector3;

/// Time constant of the window [s].
const MEMORY: f64 = 0.3;
/// A contact tells its normal in its first moments, before friction bends the
/// force aside [s];
const ONSET: f64 = 0.05;
/// a light one, whose force is mostly noise, takes longer to tell it, until it pushed the tip so
/// much [N s].
const TELLING: f64 = 0.3;
/// A surface that is known keeps its normal until the tip was pushed so much from another
/// direction without a break [N s]: what an arm that shakes feigns is shorter.
const OTHER: f64 = 0.1;
/// Cosine of the angle within which a force belongs to the surface that is
/// known: 40°, friction bends it aside by up to that.
const SAME: f64 = 0.77;
/// Changes of the force by so many standard deviations of its noise are none of it [-].
const CLEAR: f64 = 3.0;
/// Slower than this the tip does not slide [m/s].
const SLIDING: f64 = 5e-3;
/// A tip that is free this far behind the surface shows that it has gone [m].
const GONE: f64 = 1e-3;

/// A stiffness is known well with the first relative standard error, and not with the second [-].
pub(super) const SURE: f64 = 0.1;
const UNSURE: f64 = 0.3;

/// A plane with stiffness and friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceModel {
    /// n: out of the surface, unit length.
    pub normal: Vector3<f64>,
    /// s₀: the surface is where −n·x = s₀ \[m\].
    pub place: f64,
    /// K \[N/m\]; zero: no surface is known.
    pub stiffness: f64,
    /// Its relative standard error, 1 at most: nothing is known of it then \[-\].
    pub stiffness_error: f64,
    /// Coulomb coefficient \[-\].
    pub friction: f64,
}

impl SurfaceModel {
    /// How far `position` \[m\] is behind the surface \[m\]; negative before it.
    pub(super) fn depth(&self, position: &Vector3<f64>) -> f64 {
        -self.normal.dot(position) - self.place
    }

    /// Whether what pushes along `direction`, or has it as its normal, may be this surface.
    pub(super) fn pushes_along(&self, direction: &Vector3<f64>) -> bool {
        self.normal.dot(direction) >= SAME * direction.norm()
    }

    /// How little is known of the stiffness, from 0 to 1 \[-\].
    pub(super) fn doubt(&self) -> f64 {
        ((self.stiffness_error - SURE) / (UNSURE - SURE)).clamp(0.0, 1.0)
    }
}

/// Estimates a [`SurfaceModel`] from tip and contact force.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceEstimator {
    model: Option<SurfaceModel>,
    slope: Slope,
    chord: Chord,
    noise: Noise,
    /// For how long [s].
    touching: f64,
    /// Impulse of the force in the first moments of the contact [N s].
    pushed: Vector3<f64>,
    /// That of a force that is not of the surface that is known, since it last was [N s].
    strange: Vector3<f64>,
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
            noise: Noise::default(),
            touching: 0.0,
            pushed: Vector3::zeros(),
            strange: Vector3::zeros(),
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

    /// Whether `force` \[N\] has long enough been that of another surface than the `model` says,
    /// whenever in a contact that began.
    fn is_of_another(&mut self, dt: f64, model: &SurfaceModel, force: &Vector3<f64>) -> bool {
        self.strange = match model.pushes_along(force) {
            true => Vector3::zeros(),
            false => self.strange + force * dt,
        };
        self.strange.norm() > self.scale.force * OTHER
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
            stiffness_error: 1.0,
            ..SurfaceModel::default()
        });
        let telling = self.scale.force * TELLING;
        if self.touching == 0.0 {
            self.slope = Slope::anew(self.known());
            self.chord = Chord::default();
            // A force about its threshold comes and goes.
            if !self.settling {
                self.pushed = Vector3::zeros();
                self.settling = self.model.is_none();
            }
            self.strange = Vector3::zeros();
            self.began = tip;
        }
        if self.settling {
            self.pushed += force * dt;
        } else if self.is_of_another(dt, &model, &force) {
            self.pushed = std::mem::take(&mut self.strange);
            self.settling = true;
            self.slope = Slope::UNKNOWN;
            self.chord = Chord::default();
        }
        if self.settling {
            model.normal = self.pushed.try_normalize(1e-9).unwrap_or(force / size);
            self.settling = self.touching < ONSET || self.pushed.norm() < telling;
        }
        self.touching += dt;
        let depth = -model.normal.dot(&tip);
        let normal_force = force.dot(&model.normal).max(0.0);
        // Depth from where the contact began: it changes little as the normal is found.
        let gone = model.normal.dot(&(self.began - tip));
        // What the arm feigns as it brakes is less than what it searches with.
        let spread = match normal_force > self.scale.searched {
            true => (self.scale.force * SPREAD).max(CLEAR * self.noise.level()),
            false => f64::INFINITY,
        };
        let uneven = self.slope.add(dt, gone, normal_force, spread);
        self.noise.add(dt, uneven);
        if self.touching > CHORD_WAIT {
            let spread = self.scale.force * CHORD_SPREAD;
            self.chord
                .add(dt, gone, normal_force, spread, self.noise.level());
        }
        let known = self.known();
        model.stiffness = 1.0 / known.compliance;
        model.stiffness_error = known.error();
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
        // It knows how well it knows that.
        let errors = (model.stiffness / 1500.0 - 1.0) / model.stiffness_error;
        assert!(errors.abs() < 3.0, "{model:?}");
        assert!((0.005..0.1).contains(&model.stiffness_error), "{model:?}");
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
                let told = model.map(|own| (own.stiffness, own.stiffness_error));
                assert_eq!(told, Some((STIFFEST, 1.0)));
            }
        }
        let model = model.unwrap();
        // Noise of the force makes it stiffer.
        assert!((98.0..115.0).contains(&model.stiffness), "{model:?}");
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

    /// A second wall takes over without a break, and so gently that after 50 ms the tip has felt
    /// half of what tells another surface.
    #[test]
    fn a_wall_that_is_met_slowly_or_in_a_contact_is_another() {
        for force_scale in [1.0, 0.05] {
            let mut estimator = SurfaceEstimator::new(Scale {
                force: force_scale,
                threshold: 0.1 * force_scale,
                searched: 2.4 * force_scale,
            });
            let mut model = None;
            for k in 0..500 {
                let first = if k < 200 { 10.0 } else { 0.0 };
                let second = 0.04 * f64::from((k - 200_i32).max(0));
                let force = Vector3::new(-second, first, 0.0) * force_scale;
                model = estimator.step(1e-3, Vector3::zeros(), force);
                if k == 199 {
                    assert!((model.unwrap().normal - Vector3::y()).norm() < 1e-9);
                }
            }
            let normal = model.unwrap().normal;
            assert!((normal + Vector3::x()).norm() < 1e-9, "{normal}");
        }
    }
}

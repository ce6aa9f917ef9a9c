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
use super::surface::{SAME_TANGENT, SurfaceModel};
use crate::low_pass_share;
use nalgebra::Vector3;

/// Time constant of the window [s].
const MEMORY: f64 = 0.3;
/// A contact tells its normal in its first moments, before friction bends the
/// force aside [s];
const ONSET: f64 = 0.05;
/// a light one, whose force is mostly noise, takes longer to tell it, until it pushed the tip so
/// much [N s].
const TELLING: f64 = 0.3;
/// Changes of the force by so many standard deviations of its noise are none of it [-].
const CLEAR: f64 = 3.0;
/// Slower than this the tip does not slide [m/s].
const SLIDING: f64 = 5e-3;
/// Friction at rest by that of a tip that slides, at most [-];
const STICTION: f64 = 1.5;
/// what normal and force are wrong by, of the force along the normal [-], and at the tip [N].
const ASIDE: f64 = 0.25;
const LEAST_ASIDE: f64 = 1.0;
/// A tip that is free this far behind the surface shows that it has gone [m].
pub(super) const GONE: f64 = 1e-3;

/// Estimates a [`SurfaceModel`] from tip and contact force.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceEstimator {
    model: SurfaceModel,
    slope: Slope,
    chord: Chord,
    noise: Noise,
    /// For how long [s].
    touching: f64,
    /// Impulse of the force in its first moments [N s].
    pushed: Vector3<f64>,
    /// The normal is being found.
    settling: bool,
    /// For how long the tip slid [s].
    slid: f64,
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
    /// Of a surface that pushes along `normal` and `pushed` [N s] before; it counts as a stiff one.
    pub fn of(scale: Scale, normal: Vector3<f64>, pushed: Vector3<f64>) -> Self {
        SurfaceEstimator {
            model: SurfaceModel {
                normal,
                stiffness: STIFFEST,
                stiffness_error: 1.0,
                ..SurfaceModel::default()
            },
            slope: Slope::UNKNOWN,
            chord: Chord::default(),
            noise: Noise::default(),
            touching: 0.0,
            pushed,
            settling: true,
            slid: 0.0,
            began: Vector3::zeros(),
            last: None,
            scale,
        }
    }

    /// The surface as it is known.
    pub fn model(&self) -> &SurfaceModel {
        &self.model
    }

    /// Whether its normal is being found.
    pub fn settles(&self) -> bool {
        self.settling
    }

    /// How far aside of its normal it may push, by its friction, where it pushes with `normal` along
    /// that \[N\]. Where the tip slid on it for a while that is known.
    pub fn aside(&self, normal: f64) -> f64 {
        let known = STICTION * self.model.friction + ASIDE;
        match self.slid > MEMORY {
            true => (known * normal + self.scale.force * LEAST_ASIDE).min(SAME_TANGENT * normal),
            false => SAME_TANGENT * normal,
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

    /// After `dt` \[s\], the tip at `tip` \[m\] under the `force` \[N\] of this surface, with
    /// its friction; whether it touches.
    pub fn step(&mut self, dt: f64, tip: Vector3<f64>, force: Vector3<f64>) -> bool {
        let moved = self.last.map_or(Vector3::zeros(), |last| tip - last);
        self.last = Some(tip);
        let model = &mut self.model;
        if force.norm() < self.scale.threshold || dt <= 0.0 {
            self.touching = 0.0;
            let depth = -model.normal.dot(&tip);
            model.place = model.place.max(depth - GONE);
            return false;
        }
        if self.touching == 0.0 {
            self.slope = Slope::anew(self.known());
            self.chord = Chord::default();
            self.began = tip;
        }
        // A force about its threshold comes and goes: what it pushed counts on.
        if self.settling {
            self.pushed += force * dt;
            let normal = self.pushed.try_normalize(1e-9);
            let telling = self.scale.force * TELLING;
            self.model.normal = normal.unwrap_or(self.model.normal);
            self.settling = self.touching < ONSET || self.pushed.norm() < telling;
        }
        let mut model = self.model;
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
            let share = low_pass_share(dt, MEMORY);
            model.friction += share * (ratio.clamp(0.0, 2.0) - model.friction);
            self.slid += dt;
        }
        self.model = model;
        true
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

    /// Of a surface of which nothing is known.
    fn untold() -> SurfaceEstimator {
        SurfaceEstimator::of(SCALE, Vector3::zeros(), Vector3::zeros())
    }

    #[test]
    fn it_finds_place_stiffness_normal_and_friction() {
        // A plane through (0, 0.01, 0), its normal at 30°, 1500 N/m, μ = 0.2.
        let normal = Vector3::new(0.5, 0.75_f64.sqrt(), 0.0);
        let along = Vector3::new(normal.y, -normal.x, 0.0);
        let mut estimator = untold();
        let place = -normal.y * 0.01;
        for k in 0..3000 {
            let time = f64::from(k) * 1e-3;
            let depth = 0.004 * (2.0 * time).sin().abs();
            let slide = 0.03 * (time - 0.5).max(0.0);
            let tip = -normal * (place + depth) + along * slide;
            let mut force = normal * 1500.0 * depth;
            if time > 0.5 {
                force -= along * 0.2 * 1500.0 * depth;
            }
            estimator.step(1e-3, tip, force);
        }
        let model = *estimator.model();
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
        let mut estimator = untold();
        let at = |depth: f64| Vector3::new(depth, 0.0, 0.0);
        let force = |size: f64| Vector3::new(-size, 0.0, 0.0);
        for k in 0..1000 {
            let depth = 5e-6 * f64::from(k);
            estimator.step(1e-3, at(depth), force(1000.0 * depth));
        }
        assert!(estimator.step(1e-3, at(0.005), force(5.0)));
        let model = *estimator.model();
        assert!(model.place.abs() < 1e-4, "{model:?}");
        // Now the tip is free 2 cm behind.
        assert!(!estimator.step(1e-3, at(0.02), Vector3::zeros()));
        let model = *estimator.model();
        assert!((model.place - 0.019).abs() < 1e-9, "{model:?}");
    }

    /// The tip goes into a soft spring at 30 mm/s for half a second, then rests.
    #[test]
    fn a_soft_surface_is_known_from_a_tip_that_goes_in_evenly() {
        let mut estimator = untold();
        for k in 0..2000 {
            let time = 1e-3 * f64::from(k);
            let depth = 0.01 + 0.03 * time.min(0.5);
            let noise = 0.08 * (400.0 * time).sin();
            let force = 100.0 * depth + noise;
            let (tip, force) = (Vector3::x() * depth, Vector3::x() * -force);
            estimator.step(1e-3, tip, force);
            let model = estimator.model();
            if k == 0 {
                assert_eq!((model.stiffness, model.stiffness_error), (STIFFEST, 1.0));
            }
        }
        let model = *estimator.model();
        // Noise of the force makes it stiffer.
        assert!((98.0..115.0).contains(&model.stiffness), "{model:?}");
    }
}

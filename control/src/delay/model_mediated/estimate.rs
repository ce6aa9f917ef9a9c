//! The surface that the tip touches, as the follower's end estimates it: a plane
//! with stiffness and friction, in hand units.
//!
//! With the depth s = −n·x along the surface's normal n the contact's force is
//! F_N = K (s − s₀): a line, fitted over a window that forgets (least squares,
//! as Hunt and Crossley's exponent 1; recursive identification of contact:
//! Haddadi and Hashtrudi-Zaad 2012, "Real-time identification of Hunt–Crossley
//! dynamic models of contact environments", IEEE T-RO 28). A tip that rests
//! tells nothing of K, but with K known where the surface is.

use nalgebra::Vector3;

/// Softest and stiffest surface that is distinguished [N/m]: a packet holds no
/// larger number.
pub(super) const SOFTEST: f64 = 10.0;
const STIFFEST: f64 = 10_000.0;
/// Time constant of the window [s].
const MEMORY: f64 = 0.3;
/// Depths that spread by less than this tell nothing of stiffness [m].
const SPREAD: f64 = 5e-5;
/// Share of the force's variance that the depth has to explain: of a surface
/// that moves by itself it does not.
const LINE: f64 = 0.9;
/// A contact tells its normal in its first moments, before friction bends the
/// force aside [s].
const ONSET: f64 = 0.05;
/// Cosine of the angle within which a force belongs to the surface that is
/// known: 40°, friction bends it aside by up to that.
const SAME: f64 = 0.77;
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

/// Sums over the window.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    weight: f64,
    depth: f64,
    force: f64,
    depth_depth: f64,
    depth_force: f64,
    force_force: f64,
}

impl Window {
    fn add(&mut self, share: f64, depth: f64, force: f64) {
        let keep = 1.0 - share;
        // Means and central moments, both forgetting.
        self.weight = keep * self.weight + share;
        let rate = share / self.weight;
        let (away, apart) = (depth - self.depth, force - self.force);
        self.depth += rate * away;
        self.force += rate * apart;
        self.depth_depth = (1.0 - rate) * (self.depth_depth + rate * away * away);
        self.depth_force = (1.0 - rate) * (self.depth_force + rate * away * apart);
        self.force_force = (1.0 - rate) * (self.force_force + rate * apart * apart);
    }

    /// The line's slope, where there is a line.
    fn slope(&self) -> Option<f64> {
        let product = self.depth_depth * self.force_force;
        let line = self.depth_force > 0.0 && self.depth_force.powi(2) > LINE * product;
        (line && self.depth_depth > SPREAD * SPREAD).then(|| self.depth_force / self.depth_depth)
    }
}

/// Estimates a [`SurfaceModel`] from tip and contact force.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceEstimator {
    model: Option<SurfaceModel>,
    window: Window,
    /// For how long [s].
    touching: f64,
    /// The normal is being found.
    settling: bool,
    last: Option<Vector3<f64>>,
    threshold: f64,
    first: f64,
}

impl SurfaceEstimator {
    /// Knows no surface. Forces below `threshold` \[N\] are no contact; a
    /// new surface counts as one of stiffness `first` \[N/m\].
    pub fn new(threshold: f64, first: f64) -> Self {
        SurfaceEstimator {
            model: None,
            window: Window::default(),
            touching: 0.0,
            settling: false,
            last: None,
            threshold,
            first,
        }
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
        if size < self.threshold || dt <= 0.0 {
            self.touching = 0.0;
            self.window = Window::default();
            if let Some(model) = &mut self.model {
                let depth = -model.normal.dot(&tip);
                model.place = model.place.max(depth - GONE);
            }
            return self.model;
        }
        let mut model = self.model.unwrap_or(SurfaceModel {
            stiffness: self.first,
            ..SurfaceModel::default()
        });
        if self.touching == 0.0 {
            // A surface that is known keeps its normal: the tip may slide now.
            self.settling = model.normal.dot(&force) < SAME * size;
        }
        if self.settling && self.touching < ONSET {
            let share = dt / (self.touching + dt);
            let normal = model.normal * f64::from(self.touching > 0.0);
            let mean = normal + share * (force / size - normal);
            model.normal = mean.try_normalize(1e-6).unwrap_or(force / size);
        }
        self.touching += dt;
        let depth = -model.normal.dot(&tip);
        let normal_force = force.dot(&model.normal).max(0.0);
        self.window.add(dt / (dt + MEMORY), depth, normal_force);
        if let Some(slope) = self.window.slope() {
            model.stiffness = slope.clamp(SOFTEST, STIFFEST);
        }
        model.place = depth - normal_force / model.stiffness;
        let slid = moved - model.normal * model.normal.dot(&moved);
        let way = slid.norm();
        if way > SLIDING * dt && normal_force > self.threshold {
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

    #[test]
    fn it_finds_place_stiffness_normal_and_friction() {
        // A plane through (0, 0.01, 0), its normal at 30°, 1500 N/m, μ = 0.2.
        let normal = Vector3::new(0.5, 0.75_f64.sqrt(), 0.0);
        let along = Vector3::new(normal.y, -normal.x, 0.0);
        let mut estimator = SurfaceEstimator::new(0.1, 1000.0);
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
        let mut estimator = SurfaceEstimator::new(0.1, 1000.0);
        let at = |depth: f64| Vector3::new(depth, 0.0, 0.0);
        let force = |size: f64| Vector3::new(-size, 0.0, 0.0);
        for k in 0..500 {
            let depth = 1e-5 * f64::from(k);
            estimator.step(1e-3, at(depth), force(1000.0 * depth));
        }
        let model = estimator.step(1e-3, at(0.005), force(5.0)).unwrap();
        assert!(model.place.abs() < 1e-4, "{model:?}");
        // Now the tip is free 2 cm behind.
        let model = estimator.step(1e-3, at(0.02), Vector3::zeros()).unwrap();
        assert!((model.place - 0.019).abs() < 1e-9, "{model:?}");
    }
}

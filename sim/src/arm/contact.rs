//! True contact of the tip with one front of the contour.
//!
//! Along the normal a spring and a damper that never pull. Along the tangent
//! a bristle: it bends elastically while the tip sticks, and slips when
//! Coulomb's limit is reached, so a tip can rest on the surface under load.

use super::wear::SurfaceWear;
use ferntast_model::contour::Feature;
use ferntast_model::{Vector2, parameters};

parameters! {
    /// True properties of one kind of surface.
    #[derive(Copy)]
    pub struct TrueSurface {
        /// Stiffness along the normal \[N/m\].
        pub stiffness: f64 [1.0..=1e6, "N/m"],
        /// Damping along the normal \[N·s/m\].
        pub damping: f64 [0.0..=1e3, "N·s/m"],
        /// Coulomb coefficient \[-\]; where the surface wears, that of day 0.
        pub friction: f64 [0.0..=3.0, "-"],
        /// Stiffness of the bristle \[N/m\].
        pub tangential_stiffness: f64 [1.0..=1e6, "N/m"],
        /// Damping of the bristle \[N·s/m\].
        pub tangential_damping: f64 [0.0..=1e3, "N·s/m"],
        /// What the days do to it; nothing when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub wear: Option<SurfaceWear> [section],
    }
}

impl TrueSurface {
    /// The surface as it is on `day` of the mission.
    pub(super) fn on_day(&self, day: f64) -> TrueSurface {
        let friction = (self.wear).map_or(self.friction, |wear| wear.friction(self.friction, day));
        TrueSurface { friction, ..*self }
    }
}

/// One front of the contour with what the tip does to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Front {
    feature: Feature,
    tangent: Vector2<f64>,
    surface: TrueSurface,
    /// The tip came in from the free side and has not left since.
    touched: bool,
    /// Φ at the last step \[m\].
    distance: f64,
    /// How far the bristle is bent along the tangent \[m\].
    bend: f64,
    /// F_N at the last step \[N\].
    normal_force: f64,
    /// Force on the tip along the tangent at the last step \[N\].
    tangential_force: f64,
}

impl Front {
    /// A front that is not touched, the tip at `tip`.
    pub(super) fn new(feature: Feature, surface: TrueSurface, tip: &Vector2<f64>) -> Self {
        Self {
            feature,
            tangent: feature.tangent(),
            surface,
            touched: false,
            distance: feature.distance(tip),
            bend: 0.0,
            normal_force: 0.0,
            tangential_force: 0.0,
        }
    }

    pub(super) fn feature(&self) -> &Feature {
        &self.feature
    }

    pub(super) fn normal_force(&self) -> f64 {
        self.normal_force
    }

    pub(super) fn tangential_force(&self) -> f64 {
        self.tangential_force
    }

    /// Elastic energy in surface and bristle \[J\], the tip at `tip`.
    pub(super) fn energy(&self, tip: &Vector2<f64>) -> f64 {
        if !self.touched {
            return 0.0;
        }
        let depth = (-self.feature.distance(tip)).max(0.0);
        0.5 * (self.surface.stiffness * depth * depth
            + self.surface.tangential_stiffness * self.bend * self.bend)
    }

    /// Force on the tip \[N\], base frame, after `dt` \[s\] with `tip` \[m\] and
    /// `velocity` \[m/s\].
    pub(super) fn step(
        &mut self,
        tip: &Vector2<f64>,
        velocity: &Vector2<f64>,
        dt: f64,
    ) -> Vector2<f64> {
        let distance = self.feature.distance(tip);
        let came_from_outside = self.distance > 0.0;
        self.distance = distance;
        if distance > 0.0 || !self.feature.faces(tip) {
            self.release();
            return Vector2::zeros();
        }
        // A tip that came round the end is behind the sheet and feels nothing.
        self.touched |= came_from_outside;
        if !self.touched {
            return Vector2::zeros();
        }
        let surface = &self.surface;
        let rate = -velocity.dot(&self.feature.normal);
        let normal = (surface.damping * rate - surface.stiffness * distance).max(0.0);
        let limit = surface.friction * normal;
        let slide = velocity.dot(&self.tangent);
        let longest = limit / surface.tangential_stiffness;
        self.bend = (self.bend + slide * dt).clamp(-longest, longest);
        let bristle = surface.tangential_stiffness * self.bend + surface.tangential_damping * slide;
        let tangential = -bristle.clamp(-limit, limit);
        self.normal_force = normal;
        self.tangential_force = tangential;
        self.feature.normal * normal + self.tangent * tangential
    }

    fn release(&mut self) {
        self.touched = false;
        self.bend = 0.0;
        self.normal_force = 0.0;
        self.tangential_force = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_model::contact::ContactParameters;
    use ferntast_model::contour::{EdgeParameters, Surface};

    const SURFACE: TrueSurface = TrueSurface {
        stiffness: 4e4,
        damping: 100.0,
        friction: 0.4,
        tangential_stiffness: 3e4,
        tangential_damping: 50.0,
        wear: None,
    };

    fn floor() -> Front {
        let edge = EdgeParameters {
            surface: Surface::Unlubricated,
            from: [-1.0, 0.0],
            to: [1.0, 0.0],
            contact: ContactParameters {
                stiffness: 1.0,
                damping: 0.0,
                friction: 0.0,
            },
        };
        Front::new(edge.feature(), SURFACE, &Vector2::new(0.0, 0.1))
    }

    /// Fig. 17: the lubricant wears off.
    #[test]
    fn a_lubricated_surface_comes_near_the_bare_one() {
        let wear = Some(SurfaceWear {
            worn_friction: 0.45,
            days: 300.0,
        });
        let surface = TrueSurface { wear, ..SURFACE };
        let on_day = |day| surface.on_day(day).friction;
        assert_eq!((on_day(-100.0), on_day(0.0)), (0.4, 0.4));
        assert!((on_day(300.0) - (0.45 - 0.05 * (-1.0_f64).exp())).abs() < 1e-12);
        assert!(on_day(3000.0) < 0.45 && on_day(3000.0) > 0.449);
    }

    #[test]
    fn a_sliding_tip_feels_coulomb_friction() {
        let mut floor = floor();
        let mut force = Vector2::zeros();
        for _ in 0..1000 {
            force = floor.step(&Vector2::new(0.0, -1e-3), &Vector2::new(0.1, 0.0), 1e-4);
        }
        assert!((force - Vector2::new(-16.0, 40.0)).norm() < 1e-9, "{force}");
    }

    #[test]
    fn a_resting_tip_bears_a_load_up_to_the_limit() {
        let mut floor = floor();
        // Pressed in, then pushed 0.2 mm sideways: the bristle holds 6 N of the 16 N there may be.
        floor.step(&Vector2::new(0.0, -1e-3), &Vector2::zeros(), 1e-4);
        for _ in 0..20 {
            floor.step(&Vector2::new(0.0, -1e-3), &Vector2::new(0.1, 0.0), 1e-4);
        }
        let force = floor.step(&Vector2::new(0.0, -1e-3), &Vector2::zeros(), 1e-4);
        assert!((force - Vector2::new(-6.0, 40.0)).norm() < 1e-9, "{force}");
    }

    #[test]
    fn a_surface_does_not_pull() {
        let mut floor = floor();
        let force = floor.step(&Vector2::new(0.0, -1e-4), &Vector2::new(0.3, 1.0), 1e-4);
        assert_eq!(force.y, 0.0);
        assert_eq!(force.x, 0.0);
    }

    #[test]
    fn behind_the_end_of_an_edge_there_is_nothing() {
        let mut floor = floor();
        floor.step(&Vector2::new(1.1, -0.01), &Vector2::zeros(), 1e-4);
        let force = floor.step(&Vector2::new(0.9, -0.01), &Vector2::zeros(), 1e-4);
        assert_eq!(force, Vector2::zeros());
    }
}

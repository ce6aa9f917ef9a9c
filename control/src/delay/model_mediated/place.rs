//! Where the surface is, as the arm's end follows it.

use super::SurfaceModel;
use super::even::Even;
use nalgebra::Vector3;

/// Where the surface is, followed without lag while it moves evenly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Along which it is counted.
    normal: Vector3<f64>,
    /// [m, m/s]
    pub even: Even,
    /// Of the surface when it was there [N/m].
    stiffness: f64,
    pub touches: bool,
}

impl Place {
    pub fn of(model: &SurfaceModel) -> Place {
        Place {
            normal: model.normal,
            even: Even::at(model.place),
            stiffness: model.stiffness,
            touches: false,
        }
    }

    /// After `dt` \[s\] with the tip at `tip` \[m\], where the surface as it is estimated now is
    /// `model`; followed with natural frequency `frequency` \[rad/s\].
    pub fn step(
        self,
        dt: f64,
        frequency: f64,
        model: &SurfaceModel,
        tip: &Vector3<f64>,
        touches: bool,
    ) -> Place {
        let depth = -model.normal.dot(tip);
        if !model.pushes_along(&self.normal) {
            let anew = Place::of(model);
            return Place { touches, ..anew };
        }
        // A normal that turns, turns about the tip.
        let mut place = self.even.value + depth + self.normal.dot(tip);
        if touches {
            // So does a stiffness that is learned: the force there is as it was.
            place -= (depth - model.place) * (1.0 - model.stiffness / self.stiffness);
        }
        let mut own = Place {
            normal: model.normal,
            even: Even {
                value: place,
                ..self.even
            },
            stiffness: model.stiffness,
            touches,
        };
        if !touches {
            // What the tip has gone through is not there.
            own.even = Even::at(place.max(depth));
        } else if !self.touches {
            own.even.value = model.place;
        } else {
            own.even.step(dt, frequency, model.place);
        }
        own
    }

    /// How deep the tip may go for a force of `allowed` \[N\] on a surface of `stiffness`
    /// \[N/m\] \[m\].
    pub fn deepest(&self, allowed: f64, stiffness: f64) -> f64 {
        self.even.value + allowed / stiffness
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::WALL;
    use super::*;

    #[test]
    fn a_surface_that_moves_evenly_is_followed_without_lag() {
        let (speed, frequency) = (0.02, 12.0);
        let mut place = Place::of(&WALL);
        let mut model = WALL;
        for k in 0..1000 {
            model.place = speed * 1e-3 * f64::from(k);
            let tip = Vector3::new(model.place + 1e-3, 0.0, 0.0);
            place = place.step(1e-3, frequency, &model, &tip, true);
        }
        // Ahead by a step; a lag of first order would leave speed / frequency, 1.7 mm.
        let left = place.even.value - (model.place + speed * 1e-3);
        assert!(left.abs() < 1e-3 * speed / frequency, "{left}");
        assert!((place.even.rate / speed - 1.0).abs() < 0.01, "{place:?}");
    }

    #[test]
    fn a_surface_that_was_lost_is_not_where_the_tip_went() {
        let place = Place::of(&WALL);
        let tip = Vector3::new(0.004, 0.0, 0.0);
        let lost = place.step(1e-3, 12.0, &WALL, &tip, false);
        assert!((lost.deepest(0.0, WALL.stiffness) - tip.x).abs() < 1e-12);
        let before = Vector3::new(-0.004, 0.0, 0.0);
        let own = place.step(1e-3, 12.0, &WALL, &before, false);
        assert!((own.deepest(2.0, WALL.stiffness) - 2.0 / WALL.stiffness).abs() < 1e-12);
        // Found again, it begins where the surface is.
        let found = SurfaceModel {
            place: 0.0045,
            ..WALL
        };
        let own = lost.step(1e-3, 12.0, &found, &Vector3::new(0.005, 0.0, 0.0), true);
        assert!((own.even.value - 0.0045).abs() < 1e-12, "{own:?}");
    }

    #[test]
    fn a_stiffness_that_is_learned_leaves_the_force_at_the_tip() {
        let tip = Vector3::new(0.01, 0.0, 0.0);
        let at = |stiffness: f64| SurfaceModel {
            // 2 N.
            place: tip.x - 2.0 / stiffness,
            stiffness,
            ..WALL
        };
        let place = Place::of(&at(40_000.0)).step(1e-3, 12.0, &at(40_000.0), &tip, true);
        let own = place.step(1e-3, 12.0, &at(200.0), &tip, true);
        assert!(own.even.value.abs() < 1e-9, "{own:?}");
    }

    #[test]
    fn another_surface_is_where_it_is() {
        let tip = Vector3::new(0.01, 0.03, 0.0);
        let place = Place::of(&WALL).step(1e-3, 12.0, &WALL, &tip, true);
        let other = SurfaceModel {
            normal: Vector3::new(0.0, -1.0, 0.0),
            place: 0.029,
            ..WALL
        };
        let own = place.step(1e-3, 12.0, &other, &tip, true);
        assert_eq!((own.even.value, own.touches), (0.029, true));
    }

    #[test]
    fn a_normal_that_turns_turns_about_the_tip() {
        let tip = Vector3::new(0.01, 0.03, 0.0);
        let place = Place::of(&WALL).step(1e-3, 12.0, &WALL, &tip, true);
        let turned = SurfaceModel {
            normal: Vector3::new(-0.8, -0.6, 0.0),
            // As deep behind it as before.
            place: 0.8 * tip.x + 0.6 * tip.y - 0.01,
            ..WALL
        };
        let own = place.step(1e-3, 12.0, &turned, &tip, true);
        assert!((own.even.value - turned.place).abs() < 1e-12, "{own:?}");
    }
}

//! One surface as the leader's end renders it.

use super::account::UpdateAccount;
use super::surface::SurfaceModel;
use super::told::Told;
use super::{ModelMediated, PLACE_SPEED};
use crate::delay::mapping::ForceRamp;
use crate::low_pass_share;
use nalgebra::Vector3;

/// v_0: below this speed friction is viscous [m/s].
const FRICTION_SPEED: f64 = 0.01;
/// One that emerges waits while the hand does not get so much of its force: this share of it [-],
const LACK: f64 = 0.1;
/// and more than this [N].
const LEAST_LACK: f64 = 0.2;
/// Within this the contact's own force takes the place of the rendered one, and back [s].
const CHANGE_OVER: f64 = 0.3;

/// A surface, from step to step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rendered {
    /// What is rendered; nothing before the first step.
    surface: Option<SurfaceModel>,
    /// It appeared behind the hand and is not yet where it was told to be.
    emerges: bool,
    /// What was told of it last, and for how long other surfaces have been told since [s].
    told: Told,
    pub untold: f64,
    /// The contact's own force as it was told last \[N\], and its share in what is felt.
    contact: f64,
    felt: ForceRamp,
}

impl Rendered {
    /// Of what is told for the first time; `alone` where there was nothing before, so that no force is
    /// led over to the contact's own.
    pub fn of(told: Told, alone: bool) -> Rendered {
        Rendered {
            surface: None,
            emerges: false,
            told,
            untold: 0.0,
            contact: told.force.unwrap_or_default(),
            felt: ForceRamp::at(if alone && told.force.is_some() {
                1.0
            } else {
                0.0
            }),
        }
    }

    /// It is told anew.
    pub fn tell(&mut self, told: Told) {
        self.told = told;
        self.untold = 0.0;
        self.contact = told.force.unwrap_or(self.contact);
    }

    /// What is rendered now.
    pub fn surface(&self) -> Option<&SurfaceModel> {
        self.surface.as_ref()
    }

    /// Whether `told` is of this surface.
    pub fn is(&self, told: &Told) -> bool {
        self.told.surface.pushes_along(&told.surface.normal)
    }

    /// Blends what was told in, `dt` \[s\] later, with the hand at `hand` \[m\]. A surface that comes
    /// towards the hand winds its spring up, so it comes slowly, and begins at the hand where it appears
    /// behind it, and waits there while the hand is `lacking` a force \[N\] that nobody paid for: what
    /// goes on pushing then takes from the other surfaces. One that gives way does so at once.
    pub fn blend(
        &mut self,
        dt: f64,
        law: &ModelMediated,
        account: &mut UpdateAccount,
        hand: &Vector3<f64>,
        lacking: &Vector3<f64>,
    ) {
        let target = self.told.surface;
        let share = low_pass_share(dt, law.blend_time);
        let stiffness = target.stiffness.min(law.largest_stiffness);
        let anew = SurfaceModel {
            place: target.place.max(-target.normal.dot(hand)),
            stiffness,
            ..target
        };
        let before = self.surface.unwrap_or(anew);
        // Another surface has its place along another normal.
        let known = (self.surface).filter(|own| own.pushes_along(&target.normal));
        self.emerges |= known.is_none();
        let mut surface = known.unwrap_or(anew);
        let normal = surface.normal + share * (target.normal - surface.normal);
        surface.normal = normal.try_normalize(1e-6).unwrap_or(target.normal);
        let pressed = pressed(&surface, hand);
        let waits = lacking.dot(&surface.normal) > LEAST_LACK.max(LACK * pressed);
        let speed = match self.emerges {
            true if waits => 0.0,
            true => law.emerge_speed,
            false => PLACE_SPEED,
        };
        surface.place += (target.place - surface.place).max(-speed * dt);
        surface.stiffness += share * (stiffness - surface.stiffness);
        surface.friction += share * (target.friction - surface.friction);
        if law.paid_updates {
            surface = account.paid(&before, &surface, hand);
        }
        self.emerges &= surface.place > target.place;
        self.surface = Some(surface);
    }

    /// Forces on a hand at `position` \[m\] with `velocity` \[m/s\], `dt` \[s\] later: of the model,
    /// and what is felt of the surface \[N\].
    pub fn forces(
        &mut self,
        dt: f64,
        position: &Vector3<f64>,
        velocity: &Vector3<f64>,
    ) -> [Vector3<f64>; 2] {
        let own = self.felt.step(dt, CHANGE_OVER, self.told.force.is_some());
        self.surface.map_or(Default::default(), |surface| {
            let model = pressed(&surface, position);
            [model, model + own * (self.contact - model)]
                .map(|force| rendered(&surface, force, velocity))
        })
    }
}

/// Force with which `surface` is pressed by a hand at `position` \[m\] \[N\].
fn pressed(surface: &SurfaceModel, position: &Vector3<f64>) -> f64 {
    surface.stiffness * surface.depth(position).max(0.0)
}

/// Force of `surface`, which is `pressed` \[N\], on a hand with `velocity` \[m/s\].
fn rendered(surface: &SurfaceModel, pressed: f64, velocity: &Vector3<f64>) -> Vector3<f64> {
    if pressed <= 0.0 {
        return Vector3::zeros();
    }
    let slide = velocity - surface.normal * surface.normal.dot(velocity);
    let grip = surface.friction * pressed / slide.norm().max(FRICTION_SPEED);
    surface.normal * pressed - slide * grip
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rendered_surface_pushes_out_and_brakes() {
        let surface = SurfaceModel {
            normal: Vector3::new(-1.0, 0.0, 0.0),
            place: 0.01,
            stiffness: 500.0,
            stiffness_error: 0.0,
            friction: 0.3,
        };
        let at = |x| pressed(&surface, &Vector3::new(x, 0.0, 0.0));
        let force = rendered(&surface, at(0.012), &Vector3::new(0.0, 0.05, 0.0));
        assert!(
            (force - Vector3::new(-1.0, -0.3, 0.0)).norm() < 1e-12,
            "{force}"
        );
        let free = rendered(&surface, at(0.009), &Vector3::zeros());
        assert_eq!(free, Vector3::zeros());
    }
}

//! Damping of the hand: as much as there is to touch.

use super::SurfaceModel;
use crate::low_pass_share;
use nalgebra::Vector3;

/// From so far before the surface on the damping of contact begins [m].
const BEFORE: f64 = 0.02;
/// Time constant with which it changes, so that a surface that appears under the hand makes no
/// step of force [s].
const CHANGE: f64 = 0.05;
/// What is as stiff as this is damped in full [N/m].
const STIFF: f64 = 1000.0;

/// b: damping of the hand, from step to step.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandDamping {
    free: f64,
    contact: f64,
    /// How much there is to touch [-].
    nearness: f64,
}

impl HandDamping {
    /// `free` and in `contact` with what is stiff \[N·s/m\]; nothing is near.
    pub fn new(free: f64, contact: f64) -> HandDamping {
        HandDamping {
            free,
            contact,
            nearness: 0.0,
        }
    }

    /// How much there is to touch, from 0 to 1 \[-\].
    pub fn nearness(&self) -> f64 {
        self.nearness
    }

    /// b \[N·s/m\].
    pub fn value(&self) -> f64 {
        self.free + self.nearness * (self.contact - self.free)
    }

    /// After `dt` \[s\] with the hand at `hand` \[m\], where `surfaces` are known. What damps a hand
    /// on a spring by the same share goes with the root of its stiffness.
    pub fn step<'a>(
        &mut self,
        dt: f64,
        surfaces: impl IntoIterator<Item = &'a SurfaceModel>,
        hand: &Vector3<f64>,
    ) {
        let needed = surfaces.into_iter().map(|own| {
            let near = (1.0 + own.depth(hand) / BEFORE).clamp(0.0, 1.0);
            let stiffness = (own.stiffness / STIFF).clamp(0.0, 1.0);
            near * stiffness.sqrt()
        });
        let needed = needed.fold(0.0, f64::max);
        self.nearness += low_pass_share(dt, CHANGE) * (needed - self.nearness);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(stiffness: f64) -> SurfaceModel {
        SurfaceModel {
            normal: -Vector3::x(),
            stiffness,
            ..SurfaceModel::default()
        }
    }

    /// After a second at `x` \[m\], where the surface begins at zero.
    fn damping(x: f64, surface: Option<&SurfaceModel>) -> f64 {
        let mut own = HandDamping::new(1.0, 11.0);
        let hand = Vector3::new(x, 0.0, 0.0);
        (0..1000).for_each(|_| own.step(1e-3, surface, &hand));
        own.value()
    }

    #[test]
    fn a_hand_is_damped_by_what_there_is_to_touch() {
        let stiff = surface(2000.0);
        assert_eq!(damping(0.0, None), 1.0);
        assert_eq!(damping(-0.03, Some(&stiff)), 1.0);
        assert!((damping(-0.01, Some(&stiff)) - 6.0).abs() < 1e-6);
        assert!((damping(0.005, Some(&stiff)) - 11.0).abs() < 1e-6);
        // A hundredth as stiff: a tenth as much.
        let soft = damping(0.0, Some(&surface(10.0)));
        assert!((soft - 2.0).abs() < 1e-6, "{soft}");
    }

    #[test]
    fn a_surface_that_appears_under_the_hand_makes_no_step() {
        let mut own = HandDamping::new(1.0, 11.0);
        let (hand, stiff) = (Vector3::zeros(), surface(2000.0));
        own.step(1e-3, None, &hand);
        own.step(1e-3, Some(&stiff), &hand);
        let first = own.value();
        // 10 N·s/m over 50 ms.
        assert!((first - 1.2).abs() < 0.01, "{first}");
    }
}

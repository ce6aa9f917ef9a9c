//! How far beyond the hand the tip goes after a surface that gives way.
//!
//! A hand that presses on a surface that moves is where that was a way back ago, and its word takes a
//! way forth. Until then the surface has moved by some v τ, with v its speed and τ the round
//! trip: so far the tip may be ahead of the hand's word, and no more.

use nalgebra::Vector3;

/// The other end has been heard for so long before: after a hold hand and tip are elsewhere \[s\].
const HEARD: f64 = 1.0;
/// How fast the surface moved is forgotten with this time constant \[s\].
const MEMORY: f64 = 1.0;
/// Time constant of the tip's speed along the surface \[s\].
const SLIDE_TIME: f64 = 0.1;

/// Remembers how fast the surface moved.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Chase {
    /// For how long the other end has been heard [s].
    heard: f64,
    /// Of the surface, lately [m/s].
    speed: f64,
    /// Velocity of the tip along the surface [m/s].
    slide: Vector3<f64>,
    /// Where the tip was [m].
    last: Option<Vector3<f64>>,
}

impl Chase {
    /// How far \[m\], `furthest` \[m\] at most, `dt` \[s\] later, with the tip at `tip` \[m\];
    /// `touched` are normal and speed \[m/s\] of the surface there, `round_trip` \[s\] while the
    /// other end is heard.
    pub fn step(
        &mut self,
        dt: f64,
        furthest: f64,
        tip: Option<Vector3<f64>>,
        touched: Option<(Vector3<f64>, f64)>,
        round_trip: Option<f64>,
    ) -> f64 {
        let moved = tip.zip(self.last).map(|(tip, last)| tip - last);
        self.last = tip;
        let Some(round_trip) = round_trip else {
            self.heard = 0.0;
            self.speed = 0.0;
            return 0.0;
        };
        self.heard += dt;
        self.speed -= self.speed * dt / (dt + MEMORY);
        if let Some((moved, (normal, rate))) = moved.zip(touched) {
            let along = moved - normal * normal.dot(&moved);
            self.slide += (along - self.slide * dt) / (dt + SLIDE_TIME);
            // Friction turns the normal aside, so that a surface seems to move where a tip slides.
            let own = rate.abs() - self.slide.norm();
            if self.heard > HEARD {
                self.speed = self.speed.max(own);
            }
        }
        (self.speed * round_trip).min(furthest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FURTHEST: f64 = 0.01;

    /// The tip on a surface across x that moves at `rate` \[m/s\], after `time` \[s\], sliding along it
    /// with `slide` \[m/s\].
    fn after(time: f64, rate: f64, slide: f64) -> f64 {
        let mut chase = Chase::default();
        let steps = (1e3 * time) as i32;
        let far = (0..steps).map(|k| {
            let tip = Vector3::y() * slide * 1e-3 * f64::from(k);
            let touched = Some((-Vector3::x(), rate));
            chase.step(1e-3, FURTHEST, Some(tip), touched, Some(0.5))
        });
        far.last().unwrap()
    }

    #[test]
    fn it_goes_as_far_as_the_surface_went_in_a_round_trip() {
        assert_eq!(after(0.9, -0.01, 0.0), 0.0);
        assert!((after(3.0, -0.01, 0.0) - 0.005).abs() < 1e-9);
        assert_eq!(after(3.0, 0.1, 0.0), FURTHEST);
        // A wall at rest, whose normal friction turns by 16°.
        assert!(after(3.0, 0.28 * 0.03, 0.03) < 1e-6);
    }

    #[test]
    fn what_was_before_a_hold_does_not_count() {
        let mut chase = Chase::default();
        let mut step = |heard: bool| {
            let touched = Some((-Vector3::x(), -0.01));
            let tip = Some(Vector3::zeros());
            chase.step(1e-3, FURTHEST, tip, touched, heard.then_some(0.5))
        };
        let before = (0..2000).map(|_| step(true)).last().unwrap();
        assert!((before - 0.005).abs() < 1e-9);
        assert_eq!(step(false), 0.0);
        assert_eq!(step(true), 0.0);
    }
}

//! What an update of the rendered surface may put into the hand.

use super::SurfaceModel;
use nalgebra::Vector3;

/// An energy account for updates: a surface that moves towards the hand, or gets stiffer, winds
/// its spring up at nobody's cost. What is in here pays for that: what the damping at the hand
/// took, what updates let go of, and what the arm's end says came in from its surface, which may move.
#[derive(Clone, Copy, Debug)]
pub(super) struct UpdateAccount {
    /// [J]
    level: f64,
    /// It holds so much at most [J].
    reserve: f64,
    /// What had come in at the other end at the last packet [J].
    entered: Option<f64>,
}

impl UpdateAccount {
    pub fn new(reserve: f64) -> UpdateAccount {
        UpdateAccount {
            level: 0.0,
            reserve,
            entered: None,
        }
    }

    /// Puts in what was taken from the hand \[J\].
    pub fn add(&mut self, energy: f64) {
        self.level = (self.level + energy.max(0.0)).min(self.reserve);
    }

    /// Puts in what came in at the other end since the last packet, where it is `entered` \[J\]
    /// since that end's start.
    pub fn came_in(&mut self, entered: f64) {
        // Less than before: the other end started over.
        let before = self.entered.replace(entered).unwrap_or(entered);
        self.add(entered - before);
    }

    /// Of an update from `old` to `new` with the hand at `hand` \[m\] as much as can be paid.
    pub fn paid(
        &mut self,
        old: &SurfaceModel,
        new: &SurfaceModel,
        hand: &Vector3<f64>,
    ) -> SurfaceModel {
        let before = stored(old, hand);
        let gain = |own: &SurfaceModel| stored(own, hand) - before;
        let mut update = *new;
        if gain(new) > self.level {
            // What is stored grows with the share of the update, if not evenly.
            let (mut least, mut most) = (0.0, 1.0);
            for _ in 0..12 {
                let middle = 0.5 * (least + most);
                match gain(&between(old, new, middle)) > self.level {
                    true => most = middle,
                    false => least = middle,
                }
            }
            update = between(old, new, least);
        }
        let spent = gain(&update);
        self.level = (self.level - spent).clamp(0.0, self.reserve);
        update
    }
}

/// Energy in the spring of `surface` with the hand at `hand` \[m\] \[J\].
fn stored(surface: &SurfaceModel, hand: &Vector3<f64>) -> f64 {
    let depth = surface.depth(hand).max(0.0);
    0.5 * surface.stiffness * depth * depth
}

/// From `old` by `share` on to `new`.
fn between(old: &SurfaceModel, new: &SurfaceModel, share: f64) -> SurfaceModel {
    let on = |old: f64, new: f64| old + share * (new - old);
    let normal = old.normal + share * (new.normal - old.normal);
    SurfaceModel {
        normal: normal.try_normalize(1e-6).unwrap_or(old.normal),
        place: on(old.place, new.place),
        stiffness: on(old.stiffness, new.stiffness),
        stiffness_error: new.stiffness_error,
        friction: on(old.friction, new.friction),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::WALL;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever is told, what updates put into the spring is never more than what was put in.
        #[test]
        fn updates_put_in_no_more_than_was_paid(
            updates in proptest::collection::vec((-0.01..0.01f64, 10.0..3000.0f64, 0.0..1e-3f64), 1..100),
        ) {
            let hand = Vector3::new(0.002, 0.0, 0.0);
            let mut account = UpdateAccount::new(0.05);
            let mut surface = WALL;
            let (mut put_in, mut gained) = (0.0, 0.0);
            for (place, stiffness, paid) in updates {
                account.add(paid);
                put_in += paid;
                let new = SurfaceModel { place, stiffness, ..WALL };
                let before = stored(&surface, &hand);
                surface = account.paid(&surface, &new, &hand);
                gained += stored(&surface, &hand) - before;
                prop_assert!(gained <= put_in + 1e-9, "{gained} {put_in}");
            }
        }
    }

    #[test]
    fn a_surface_that_comes_comes_as_far_as_it_is_paid_for() {
        let hand = Vector3::zeros();
        let new = SurfaceModel {
            place: -2e-3,
            ..WALL
        };
        // ½ · 2 kN/m · (2 mm)² = 4 mJ.
        let mut account = UpdateAccount::new(1.0);
        let own = account.paid(&WALL, &new, &hand);
        assert!(own.place.abs() < 1e-5, "{own:?}");
        account.add(1e-3);
        let own = account.paid(&WALL, &new, &hand);
        assert!((own.place + 1e-3).abs() < 1e-5, "{own:?}");
        account.came_in(5.0);
        account.came_in(5.01);
        assert_eq!(account.paid(&own, &new, &hand), new);
        // One that goes gives back what its spring had.
        let gone = account.paid(&new, &WALL, &hand);
        assert_eq!(gone, WALL);
        assert_eq!(account.paid(&WALL, &new, &hand), new);
    }
}

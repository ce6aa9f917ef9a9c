//! Model-mediated: the follower sends what it touches, the leader renders it.
//!
//! The follower's end estimates the surface, its place, normal, stiffness and
//! friction (`estimate.rs`); the leader's end renders that surface locally, so
//! no force goes round through the delay (Hannaford 1989, "A design framework for
//! teleoperators with kinesthetic feedback", IEEE T-RA 5, section V; Mitra and
//! Niemeyer 2008, "Model-mediated telemanipulation", IJRR 27; survey: Xu, Cizmeci,
//! Schuwerk, Steinbach 2016, "Model-mediated teleoperation: toward stable and
//! transparent teleoperation systems", IEEE Access 4):
//!
//! F = K p n − μ K p v_t/max(|v_t|, v_0) − b v, p = max(s − s₀, 0), s = −n·x_h.
//!
//! b is what a hand at a stiff surface needs (`damping`), less at a soft one, and `free_damping`
//! where nothing is near (`hand_damping.rs`).
//!
//! **Corners.** Up to three surfaces are known at a time (`surfaces.rs`): the one that the tip touched last,
//! and those that it touches with it or is near. The contact's force is shared out to their normals, what
//! none of them explains becomes another surface, each is told in its turn, and the leader's end
//! renders the sum of all that were told within 0.3 s. With one at a time a hand that slides along a wall
//! into another one would lose the first. Ours; of an edge that bends away a plane that was left by 10 mm,
//! or gone through, is forgotten.
//!
//! An update is blended in: the model rendered follows the one received by a first
//! order lag, `blend_time`. Its place comes towards the hand no faster than `emerge_speed`; a
//! surface that appears around the hand begins at the hand, so that it winds nothing up at once, and
//! waits while a layer around the law gives the hand less than the law asks for: it would push with what
//! the hand is held with elsewhere.
//!
//! **Updates are passive** (what the survey of Xu et al. asks of them): one that would wind up the
//! spring under the hand goes on only as far as an energy account pays (`account.rs`, ours). The
//! two layers keep books of their own around the law and leave that out.
//!
//! The follower tells how stiff the surface is for sure. A soft surface counts as a stiff one at
//! first; it would keep a hand and, with that, the tip from going deep enough to learn better if
//! it were rendered as stiff as one that is known.
//!
//! Where `contact_force` is set (as in `auto.rs`), the follower tells the contact's own force with
//! it where surface and delay allow to feel it, and the leader's end leads F_N over
//! to it.
//!
//! Forward go the hand's position and the force f that it gives into the rendered
//! surface. The tip goes to that position, but no deeper behind the surface as the follower
//! estimates it than s₀ + f/K, with f at least `search_force`: no loop of force is closed
//! around the servo and its lag, only one of the place s₀, which is slow
//! (`place_frequency`; its gain is K_true/K − 1, so a K that is too small would make
//! it unstable).
//!
//! Under less than 0.8 f the tip goes on, evenly and with 30 mm/s at most, also where the surface
//! is believed to be too stiff for that: so it goes after a surface that it lost, and shows
//! what K a soft one has, which counts as a stiff one at first. This never takes the tip back, so
//! it is no loop of force either. To a surface that is known it comes with no more than that, braking
//! over the last 10 mm.
//!
//! A surface that moves was elsewhere when the hand learned of it. Where it gives way the tip goes
//! after it, s₀ + f/K, beyond the hand's position by as much as it moves in a round trip, where
//! `largest_chase` allows it (`chase.rs`): not by itself, as a soft surface whose stiffness is being
//! learned seems to move, and nobody keeps books of what that gives out.
//!
//! **What it guarantees.** Nothing about energy: what leaves at the tip is not bound to
//! what entered at the hand. Assumed for stability: a surface that
//! holds still for longer than a round trip; then both ends are local loops and any delay is
//! stable. What is felt of something that moves is old.
//!
//! **On loss.** No command. The leader goes on rendering the last surface, which costs nobody
//! energy, for `outlives`, and fades it out then: a hand that were let sink into the surface as
//! soon as the other end falls silent would have to be pushed out of it again, with energy that nobody has.

mod account;
mod chase;
mod chord;
mod compliance;
mod estimate;
mod even;
mod follower;
mod hand_damping;
mod leader;
mod noise;
mod place;
mod rendered;
mod surface;
mod surfaces;
mod told;

pub use follower::ModelMediatedFollower;
pub use leader::ModelMediatedLeader;
pub use surface::SurfaceModel;

use super::Samples;
use super::mapping::{law_ends, law_parameters};
use compliance::STIFFEST;
use surface::SURE;

/// A surface comes towards the hand no faster [m/s].
const PLACE_SPEED: f64 = 0.05;

law_parameters! {
    /// Parameters of the law. Every key may be left out.
    pub struct ModelMediated {
        /// b: damping at the hand, at something stiff \[N·s/m\].
        pub damping: f64 [0.0..=1000.0, "N·s/m"] = 14.0,
        /// The same far from all that is known to touch \[N·s/m\].
        pub free_damping: f64 [0.0..=1000.0, "N·s/m"] = 14.0,
        /// Time constant with which an update is blended in \[s\].
        pub blend_time: f64 [0.001..=10.0, "s"] = 0.1,
        /// A surface that appeared behind the hand comes out from under it no faster \[m/s\].
        pub emerge_speed: f64 [0.001..=PLACE_SPEED, "m/s"] = PLACE_SPEED,
        /// Whether updates have to be paid for.
        pub paid_updates: bool = true,
        /// What the account that pays for updates holds at most \[J\].
        pub update_reserve: f64 [0.0..=1000.0, "J"] = 0.1,
        /// For how long the surface is rendered after the other end was heard last \[s\].
        pub outlives: f64 [0.0..=60.0, "s"] = 2.0,
        /// Largest stiffness that is rendered \[N/m\].
        pub largest_stiffness: f64 [10.0..=10000.0, "N/m"] = 3300.0,
        /// The same while nothing is known of that of the surface \[N/m\].
        pub largest_doubtful_stiffness: f64 [10.0..=10000.0, "N/m"] = 3300.0,
        /// Whether the contact's own force is felt where surface and delay allow that.
        pub contact_force: bool = false,
        /// Largest force of the rendered surface on the hand \[N\].
        pub largest_force: f64 [0.1..=1000.0, "N"] = 30.0,
        /// Smallest contact force at the tip that counts as contact \[N\].
        pub contact_threshold: f64 [0.0001..=100.0, "N"] = 0.1,
        /// How hard the tip presses where the hand feels nothing yet \[N\].
        pub search_force: f64 [0.001..=100.0, "N"] = 3.0,
        /// Time constant with which the tip goes to the hand's position \[s\].
        pub position_time: f64 [0.002..=1.0, "s"] = 0.01,
        /// Largest speed of the tip's command, at the hand's scale \[m/s\].
        pub largest_speed: f64 [0.01..=10.0, "m/s"] = 0.5,
        /// How late the contact's force is beside the tip, by the filters of its estimate \[s\].
        pub force_lag: f64 [0.0..=0.1, "s"] = 0.008,
        /// How far beyond the hand the tip goes after a surface that moves, at most \[m\].
        pub largest_chase: f64 [0.0..=0.1, "m"] = 0.0,
        /// Natural frequency with which the place of the surface is followed \[rad/s\].
        pub place_frequency: f64 [1.0..=100.0, "rad/s"] = 12.0,
    }
}
law_ends!(
    ModelMediated,
    "model_mediated",
    Nothing,
    ModelMediatedLeader,
    ModelMediatedFollower
);

impl ModelMediated {
    fn samples(&self) -> [Samples; 2] {
        [Samples::position_and_force(1.0), Samples::SURFACE]
    }

    /// Stiffness that `model` has for sure \[N/m\], ours: K/(1 + z (ε − ε₀)), with ε its relative
    /// standard error and ε₀ one with which it is known well. z makes the stiffest one that there
    /// is, of which nothing is known, `largest_doubtful_stiffness`; up to that nobody doubts.
    fn sure_stiffness(&self, model: &SurfaceModel) -> f64 {
        let doubtful = self.largest_doubtful_stiffness.min(self.largest_stiffness);
        let beyond = (model.stiffness_error - SURE).max(0.0) / (1.0 - SURE);
        let sure = model.stiffness / (1.0 + beyond * (STIFFEST / doubtful - 1.0));
        model.stiffness.min(sure.max(doubtful))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// Of 2 kN/m, across x.
    pub(super) const WALL: SurfaceModel = SurfaceModel {
        normal: Vector3::new(-1.0, 0.0, 0.0),
        place: 0.0,
        stiffness: 2000.0,
        stiffness_error: 0.0,
        friction: 0.0,
    };

    /// A soft surface counts as a stiff one before more is known of it.
    #[test]
    fn what_may_be_soft_is_not_as_stiff_as_what_is_known() {
        let law = ModelMediated {
            largest_stiffness: 9000.0,
            ..ModelMediated::default()
        };
        let stiffness = |law: &ModelMediated, stiffness, stiffness_error| {
            law.sure_stiffness(&SurfaceModel {
                stiffness,
                stiffness_error,
                ..WALL
            })
        };
        // Known well, and not at all.
        assert_eq!(stiffness(&law, 20_000.0, 0.05), 20_000.0);
        assert!((stiffness(&law, STIFFEST, 1.0) - 3300.0).abs() < 1e-6);
        // ε = 0.2, at each new contact: 20 000/(1 + 0.1/0.9 (40 000/3300 − 1)).
        let between = stiffness(&law, 20_000.0, 0.2);
        assert!((between - 8945.8).abs() < 0.1, "{between} N/m");
        assert_eq!(stiffness(&law, 100.0, 1.0), 100.0);
        assert_eq!(stiffness(&law, 8000.0, 0.9), 3300.0);
        // Doubt makes nothing stiffer.
        let soft = ModelMediated {
            largest_stiffness: 1000.0,
            ..law
        };
        assert_eq!(stiffness(&soft, 20_000.0, 1.0), 1000.0);
    }
}

//! Two layers: any law within limits of energy.
//!
//! The inner law, the layer of transparency, says what force the hand should feel and where
//! the tip should be. Around it, at each end, the layer of passivity lets of that pass what
//! the energy in a tank pays for (Franken, Stramigioli, Misra, Secchi, Macchelli 2011,
//! "Bilateral telemanipulation with time delays: a two-layer approach combining passivity and
//! transparency", IEEE T-RO 27):
//!
//! * What goes through hand and tip goes into the tanks or out of them: at the hand the work of
//!   the force that the master rendered, at the tip that of the estimated contact force along the
//!   way of the tip as late as the estimate. Of what comes in an end promises a share to the other
//!   one at once, and of what it holds beyond its own need the share Δt/`transfer_time` in each
//!   step, as a sum that only grows: what is lost on the way the next packet makes good.
//! * **The hand.** The force gives out no more than the tank has, one step ahead, and changes
//!   evenly. While the tank has less than `level`, the hand is damped, which fills it (the tank
//!   level controller).
//! * **The tip.** Behind it are a servo and a mass that store energy on their own account, and a
//!   contact gets all of that before anybody knows. So the tank has to hold it: the command moves
//!   no faster than ½ m v² ≤ E, and in contact it leads the tip, along the force with which it
//!   pushes, by no more than ½ k d² ≤ E. Franken et al. take from the force there; an arm
//!   that is told positions has none to take from. A command that was kept back catches up with a
//!   bounded acceleration, as an arm that is jerked feigns forces; and it never leads by
//!   more than `largest_lead`, as a servo that is slow to take over would wind up.
//!
//! The inner law goes on from the command that was given, not from the one that it wished for.
//!
//! **What it guarantees.** Nothing strictly. With `model_mediated` inside, on the arm, the servo
//! and the estimator that ship, none of 4000 random cases gave out more than 0.02 J at hand and tip,
//! 0.0136 J the worst (`sim/tests/true_ports.rs`): where the tank is empty, the servo's spring still
//! lets the tip creep along a wall with friction. Around the others it takes nearly all of what
//! they would make: a tip that bounces on a wall, which they let it do, is quicker than the
//! estimate of its force, so that the books err.
//!
//! **On loss.** As the inner law. Nothing is spent that has not come in.

mod follower;
mod inside;
mod leader;
mod parameters;
#[cfg(test)]
mod tests;

pub use follower::TwoLayerFollower;
pub use inside::InnerLaw;
pub use leader::TwoLayerLeader;
pub use parameters::TwoLayer;

use super::{Guarantee, Mapping, Parameters, Samples};

impl Parameters for TwoLayer {
    const NAME: &'static str = "two_layer";
    type Leader = TwoLayerLeader;
    type Follower = TwoLayerFollower;

    fn guarantee(&self) -> Guarantee {
        Guarantee::Nothing
    }

    fn mapping(&self) -> Mapping {
        self.mapping()
    }

    fn samples(&self) -> [Samples; 2] {
        let inside = self.inside.between(&self.mapping());
        inside.samples().map(Samples::with_energy)
    }

    fn between(&self, mapping: &Mapping) -> TwoLayer {
        self.between(mapping)
    }

    fn leader(&self) -> TwoLayerLeader {
        TwoLayerLeader::new(self)
    }

    fn follower(&self) -> TwoLayerFollower {
        TwoLayerFollower::new(self)
    }
}

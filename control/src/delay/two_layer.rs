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
//!   way of the tip as late as the estimate. In the first moments of a contact nothing counts as
//!   coming in at the tip: one that bounces is quicker than the estimate.
//! * What comes in at the tip is promised to the hand's end at once, as what pushes the tip pushes
//!   the hand, and so, with `transfer_time`, is what the tip does not need. The hand's end promises
//!   a share of what comes in beyond what had come in before, and fills the tip's end up slowly,
//!   with `refill_time`. Promises are sums that only grow: what is lost on the way the next packet
//!   makes good.
//! * **The hand.** The force gives out no more than the tank has, one step ahead, and changes
//!   evenly. While the tank has less than `level`, the hand is damped, which fills it (the tank
//!   level controller), most where nothing is near: there it pays for the arm that it brings
//!   along, and feels next to nothing once it has.
//! * **The tip.** Behind it are a servo and a mass that store energy on their own account, and a
//!   contact gets all of that before anybody knows. So the tank has to hold it: the command moves
//!   no faster than ½ m v² ≤ E, and in contact it leads the tip, along the force with which it
//!   pushes, by no more than ½ k d² ≤ E, also next to what it has touched just before;
//!   where the tank is overdrawn by 12 mJ it only leaves. Franken et al. take from the force there; an arm
//!   that is told positions has none to take from. A command that was kept back catches up with a
//!   bounded acceleration, as an arm that is jerked feigns forces; and it never leads by
//!   more than `largest_lead`, as a servo that is slow to take over would wind up. It waits for a
//!   servo that comes to its first command after a hold (`taking_over.rs`).
//!
//! The inner law goes on from the command that was given, not from the one that it wished for.
//!
//! **What it guarantees.** With `model_mediated` inside it gives out no more at hand and tip than
//! came in there, to within 0.02 J, as measured: on the arm, the servo and the estimator that ship, in none
//! of 1000 cases drawn at random (`sim/tests/simulated/long/true_ports.rs`, `ferntast sweep --random 10000 --law
//! two_layer`). No proof stands behind that: where the tank is empty, the servo's spring still lets the tip
//! creep along a wall with friction, and the books are those of an estimate.
//! Around the other laws it takes nearly all of what
//! they would make: a tip that bounces on a wall, which they let it do, is quicker than the
//! estimate of its force, so that the books err. There it guarantees nothing.
//!
//! **On loss.** As the inner law. Nothing is spent that has not come in.

mod follower;
mod inside;
mod leader;
mod parameters;
mod taking_over;
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
        match self.inside {
            InnerLaw::ModelMediated(_) => Guarantee::Passive,
            _ => Guarantee::Nothing,
        }
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

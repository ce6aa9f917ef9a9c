//! The laws that the layer of passivity can be put around.

use crate::delay::ModelMediated;
use crate::delay::law::laws;

laws! {
    /// What the layer of transparency is, with its parameters. Of `tdpa` there is none: it has
    /// such a layer of its own, whose books go the same way.
    InnerLaw, InnerLeader, InnerFollower:
    /// Position forward, force back.
    PositionForce,
    /// Position forward, position back.
    PositionPosition,
    /// Position and force both ways.
    FourChannel,
    /// Wave variables with impedance matching and drift correction.
    Wave,
    /// The surface as the follower estimates it, rendered at the leader.
    ModelMediated,
}

impl Default for InnerLaw {
    fn default() -> Self {
        InnerLaw::ModelMediated(ModelMediated {
            // The layer adds its own.
            free_damping: 1.0,
            // It lets nothing out that a spring so stiff made.
            largest_stiffness: 9900.0,
            // It keeps books itself.
            paid_updates: false,
            largest_chase: 0.01,
            // What is quicker goes into the damping of the arm that holds on, and the tanks have
            // nothing to spare.
            emerge_speed: 0.02,
            ..ModelMediated::default()
        })
    }
}

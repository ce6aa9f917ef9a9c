//! What a law's packets say, for whoever leaves out packets that say nothing new
//! ([`crate::codec`]).

/// What three numbers of a packet are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sample {
    /// Nothing that the other end acts on.
    #[default]
    Unused,
    /// A position \[m\] that goes on evenly from one packet to the next.
    Position,
    /// Velocity of that position \[m/s\].
    Velocity,
    /// A force \[N\]; so many N at the hand are one of it.
    Force {
        /// \[-\]
        at_hand: f64,
    },
    /// Place \[m\] and friction \[-\] of a surface, which stand until they are told anew.
    Place,
    /// Stiffness of a surface along its normal \[N/m\], which stands until it is told anew.
    Stiffness,
    /// An integral, whose rate is what counts: every packet is news.
    Integral,
}

/// What the packets of one direction say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Samples {
    /// Of [`Packet::position`](super::Packet::position).
    pub position: Sample,
    /// Of [`Packet::vector`](super::Packet::vector).
    pub vector: Sample,
    /// The other end acts on [`Packet::energy`](super::Packet::energy), a sum that only grows.
    pub energy: bool,
}

impl Samples {
    /// Position and velocity.
    pub(super) const MOTION: Samples = Samples {
        position: Sample::Position,
        vector: Sample::Velocity,
        energy: false,
    };
    /// A surface.
    pub(super) const SURFACE: Samples = Samples {
        position: Sample::Place,
        vector: Sample::Stiffness,
        energy: false,
    };
    /// Position and an integral.
    pub(super) const INTEGRAL: Samples = Samples {
        position: Sample::Position,
        vector: Sample::Integral,
        energy: false,
    };

    /// A force, and nothing else that counts.
    pub(super) const fn force(at_hand: f64) -> Samples {
        Samples {
            position: Sample::Unused,
            vector: Sample::Force { at_hand },
            energy: false,
        }
    }

    /// A position and a force.
    pub(super) const fn position_and_force(at_hand: f64) -> Samples {
        Samples {
            position: Sample::Position,
            ..Samples::force(at_hand)
        }
    }

    /// The same, and energies count.
    pub(super) const fn with_energy(self) -> Samples {
        Samples {
            energy: true,
            ..self
        }
    }
}

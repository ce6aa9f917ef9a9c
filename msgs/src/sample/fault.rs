//! What can be wrong.

use super::Plain;

/// Declares the faults: each with its name on the wire.
macro_rules! faults {
    (
        $(#[$doc:meta])*
        pub enum $set:ident {
            $(#[$first_doc:meta])* $first:ident $first_name:literal,
            $($(#[$each:meta])* $fault:ident $name:literal,)*
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum $set {
            $(#[$first_doc])* $first = 0,
            $($(#[$each])* $fault,)*
        }

        impl $set {
            /// Every fault.
            pub const ALL: [$set; [$first_name $(, $name)*].len()] = [$set::$first $(, $set::$fault)*];

            /// Every name, for error texts.
            pub const KNOWN: &str = concat!($first_name $(, ", ", $name)*);

            /// The fault in words, as on the wire.
            pub const fn name(self) -> &'static str {
                match self {
                    $set::$first => $first_name,
                    $($set::$fault => $name,)*
                }
            }

            /// The fault of that name.
            pub fn from_name(name: &str) -> Option<$set> {
                $set::ALL.into_iter().find(|fault| fault.name() == name)
            }
        }
    };
}

faults! {
    /// One thing that can be wrong with a node's input or work; its place is its bit.
    pub enum Fault {
        /// No valid command for longer than the watchdog allows.
        CommandSilent "command silent",
        /// No measurement for longer than the watchdog allows.
        MeasurementSilent "measurement silent",
        /// A command was not finite, had a stamp of zero, or the wrong joint count.
        CommandInvalid "command invalid",
        /// A command was outside the workspace or joint limits.
        CommandOutOfRange "command out of range",
        /// A command jumped further than the arm could move.
        CommandJumped "command jumped",
        /// A command came from a source without authority.
        CommandUnauthorised "command unauthorised",
        /// A measurement was not finite or out of its range.
        MeasurementInvalid "measurement invalid",
        /// A torque sensor is at the end of its range.
        TorqueSaturated "torque saturated",
        /// The motor torque was limited.
        EffortLimited "effort limited",
        /// The velocity of the setpoint was limited.
        VelocityLimited "velocity limited",
        /// The reflected force was limited.
        ForceLimited "force limited",
        /// The Jacobian is singular here: contact forces cannot be told.
        Singular "singular configuration",
        /// The link to the other end is down.
        LinkDown "link down",
        /// The loop's deadline was missed.
        DeadlineMissed "deadline missed",
        /// No permission for real-time priority: it runs on without.
        NoRealtime "no realtime priority",
        /// Messages were lost on the way into the recording.
        RecordingLost "recording lost",
        /// The recording cannot be written.
        RecordingFailed "recording failed",
        /// A state command was not known or not allowed now.
        StateCommandRefused "state command refused",
        /// The joint left its position limits.
        JointLimit "joint limit",
        /// The joint is faster than allowed.
        JointOverspeed "joint overspeed",
        /// The tip touches two surfaces: the force's split along one is not defined.
        ContactAmbiguous "contact ambiguous",
        /// A torque sensor gives the same number while its joint turns.
        TorqueStuck "torque sensor stuck",
        /// The motor torque that the twin's model leaves unexplained has left its band.
        ResidualOutOfBand "residual out of its band",
        /// The lab finds an effect missing in the twin's model.
        ModelIncomplete "model incomplete",
        /// What the twin found was not taken over into the servo's feed-forward.
        TakeOverRefused "take-over refused",
        /// What came in over the link was not sealed by the peer: damaged, played again,
        /// or of a stranger.
        StrangerOnLink "stranger on the link",
    }
}

/// The set of faults that are active.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct Faults(pub u64);

// SAFETY: a number in a transparent type.
unsafe impl Plain for Faults {}

impl Faults {
    /// Adds `fault`.
    pub fn set(&mut self, fault: Fault) {
        self.0 |= 1 << fault as u8;
    }

    /// Adds `fault` when `active`.
    pub fn set_if(&mut self, fault: Fault, active: bool) {
        if active {
            self.set(fault);
        }
    }

    /// Whether `fault` is in the set.
    pub fn has(self, fault: Fault) -> bool {
        self.0 & (1 << fault as u8) != 0
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The faults in the set, in the order of [`Fault::ALL`]; bits that are no
    /// fault do not count.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL.into_iter().filter(move |&fault| self.has(fault))
    }
}

impl FromIterator<Fault> for Faults {
    fn from_iter<I: IntoIterator<Item = Fault>>(faults: I) -> Faults {
        let mut set = Faults::default();
        faults.into_iter().for_each(|fault| set.set(fault));
        set
    }
}

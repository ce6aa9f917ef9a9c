//! What can be wrong.

/// One thing that can be wrong with a node's input or work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Fault {
    /// No valid command for longer than the watchdog allows.
    CommandSilent = 0,
    /// No measurement for longer than the watchdog allows.
    MeasurementSilent,
    /// A command was not finite, had a stamp of zero, or the wrong joint count.
    CommandInvalid,
    /// A command was outside the workspace or joint limits.
    CommandOutOfRange,
    /// A command jumped further than the arm could move.
    CommandJumped,
    /// A command came from a source without authority.
    CommandUnauthorised,
    /// A measurement was not finite or out of its range.
    MeasurementInvalid,
    /// A torque sensor is at the end of its range.
    TorqueSaturated,
    /// The motor torque was limited.
    EffortLimited,
    /// The velocity of the setpoint was limited.
    VelocityLimited,
    /// The reflected force was limited.
    ForceLimited,
    /// The Jacobian is singular here: contact forces cannot be told.
    Singular,
    /// The link to the other end is down.
    LinkDown,
    /// The loop's deadline was missed.
    DeadlineMissed,
    /// No permission for real-time priority: it runs on without.
    NoRealtime,
    /// Messages were lost on the way into the recording.
    RecordingLost,
    /// The recording cannot be written.
    RecordingFailed,
    /// A state command was not known or not allowed now.
    StateCommandRefused,
    /// The joint left its position limits.
    JointLimit,
    /// The joint is faster than allowed.
    JointOverspeed,
    /// The tip touches two surfaces: the force's split along one is not defined.
    ContactAmbiguous,
    /// A torque sensor gives the same number while its joint turns.
    TorqueStuck,
    /// The motor torque that the twin's model leaves unexplained has left its band.
    ResidualOutOfBand,
    /// The lab finds an effect missing in the twin's model.
    ModelIncomplete,
    /// What the twin found was not taken over into the servo's feed-forward.
    TakeOverRefused,
}

impl Fault {
    /// Every fault.
    pub const ALL: [Fault; 25] = [
        Fault::CommandSilent,
        Fault::MeasurementSilent,
        Fault::CommandInvalid,
        Fault::CommandOutOfRange,
        Fault::CommandJumped,
        Fault::CommandUnauthorised,
        Fault::MeasurementInvalid,
        Fault::TorqueSaturated,
        Fault::EffortLimited,
        Fault::VelocityLimited,
        Fault::ForceLimited,
        Fault::Singular,
        Fault::LinkDown,
        Fault::DeadlineMissed,
        Fault::NoRealtime,
        Fault::RecordingLost,
        Fault::RecordingFailed,
        Fault::StateCommandRefused,
        Fault::JointLimit,
        Fault::JointOverspeed,
        Fault::ContactAmbiguous,
        Fault::TorqueStuck,
        Fault::ResidualOutOfBand,
        Fault::ModelIncomplete,
        Fault::TakeOverRefused,
    ];

    /// Every name, for error texts.
    pub const KNOWN: &str = "command silent, measurement silent, command invalid, \
        command out of range, command jumped, command unauthorised, \
        measurement invalid, torque saturated, effort limited, \
        velocity limited, force limited, singular configuration, link down, \
        deadline missed, no realtime priority, recording lost, \
        recording failed, state command refused, joint limit, joint overspeed, \
        contact ambiguous, torque sensor stuck, residual out of its band, \
        model incomplete, take-over refused";

    /// The fault in words, as on the wire.
    pub const fn name(self) -> &'static str {
        match self {
            Fault::CommandSilent => "command silent",
            Fault::MeasurementSilent => "measurement silent",
            Fault::CommandInvalid => "command invalid",
            Fault::CommandOutOfRange => "command out of range",
            Fault::CommandJumped => "command jumped",
            Fault::CommandUnauthorised => "command unauthorised",
            Fault::MeasurementInvalid => "measurement invalid",
            Fault::TorqueSaturated => "torque saturated",
            Fault::EffortLimited => "effort limited",
            Fault::VelocityLimited => "velocity limited",
            Fault::ForceLimited => "force limited",
            Fault::Singular => "singular configuration",
            Fault::LinkDown => "link down",
            Fault::DeadlineMissed => "deadline missed",
            Fault::NoRealtime => "no realtime priority",
            Fault::RecordingLost => "recording lost",
            Fault::RecordingFailed => "recording failed",
            Fault::StateCommandRefused => "state command refused",
            Fault::JointLimit => "joint limit",
            Fault::JointOverspeed => "joint overspeed",
            Fault::ContactAmbiguous => "contact ambiguous",
            Fault::TorqueStuck => "torque sensor stuck",
            Fault::ResidualOutOfBand => "residual out of its band",
            Fault::ModelIncomplete => "model incomplete",
            Fault::TakeOverRefused => "take-over refused",
        }
    }

    /// The fault of that name.
    pub fn from_name(name: &str) -> Option<Fault> {
        Fault::ALL.into_iter().find(|fault| fault.name() == name)
    }
}

/// The set of faults that are active.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct Faults(pub u64);

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

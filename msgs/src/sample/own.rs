//! The messages of ferntast's own, `ferntast_msgs/msg/…`, each declared once.
//!
//! The comments of a message and of its fields are those of its `.msg` file,
//! which a test writes (`msgs/tests/msg_files.rs`). What the attributes say is
//! in the crate `ferntast-derive`.

use ferntast_derive::message;

use super::{Flag, Identity, MAX_TWIN_PARAMETERS, codes::codes};
use crate::{InvalidMessage, Text, Time};

/// Which source of hand positions drives the arm, and which was refused last.
/// Sources are told apart by 64 bit, written as hexadecimal digits.
#[message(Authority)]
pub struct AuthoritySample {
    /// when it was decided or last published
    pub stamp: Time,
    /// the source that holds the authority; empty while nobody does
    pub holder: Identity,
    /// the source that was refused last; empty when none was
    pub refused: Identity,
    /// commands refused so far because another source holds the authority
    pub refused_count: u64,
    /// why, for people
    pub reason: Text<96>,
}

/// What the servo makes of the commands for the tip and the joints, so that a
/// client learns why the arm does not follow it. Counts run since the start.
#[message(CommandStatus)]
pub struct CommandStatusSample {
    /// when it was told
    pub stamp: Time,
    /// \[s\] age of the command that is followed; NaN before the first after enable or resume
    #[field(or_nan)]
    pub age: f64,
    /// commands acted on
    pub accepted: u64,
    /// stamp of zero, or not newer than the one before
    #[field(section = "Commands refused, by kind.")]
    pub refused_stamp: u64,
    /// too old, or from the future
    pub refused_time: u64,
    /// a number that is not finite
    pub refused_value: u64,
    /// outside the workspace, the reach or a joint's limits
    pub refused_range: u64,
    /// further from the one before than a hand can move
    pub refused_jump: u64,
    /// why the last one was refused; empty where none was
    pub reason: Text<96>,
}

codes! {
    /// An edge of the contour.
    pub struct Edge {
        /// No edge, or not known which.
        NONE = 0 "none",
        /// The straight edge with dry-film lubricant.
        LUBRICATED = 1 "lubricated",
        /// The straight edge of bare aluminium.
        UNLUBRICATED = 2 "unlubricated",
        /// The spring that is pulled.
        SPRING = 3 "spring",
        /// A plane beside a serial arm.
        SURFACE = 4 "surface",
    }
}

/// The contact of the tip with the contour, as estimated from joint torques.
/// Forces are in the contact frame: x tangential, z along the normal, which
/// points out of the surface.
#[message(ContactState, comment_column = 36, check = friction_is_identified_or_not)]
pub struct ContactStateSample {
    /// time of the measurement that it was estimated from
    pub stamp: Time,
    /// the tip touches a surface of the contour
    pub in_contact: Flag,
    /// the tip touches something: a surface of the contour, or what is not in it, by a larger force that lasts
    pub touches: Flag,
    /// the forces can be used: the configuration is not singular and no input is missing
    pub valid: Flag,
    /// the tangential force is undefined: the motor turns, the tip still rests
    pub near_rest: Flag,
    /// none, lubricated, unlubricated or spring
    pub edge: Edge,
    /// \[N\] >= 0 pushes the tip out of the surface
    #[field(section)]
    pub normal_force: f64,
    /// \[N\] positive when it opposes the tip's motion
    pub tangential_force: f64,
    /// \[-\] NaN before it is identified
    #[field(or_nan)]
    pub friction_coefficient: f64,
    /// \[-\] standard error of the coefficient; infinite before it is identified
    #[field(or_infinite)]
    pub friction_coefficient_error: f64,
}

/// No number for the coefficient, but an error: it is one or the other.
fn friction_is_identified_or_not(contact: &ContactStateSample) -> Result<(), InvalidMessage> {
    let value = contact.friction_coefficient;
    match value.is_nan() && contact.friction_coefficient_error.is_finite() {
        false => Ok(()),
        true => Err(InvalidMessage::NotFinite {
            field: "friction_coefficient",
            value,
        }),
    }
}

codes! {
    /// Where the friction that is fed forward comes from.
    pub struct FrictionSource {
        /// The arm's file.
        CONFIGURED = 0 "configured",
        /// The twin.
        TWIN = 1 "twin",
    }
}

/// The friction that the servo feeds forward at one joint. The lists go
/// together, one element a parameter of its model.
#[message(FrictionStatus, comment_column = 28)]
pub struct FrictionStatusSample {
    /// when it was told
    pub stamp: Time,
    /// which joint: joint_1 or joint_2
    #[field(whole = "the name of a joint")]
    pub joint: Text<32>,
    /// where the targets come from: configured or twin
    pub source: FrictionSource,
    /// as in the arm's file: b_0, b_0T, ...
    #[field(section)]
    pub names: [Text<24>; MAX_TWIN_PARAMETERS],
    /// by the arm's file
    pub configured: [f64; MAX_TWIN_PARAMETERS],
    /// in use now
    pub values: [f64; MAX_TWIN_PARAMETERS],
    /// what the values are, or are on their way to
    pub targets: [f64; MAX_TWIN_PARAMETERS],
    /// commands on /follower/friction_command dealt with since the start
    #[field(section)]
    pub commands: u64,
    /// why the last one was refused; empty where it was not
    pub refused: Text<96>,
}

/// What the channel between operator and arm is to do to frames from now on, in
/// place of what the session began with. Only an emulated channel obeys.
#[message(LinkCommand)]
pub struct LinkCommandSample {
    /// when it was given
    pub stamp: Time,
    /// both ways together, half of it each \[s\]
    pub round_trip: f64,
    /// largest deviation of a frame's delay, uniformly distributed \[s\]
    pub jitter: f64,
    /// share of frames lost each way, independently, 0 … 1
    pub loss: f64,
}

codes! {
    /// An end of the link.
    pub struct LinkEnd {
        /// The operator's end.
        LEADER = 0 "leader",
        /// The arm's end.
        FOLLOWER = 1 "follower",
    }
}

/// What one end of the link measures of it; only what the emulated channel is set to
/// is not measured. Counts and energies run since the start of the session.
#[message(LinkStatus, comment_column = 28)]
pub struct LinkStatusSample {
    /// when it was measured
    pub stamp: Time,
    /// which end measured it: leader or follower
    pub end: LinkEnd,
    /// the delay law
    pub law: Text<24>,
    /// identity of the session
    pub session: u16,
    /// frames arrive
    pub connected: Flag,
    /// \[s\] newest measurement; NaN before the first
    #[field(section, or_nan)]
    pub round_trip: f64,
    /// \[s\] one way, the other end to this one; true as far as both clocks agree; NaN before the first
    #[field(or_nan)]
    pub delay: f64,
    /// \[s\] interarrival jitter after RFC 3550, section 6.4.1
    pub jitter: f64,
    /// share of the frames sent to this end in the last second that did not arrive, 0 to 1
    pub loss: f64,
    /// \[s\] age of the content in use
    pub age: f64,
    /// \[s\] how long a frame is on its way to this end
    #[field(section = "What the emulated channel to this end is set to.")]
    pub channel_delay: f64,
    /// \[s\] by how much that varies at most, or about so
    pub channel_jitter: f64,
    /// share of the frames that it loses on average, 0 to 1
    pub channel_loss: f64,
    /// \[J\] energy that entered
    #[field(section = "The two-port of the delay law, at this end.")]
    pub energy_in: f64,
    /// \[J\] energy that left
    pub energy_out: f64,
    /// \[J\] energy that the law dissipated
    pub energy_dissipated: f64,
    /// frames sent
    #[field(section)]
    pub sent: u64,
    /// frames received and acted on
    pub received: u64,
    /// frames lost
    pub lost: u64,
    /// not as long as a frame is
    #[field(section = "Frames received and not acted on, by kind.")]
    pub refused_length: u64,
    /// of another version of the format
    pub refused_version: u64,
    /// of another session
    pub refused_session: u64,
    /// checksum wrong
    pub refused_checksum: u64,
    /// sent in the future, or longer ago than a frame can live
    pub refused_time: u64,
    /// a number that is not finite or out of range
    pub refused_value: u64,
    /// a sequence number that was acted on before
    pub refused_replayed: u64,
    /// overtaken by a newer frame
    pub refused_late: u64,
}

/// Whom one end of the link talks to, and how far that one's clock is from its own.
#[message(LinkPeer)]
pub struct LinkPeerSample {
    /// when it was told
    pub stamp: Time,
    /// which end tells it: leader or follower
    pub end: LinkEnd,
    /// public key of the other host, its first 48 characters; empty before the first handshake
    pub key: Text<48>,
    /// handshakes so far: one more with every start of either end
    pub handshakes: u64,
    /// it asks this end to hold: its device is not ENABLED, or it hears nothing
    pub holds: Flag,
    /// \[s\] the other clock is ahead of this one by so much
    #[field(section = "From the echoes in frames, both ways taken for equally long.")]
    pub clock_offset: f64,
    /// the other clock is faster by so much, seconds a second
    pub clock_drift: f64,
    /// \[s\] by how much the offset can be wrong; infinite before the first echo
    #[field(or_infinite)]
    pub clock_error: f64,
    /// how often one of the clocks jumped
    pub clock_jumps: u64,
}

codes! {
    /// What a recorder can be told.
    pub struct RecorderAction {
        /// Write from now on.
        START = 1 "start",
        /// Write no longer.
        STOP = 2 "stop",
        /// Note something: the command itself, in the recording.
        MARK = 3 "mark",
    }
}

/// What the recorder is to do. A mark is this message itself in the recording.
#[message(RecorderCommand)]
pub struct RecorderCommandSample {
    /// when it was given
    pub stamp: Time,
    /// start, stop or mark
    pub action: RecorderAction,
    /// start: the folder, relative to the session's, empty for one named after the time; mark: what is noted
    pub label: Text<96>,
}

impl RecorderCommandSample {
    /// A command with its label, cut to 96 bytes.
    pub fn new(stamp: Time, action: RecorderAction, label: &str) -> RecorderCommandSample {
        RecorderCommandSample {
            action,
            label: Text::new(label),
            ..RecorderCommandSample::initial(stamp)
        }
    }
}

/// What the recorder does.
#[message(RecorderStatus)]
pub struct RecorderStatusSample {
    /// when it was told
    pub stamp: Time,
    /// it writes
    pub recording: Flag,
    /// where to, or where to it wrote last
    pub folder: Text<96>,
    /// messages written there
    pub messages: u64,
}

codes! {
    /// What the lab says of a model.
    pub struct TwinVerdict {
        /// Too little came in yet.
        PENDING = 0 "pending",
        /// No systematic rest in the samples used.
        COMPLETE = 1 "complete",
        /// An effect of the catalogue is missing.
        MISSING = 2 "missing",
        /// Something is missing that the catalogue does not have.
        UNEXPLAINED = 3 "unexplained",
    }
}

/// What the twin of a joint says: the model's parameters as they are now, and
/// whether the model holds. The lists go together, one element a parameter.
#[message(TwinParameters, comment_column = 28)]
pub struct TwinParametersSample {
    /// of the samples that it is about
    pub stamp: Time,
    /// which joint: joint_1 or joint_2
    #[field(whole = "the name of a joint")]
    pub joint: Text<32>,
    /// as in the lab: b0, b1, ...
    #[field(section)]
    pub names: [Text<24>; MAX_TWIN_PARAMETERS],
    /// now
    pub values: [f64; MAX_TWIN_PARAMETERS],
    /// as identified from the experiment's recordings
    pub off_line: [f64; MAX_TWIN_PARAMETERS],
    /// of the values
    pub std_errors: [f64; MAX_TWIN_PARAMETERS],
    /// 0 where the motion told nothing of it, towards 1 where it told all
    pub excitation: [f64; MAX_TWIN_PARAMETERS],
    /// \[Nm\] latest residuals, root mean square
    #[field(section)]
    pub residual_rms: f64,
    /// \[Nm\] standard deviation of the residual off line
    pub band: f64,
    /// the residual has left its band
    pub out_of_band: Flag,
    /// its name
    #[field(
        section = "A parameter that moved away from its value off line; empty and 0 where none did."
    )]
    pub changed: Text<24>,
    /// step or drift
    pub change_kind: Text<8>,
    /// value before
    pub change_before: f64,
    /// value after
    pub change_after: f64,
    /// \[s\] after the twin's first sample: when half of the way was done
    pub change_time: f64,
    /// pending, complete, missing or unexplained
    #[field(section = "The lab's assessment of what came in so far.")]
    pub verdict: TwinVerdict,
    /// \[s\] after the twin's first sample; 0 before the first assessment
    pub assessed_at: f64,
    /// the missing effect, best first; empty without one
    pub candidate: Text<32>,
    /// signals that the residual depends on most
    pub goes_with: Text<64>,
}

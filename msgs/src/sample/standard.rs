//! Messages that are a type of ROS 2, field by field.

use ferntast_derive::message;

use super::{Flag, codes::codes};
use crate::{
    Text, Time,
    ros::{crtk_msgs, sensor_msgs},
};

/// Command to the link: another delay law. Which laws there are, the link
/// knows.
#[message(standard = crtk_msgs::StringStamped)]
pub struct LawCommandSample {
    /// When it was given.
    pub stamp: Time,
    /// The law, as in configurations.
    #[field(name = "string", whole = "the name of a delay law, such as wave")]
    pub law: Text<24>,
}

codes! {
    /// What the servo's friction feed-forward can be told to do.
    pub struct FrictionCommand {
        /// Use what the twin found.
        TAKE_OVER = 1 "take_over",
        /// Use what is configured, at every joint.
        GIVE_BACK = 2 "give_back",
    }
}

/// A command to the friction feed-forward.
#[message(standard = crtk_msgs::StringStamped)]
pub struct FrictionCommandSample {
    /// When it was given.
    pub stamp: Time,
    /// The command.
    #[field(name = "string")]
    pub command: FrictionCommand,
}

impl FrictionCommandSample {
    /// That command.
    pub const fn new(stamp: Time, command: FrictionCommand) -> FrictionCommandSample {
        FrictionCommandSample {
            command,
            ..FrictionCommandSample::initial(stamp)
        }
    }
}

codes! {
    /// The state commands of CRTK, and the words to the clutch of the hand.
    pub struct StateCommand {
        /// Drives on.
        ENABLE = 1 "enable",
        /// Drives off.
        DISABLE = 2 "disable",
        /// Hold.
        PAUSE = 3 "pause",
        /// Leave the hold: re-arm.
        RESUME = 4 "resume",
        /// Leave a hold for silent commands after a short gap in the link; no person's word.
        RESUME_AFTER_GAP = 5 "resume_after_gap",
        /// To the master: the hand moves, the arm stays.
        CLUTCH = 6 "clutch",
        /// To the master: the hand leads the arm again, from where both are.
        ENGAGE = 7 "engage",
    }
}

/// A state command to one device.
#[message(standard = crtk_msgs::StringStamped, stops = StateCommandSample::is_a_stop)]
pub struct StateCommandSample {
    /// When it was given.
    pub stamp: Time,
    /// The command.
    #[field(name = "string")]
    pub command: StateCommand,
}

impl StateCommandSample {
    /// That command.
    pub const fn new(stamp: Time, command: StateCommand) -> StateCommandSample {
        StateCommandSample {
            command,
            ..StateCommandSample::initial(stamp)
        }
    }

    /// Whether its command is one.
    fn is_a_stop(&self) -> bool {
        self.command.is_stop()
    }
}

impl StateCommand {
    /// Whether it holds the device or turns its drives off.
    pub const fn is_stop(self) -> bool {
        matches!(self, StateCommand::PAUSE | StateCommand::DISABLE)
    }
}

codes! {
    /// The operating states of CRTK.
    pub struct OperatingState {
        /// Drives off.
        DISABLED = 0 "DISABLED",
        /// Follows commands.
        ENABLED = 1 "ENABLED",
        /// Holds passively; latched until resumed.
        PAUSED = 2 "PAUSED",
        /// Something is broken; drives off until disabled and enabled again.
        FAULT = 3 "FAULT",
    }
}

/// Operating state of one device, with the reason for it.
#[message(standard = crtk_msgs::OperatingState)]
pub struct OperatingStateSample {
    /// Since when the device is in this state, or when it was last published.
    pub stamp: Time,
    /// The state.
    pub state: OperatingState,
    /// 1 when homed.
    pub is_homed: Flag,
    /// 1 while a motion or homing is under way.
    pub is_busy: Flag,
    /// Why it is in this state, for people. It goes to `/diagnostics`: the CRTK
    /// type has no room for it.
    #[field(local)]
    pub reason: Text<96>,
}

impl OperatingStateSample {
    /// A device that is homed and not busy.
    pub fn new(stamp: Time, state: OperatingState, reason: &str) -> OperatingStateSample {
        OperatingStateSample {
            state,
            is_homed: 1,
            reason: Text::new(reason),
            ..OperatingStateSample::initial(stamp)
        }
    }
}

/// Mean of one joint's temperature sensors; which joint, the topic says.
#[message(standard = sensor_msgs::Temperature)]
pub struct TemperatureSample {
    /// When it was measured.
    pub stamp: Time,
    /// Temperature \[degC\], as the ROS 2 type has it.
    pub temperature: f64,
    /// Variance of the measurement \[degC²\]; 0 where unknown.
    pub variance: f64,
}

impl TemperatureSample {
    /// A temperature \[degC\] of unknown variance.
    pub const fn new(stamp: Time, temperature: f64) -> TemperatureSample {
        TemperatureSample {
            temperature,
            ..TemperatureSample::initial(stamp)
        }
    }
}

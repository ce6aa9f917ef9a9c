//! What page and server say to each other over the WebSocket, as JSON.

use std::collections::BTreeMap;

use ferntast_msgs::sample::{OperatingState, StateCommand};
use serde::{Deserialize, Serialize};

use super::operator_lock::Release;

/// What a page says.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// It wants to operate.
    Operate,
    /// It wants to watch only.
    Watch,
    /// It is alive: from the loop in which it draws.
    Beat,
    /// The operator holds the hand there, leader base frame \[m\].
    Hand {
        /// \[m\]
        x: f64,
        /// \[m\]
        y: f64,
        /// \[m\]
        #[serde(default)]
        z: f64,
    },
    /// The operator lets the hand go.
    LetGo,
    /// Arm, hold, re-arm; anybody may stop.
    State {
        /// What.
        word: StateRequest,
    },
    /// The channel is to be like that.
    Link {
        /// Both ways together \[s\].
        round_trip: f64,
        /// Largest deviation of a frame's delay \[s\].
        jitter: f64,
        /// Share of frames \[0 … 1\].
        loss: f64,
    },
    /// Another delay law, at both ends.
    Law {
        /// Its name, as in configurations.
        law: String,
    },
    /// Record from now on.
    Record {
        /// Folder, relative to the session's working folder; empty for one
        /// named after the time.
        #[serde(default)]
        folder: String,
    },
    /// Record no longer.
    EndRecord,
    /// Note this in the recording.
    Mark {
        /// What is noted.
        label: String,
    },
}

/// What is to be done about the operating state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StateRequest {
    /// Drives on.
    Arm,
    /// Stay where you are.
    Hold,
    /// Follow again after a hold.
    Rearm,
    /// Drives off, at once; out of a fault, too.
    Stop,
}

impl StateRequest {
    /// What a device in `state` is told; `None` where that is no word for it. A device of
    /// which no state is known, as one beyond the link, is told what was asked for.
    ///
    /// A fault is left by a stop and then by arming: two words, of which a person says
    /// each.
    pub fn command(self, state: Option<OperatingState>) -> Option<StateCommand> {
        let not_in = |those: &[OperatingState]| state.is_none_or(|own| !those.contains(&own));
        let (command, meant) = match self {
            StateRequest::Stop => (StateCommand::DISABLE, true),
            StateRequest::Hold => (StateCommand::PAUSE, true),
            StateRequest::Arm => (
                StateCommand::ENABLE,
                not_in(&[OperatingState::PAUSED, OperatingState::FAULT]),
            ),
            StateRequest::Rearm => (
                StateCommand::RESUME,
                not_in(&[OperatingState::DISABLED, OperatingState::FAULT]),
            ),
        };
        meant.then_some(command)
    }
}

/// What the server says, beside snapshots.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Answer<'a> {
    /// The first thing: which page this is, and what the session is made of.
    Hello {
        /// The page's number.
        page: u64,
        /// The session.
        session: &'a serde_json::Value,
    },
    /// A request was refused.
    Refused {
        /// Why, for people.
        reason: String,
    },
}

/// The session at one moment. Lengths \[m\], forces \[N\], angles \[rad\].
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Snapshot {
    /// `snapshot`.
    pub r#type: &'static str,
    /// Seconds since the console was started.
    pub t: f64,
    /// Joint positions; `None` before the first message.
    pub q: Option<Vec<f32>>,
    /// How long ago the joints were there \[s\].
    pub q_age: Option<f32>,
    /// Joint torques \[Nm\].
    pub tau: Vec<f32>,
    /// The tip, follower base frame.
    pub tip: Option<[f32; 3]>,
    /// Where the tip is wanted.
    pub wanted: Option<[f32; 3]>,
    /// Contact force on the tip, base frame.
    pub force: [f32; 3],
    /// The contact; `None` where nobody tells of it.
    pub contact: Option<ContactView>,
    /// The hand that is there, accepted or not, leader base frame.
    pub hand: Option<[f32; 3]>,
    /// Where a page's hand would begin, leader base frame.
    pub begin: [f32; 3],
    /// The force on the hand; `None` where nobody tells of it.
    pub hand_force: Option<[f32; 3]>,
    /// The operator's end of the link.
    pub link: Option<LinkView>,
    /// The arm's end of the link.
    pub follower_link: Option<LinkView>,
    /// What the emulated channel is set to; `None` where one end is not heard of.
    pub channel: Option<ChannelView>,
    /// Operating states by device.
    pub states: BTreeMap<&'static str, StateView>,
    /// Who holds the authority; `None` where nobody tells.
    pub authority: Option<AuthorityView>,
    /// Who operates.
    pub seat: OperatorView,
    /// Temperatures, joint by joint \[degC\].
    pub temperatures: Vec<Option<f32>>,
    /// The recorder.
    pub recorder: RecorderView,
    /// The nodes, a few times a second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<Vec<NodeView>>,
    /// What happened, the oldest first; with the nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events: Option<Vec<EventView>>,
}

/// Something that happened.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct EventView {
    /// When: seconds since the console was started.
    pub t: f64,
    /// When: seconds since the UNIX epoch.
    pub unix: f64,
    /// ok, warning, error.
    pub level: &'static str,
    /// What, and why.
    pub text: String,
}

/// The operating state of a device.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StateView {
    /// The state.
    pub state: &'static str,
    /// Why it is in that state.
    pub reason: String,
    /// It does not tell it any more.
    pub silent: bool,
}

/// The contact.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ContactView {
    /// In contact.
    pub on: bool,
    /// The forces can be used.
    pub valid: bool,
    /// Which edge.
    pub edge: &'static str,
    /// F_N.
    pub normal: f32,
    /// F_T.
    pub tangential: f32,
}

/// One end of the link, as measured there. Times \[s\], energies \[J\]; `None`
/// before anything was measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LinkView {
    /// Round trip.
    pub round_trip: Option<f32>,
    /// One way, to this end.
    pub delay: Option<f32>,
    /// Interarrival jitter.
    pub jitter: f32,
    /// Share lost in the last second.
    pub loss: f32,
    /// Frames arrive.
    pub connected: bool,
    /// Entered at this end.
    pub energy_in: f32,
    /// Left at this end.
    pub energy_out: f32,
    /// Dissipated by the law.
    pub dissipated: f32,
    /// The law.
    pub law: String,
}

/// What the emulated channel is set to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ChannelView {
    /// Both ways together \[s\].
    pub round_trip: f32,
    /// Largest deviation of a frame's delay, or one like it; of the worse way \[s\].
    pub jitter: f32,
    /// Share of frames lost on the worse way \[0 … 1\].
    pub loss: f32,
}

/// Who holds the authority.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AuthorityView {
    /// Whose hand.
    pub holder: Holder,
    /// The page's number, or the source on ROS 2, hexadecimal.
    pub identity: String,
    /// Hands refused so far.
    pub refused: u64,
    /// Why, for people.
    pub reason: String,
}

/// Whose hand holds the authority.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Holder {
    /// Nobody's.
    #[default]
    Nobody,
    /// The master's own: a script or a recorded motion.
    Own,
    /// A page's.
    Page,
    /// A client's on ROS 2.
    Client,
}

/// Who operates.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct OperatorView {
    /// The page that operates.
    pub operator: Option<u64>,
    /// Where it wants the hand, while it holds it.
    pub target: Option<[f32; 3]>,
    /// Why the hand was let go.
    pub let_go: Option<Release>,
    /// Pages that watch, the operator's included.
    pub pages: usize,
}

/// The recorder.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RecorderView {
    /// It writes.
    pub on: bool,
    /// Where to.
    pub folder: String,
    /// Messages written.
    pub messages: u64,
}

/// A node.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NodeView {
    /// Its name.
    pub name: String,
    /// Steps a second \[Hz\].
    pub rate: f32,
    /// Wake-up lateness, 99th percentile \[µs\].
    pub late: f32,
    /// ok, warning, error, stale.
    pub level: &'static str,
    /// Deadlines missed.
    pub missed: u64,
    /// Faults that are active.
    pub faults: Vec<&'static str>,
    /// What it has to say.
    pub message: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_goes_to_those_that_it_is_for_and_a_stop_to_all() {
        use OperatingState as State;
        let states = [State::DISABLED, State::ENABLED, State::PAUSED, State::FAULT];
        let told = |word: StateRequest| states.map(|state| word.command(Some(state)));
        let (enable, resume) = (Some(StateCommand::ENABLE), Some(StateCommand::RESUME));
        assert_eq!(told(StateRequest::Stop), [Some(StateCommand::DISABLE); 4]);
        assert_eq!(told(StateRequest::Hold), [Some(StateCommand::PAUSE); 4]);
        assert_eq!(told(StateRequest::Arm), [enable, enable, None, None]);
        // The master's is also the word for an arm beyond the link.
        assert_eq!(told(StateRequest::Rearm), [None, resume, resume, None]);
        assert_eq!(StateRequest::Arm.command(None), enable);
        assert_eq!(StateRequest::Rearm.command(None), resume);
    }

    #[test]
    fn requests_are_read_and_others_refused() {
        let read = |text| serde_json::from_str::<Request>(text).ok();
        let (x, y) = (0.01, -0.02);
        let hand = read(r#"{"type":"hand","x":0.01,"y":-0.02}"#);
        assert_eq!(hand, Some(Request::Hand { x, y, z: 0.0 }));
        let hand = read(r#"{"type":"hand","x":0.01,"y":-0.02,"z":0.03}"#);
        assert_eq!(hand, Some(Request::Hand { x, y, z: 0.03 }));
        let stop = read(r#"{"type":"state","word":"stop"}"#);
        assert_eq!(
            stop,
            Some(Request::State {
                word: StateRequest::Stop
            })
        );
        assert_eq!(
            read(r#"{"type":"record"}"#),
            Some(Request::Record {
                folder: String::new()
            })
        );
        for text in [
            r#"{"type":"hand","x":0.01}"#,
            r#"{"type":"hand","x":"1","y":0}"#,
            r#"{"type":"state","word":"explode"}"#,
            "{}",
            "",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}

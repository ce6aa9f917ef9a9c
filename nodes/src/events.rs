//! What happens to a session, in words: state changes, crashes, who takes the master, the
//! link, recordings. The supervisor keeps the one [`EventWatch`] there is and says each event
//! on `/diagnostics`, as a status of [`TELLER`]; the page's log, the live line and
//! `ferntast state --follow` show those.
//!
//! Pure: time comes with the messages.

use std::collections::{BTreeMap, HashMap, VecDeque};

use ferntast_console::session::page_of;
use ferntast_msgs::{
    Text, Time,
    sample::{
        AuthoritySample, HealthSample, Level, LinkStatusSample, OperatingState,
        OperatingStateSample, RecorderAction, RecorderCommandSample, RecorderStatusSample,
    },
};

use crate::master::THIS_HOST;

/// The name in `/diagnostics` under which events are said. Its stamp is the event's, also
/// where the newest event is said again for those who came later.
pub const TELLER: &str = "session";

/// Events that wait to be said at most; the oldest go.
const WAITING: usize = 64;
/// What a node warns of is an event so often at most, and the same again so often \[s\].
const WARNING_PERIOD: f64 = 5.0;
/// For so long from the first word of a node on, nodes wait for each other: no event \[s\].
const STARTING: f64 = 3.0;
const SAME_WARNING_PERIOD: f64 = 60.0;

/// Something that happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// When.
    pub at: Time,
    /// How bad it is.
    pub level: Level,
    /// What, and why.
    pub text: Text<96>,
}

impl Event {
    /// As it is said on `/diagnostics`.
    pub fn sample(&self) -> HealthSample {
        HealthSample {
            level: self.level,
            message: self.text,
            ..HealthSample::new(self.at, TELLER)
        }
    }

    /// The event that a status says; `None` of the status of a node.
    pub fn of(sample: &HealthSample) -> Option<Event> {
        (sample.node.as_str() == TELLER).then_some(Event {
            at: sample.stamp,
            level: sample.level,
            text: sample.message,
        })
    }
}

/// Makes events of what is heard.
#[derive(Debug, Default)]
pub struct EventWatch {
    states: BTreeMap<&'static str, (OperatingState, Text<96>)>,
    connected: Option<bool>,
    law: Option<Text<24>>,
    holder: Option<u64>,
    recording: Option<bool>,
    /// What each node warned of last, and when.
    warnings: HashMap<Text<24>, (Text<96>, Time)>,
    /// When a node said something first.
    began: Option<Time>,
    waiting: VecDeque<Event>,
    last: Time,
}

impl EventWatch {
    /// Something that no message tells.
    pub fn note(&mut self, at: Time, level: Level, text: impl std::fmt::Display) {
        // Each has a time of its own, by which it is known.
        let at = match at > self.last {
            true => at,
            false => self.last.plus_nanos(1),
        };
        self.last = at;
        if self.waiting.len() == WAITING {
            self.waiting.pop_front();
        }
        self.waiting.push_back(Event {
            at,
            level,
            text: Text::display(text),
        });
    }

    /// Events since the last call, the oldest first.
    pub fn take(&mut self) -> VecDeque<Event> {
        std::mem::take(&mut self.waiting)
    }

    /// A device, `follower` or `leader`, told its state.
    pub fn state(&mut self, device: &'static str, sample: &OperatingStateSample) {
        let now = (sample.state, sample.reason);
        let before = self.states.insert(device, now);
        let begins = before.is_none() && sample.state == OperatingState::DISABLED;
        if before == Some(now) || begins {
            return;
        }
        let level = match sample.state {
            OperatingState::FAULT => Level::ERROR,
            OperatingState::PAUSED => Level::WARN,
            _ => Level::OK,
        };
        let name = name_of(device);
        let state = sample.state.name().unwrap_or("UNKNOWN");
        self.note(
            sample.stamp,
            level,
            format_args!("{name} {state}: {}", sample.reason),
        );
    }

    /// The operator's end told of the link.
    pub fn link(&mut self, status: &LinkStatusSample) {
        let connected = status.connected == 1;
        let before = self.connected.replace(connected);
        match (before, connected) {
            (Some(false) | None, true) => self.note(status.stamp, Level::OK, "link up"),
            (Some(true), false) => {
                self.note(status.stamp, Level::WARN, "link down: no frames arrive");
            }
            _ => {}
        }
        if self
            .law
            .replace(status.law)
            .is_some_and(|law| law != status.law)
        {
            self.note(status.stamp, Level::OK, format_args!("law {}", status.law));
        }
    }

    /// The master told who holds it.
    pub fn authority(&mut self, sample: &AuthoritySample) {
        let holder = sample.holder;
        let before = self.holder.replace(holder);
        if before.unwrap_or_default() != holder {
            let at = sample.stamp;
            match (holder, page_of(holder)) {
                (0, _) => self.note(at, Level::OK, "nobody's hand is on the master"),
                (THIS_HOST, _) => {
                    self.note(at, Level::OK, "the session's own hand is on the master");
                }
                (_, Some(page)) => {
                    self.note(
                        at,
                        Level::OK,
                        format_args!("the hand of page {page} is on the master"),
                    );
                }
                (client, None) => self.note(
                    at,
                    Level::OK,
                    format_args!("the hand of client {client:016x} is on the master"),
                ),
            }
        }
    }

    /// The recorder told what it does.
    pub fn recorder(&mut self, status: &RecorderStatusSample) {
        let on = status.recording == 1;
        let before = self.recording.replace(on);
        if before == Some(on) || (before.is_none() && !on) {
            return;
        }
        let what = if on {
            "recording into"
        } else {
            "recording ended:"
        };
        self.note(
            status.stamp,
            Level::OK,
            format_args!("{what} {}", status.folder),
        );
    }

    /// The recorder was told something.
    pub fn recorder_command(&mut self, command: &RecorderCommandSample) {
        if command.action == RecorderAction::MARK {
            self.note(
                command.stamp,
                Level::OK,
                format_args!("mark: {}", command.label),
            );
        }
    }

    /// A node told how it is doing. What the servo warns of is a state, and told as such.
    pub fn health(&mut self, health: &HealthSample) {
        let began = *self.began.get_or_insert(health.stamp);
        if health.level < Level::WARN
            || health.message.is_empty()
            || health.node.as_str() == "servo"
        {
            return;
        }
        if health.stamp.seconds_since(began) < STARTING {
            return;
        }
        let known = self.warnings.get(&health.node);
        let again = known.is_some_and(|(text, at)| {
            let period = match *text == health.message {
                true => SAME_WARNING_PERIOD,
                false => WARNING_PERIOD,
            };
            health.stamp.seconds_since(*at) < period
        });
        if again {
            return;
        }
        self.warnings
            .insert(health.node, (health.message, health.stamp));
        self.note(
            health.stamp,
            health.level,
            format_args!("{}: {}", health.node, health.message),
        );
    }
}

/// What people call a device, `follower` or `leader`.
pub(crate) fn name_of(device: &str) -> &'static str {
    match device {
        "follower" => "arm",
        _ => "master",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> Time {
        Time::from_nanos(1_000_000_000_000 + (seconds * 1e9) as i64)
    }

    fn said(watch: &mut EventWatch) -> Vec<String> {
        let events = watch.take();
        events.iter().map(|own| own.text.to_string()).collect()
    }

    #[test]
    fn a_change_is_an_event_and_a_repetition_none() {
        let mut watch = EventWatch::default();
        let state = |seconds, state, reason| OperatingStateSample::new(at(seconds), state, reason);
        for tenth in 0..20 {
            let seconds = f64::from(tenth) * 0.1;
            watch.state(
                "follower",
                &state(seconds, OperatingState::ENABLED, "enable was asked for"),
            );
        }
        let paused = state(
            2.5,
            OperatingState::PAUSED,
            "commands fell silent; send resume",
        );
        watch.state("follower", &paused);
        let events = watch.take();
        assert_eq!(events.len(), 2);
        assert_eq!(events[1].at, at(2.5));
        assert_eq!(events[1].level, Level::WARN);
        assert_eq!(
            events[1].text.as_str(),
            "arm PAUSED: commands fell silent; send resume"
        );
        // On the way over /diagnostics nothing is lost.
        assert_eq!(Event::of(&events[1].sample()), Some(events[1]));
        assert_eq!(Event::of(&HealthSample::new(at(1.0), "servo")), None);
    }

    #[test]
    fn events_have_times_of_their_own_and_do_not_fill_the_memory() {
        let mut watch = EventWatch::default();
        for number in 0..1000 {
            watch.note(at(1.0), Level::OK, number);
        }
        let events = watch.take();
        assert_eq!(events.len(), WAITING);
        assert!(
            events
                .iter()
                .zip(events.iter().skip(1))
                .all(|(a, b)| a.at < b.at)
        );
        assert_eq!(
            events.back().map(|own| own.text.to_string()),
            Some("999".to_owned())
        );
    }

    #[test]
    fn hands_links_recordings_and_marks_are_told() {
        let mut watch = EventWatch::default();
        for holder in [0, 0, THIS_HOST, 0x7061_6765_0000_0003, 0xabcd, 0xabcd, 0] {
            watch.authority(&AuthoritySample {
                holder,
                ..AuthoritySample::initial(at(0.0))
            });
        }
        assert_eq!(
            said(&mut watch),
            [
                "the session's own hand is on the master",
                "the hand of page 3 is on the master",
                "the hand of client 000000000000abcd is on the master",
                "nobody's hand is on the master",
            ]
        );
        for (connected, law) in [
            (0, "wave"),
            (1, "wave"),
            (1, "tdpa"),
            (0, "tdpa"),
            (1, "tdpa"),
        ] {
            watch.link(&LinkStatusSample {
                connected,
                law: Text::new(law),
                ..LinkStatusSample::initial(at(1.0))
            });
        }
        assert_eq!(
            said(&mut watch),
            [
                "link up",
                "law tdpa",
                "link down: no frames arrive",
                "link up"
            ]
        );
        for recording in [0, 1, 1, 0] {
            watch.recorder(&RecorderStatusSample {
                recording,
                folder: Text::new("run"),
                ..RecorderStatusSample::initial(at(2.0))
            });
        }
        watch.recorder_command(&RecorderCommandSample::new(
            at(3.0),
            RecorderAction::MARK,
            "second contact",
        ));
        assert_eq!(
            said(&mut watch),
            [
                "recording into run",
                "recording ended: run",
                "mark: second contact"
            ]
        );
    }

    #[test]
    fn how_a_session_begins_is_no_event() {
        let mut watch = EventWatch::default();
        let started = "started; send enable";
        watch.state(
            "follower",
            &OperatingStateSample::new(at(0.0), OperatingState::DISABLED, started),
        );
        let waits = |seconds| HealthSample {
            level: Level::WARN,
            message: Text::new("no handshake yet"),
            ..HealthSample::new(at(seconds), "link_follower")
        };
        for tenth in 0..29 {
            watch.health(&waits(f64::from(tenth) * 0.1));
        }
        assert_eq!(said(&mut watch), [""; 0]);
        // What lasts is one.
        watch.health(&waits(3.1));
        assert_eq!(said(&mut watch), ["link_follower: no handshake yet"]);
    }

    #[test]
    fn a_node_that_warns_all_the_time_is_one_event() {
        let mut watch = EventWatch::default();
        for tenth in 0..100 {
            watch.health(&HealthSample {
                level: Level::WARN,
                message: Text::new("a stranger was not let in"),
                ..HealthSample::new(at(f64::from(tenth) * 0.1), "link_follower")
            });
        }
        assert_eq!(
            said(&mut watch),
            ["link_follower: a stranger was not let in"]
        );
    }
}

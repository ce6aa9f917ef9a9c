//! Connections of the link that did not come about: whom TLS did not let in here, and why
//! the other end did not let this one in. Zenoh only logs that; here it is read.

use std::{
    fmt::{self, Write},
    sync::{
        Arc, Mutex, OnceLock, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use ferntast_msgs::Text;
use tracing::{
    Event, Level, Metadata, Subscriber,
    field::{Field, Visit},
    level_filters::LevelFilter,
    span,
    subscriber::Interest,
};

/// Where Zenoh tells of whom a listening end did not let in.
const TURNED_AWAY: &str = "zenoh_link_commons::quic";
/// Where it tells why a connecting end was not let in.
const NOT_LET_IN: &str = "zenoh::net::runtime::orchestrator";

/// What it tells there of every connection, whether it comes about or not: the ends are known by
/// their keys, not by names.
const OF_ALL: &str = "Skipping name verification";

/// Why a connection did not come about, in the library's words.
pub type Reason = Text<96>;

/// Connections that did not come about, of all links of this process.
#[derive(Clone, Debug, Default)]
pub struct Door(Arc<Seen>);

#[derive(Debug, Default)]
struct Seen {
    turned_away: AtomicU64,
    /// There is something in `last`: nearly always there is not.
    told: AtomicBool,
    last: Mutex<Reasons>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Reasons {
    turned_away: Option<Reason>,
    not_let_in: Option<Reason>,
}

impl Door {
    /// That of this process; from the first call on it is looked at.
    pub(super) fn of_process() -> Door {
        static DOOR: OnceLock<Door> = OnceLock::new();
        let watched = || {
            let door = Door::default();
            // Who else reads the log of this process sees it in our place.
            let _ = tracing::subscriber::set_global_default(Log(door.clone()));
            door
        };
        DOOR.get_or_init(watched).clone()
    }

    /// How many were turned away here since the start.
    pub fn turned_away(&self) -> u64 {
        self.0.turned_away.load(Ordering::Acquire)
    }

    /// Why the last of them was; waits for nobody.
    pub fn last_turned_away(&self) -> Option<Reason> {
        self.last(|own| own.turned_away)
    }

    /// Why this end was not let in when it last tried; waits for nobody.
    pub fn not_let_in(&self) -> Option<Reason> {
        self.last(|own| own.not_let_in)
    }

    fn last(&self, which: impl FnOnce(&Reasons) -> Option<Reason>) -> Option<Reason> {
        if !self.0.told.load(Ordering::Acquire) {
            return None;
        }
        which(&*self.0.last.try_lock().ok()?)
    }

    fn note(&self, turned_away: bool, text: &str) {
        let reason = Some(Reason::new(essence(text)));
        let mut last = self.0.last.lock().unwrap_or_else(PoisonError::into_inner);
        self.0.told.store(true, Ordering::Release);
        if turned_away {
            last.turned_away = reason;
            drop(last);
            self.0.turned_away.fetch_add(1, Ordering::Release);
        } else {
            last.not_let_in = reason;
        }
    }
}

/// The reason that QUIC gives, if it gives one; else the text without what Zenoh adds:
/// where in its source it was, and hints at open files.
fn essence(text: &str) -> &str {
    let reason = text.split_once("reason: ").map(|(_, rest)| rest);
    let quoted = reason.and_then(|rest| rest.split('"').nth(1));
    if let Some(reason) = quoted.filter(|own| !own.is_empty()) {
        return reason;
    }
    let begin = text.find("! ").map_or(0, |at| at + 2);
    let text = &text[begin..];
    let end = [" Hint:", " at /", " Retry in"]
        .iter()
        .filter_map(|mark| text.find(mark));
    text[..end.min().unwrap_or(text.len())].trim_end_matches(['.', ' '])
}

/// Reads the log, of which nothing else is of interest.
struct Log(Door);

fn is_turned_away(metadata: &Metadata<'_>) -> bool {
    let target = metadata.target();
    *metadata.level() == Level::WARN && target.starts_with(TURNED_AWAY)
}

/// Whether that line is of a connection that did not come about: other things are told there too.
fn tells_why(turned_away: bool, line: &str) -> bool {
    match turned_away {
        true => !line.starts_with(OF_ALL),
        false => line.starts_with("Unable to connect"),
    }
}

fn is_not_let_in(metadata: &Metadata<'_>) -> bool {
    *metadata.level() == Level::DEBUG && metadata.target() == NOT_LET_IN
}

impl Subscriber for Log {
    fn register_callsite(&self, metadata: &'static Metadata<'static>) -> Interest {
        match self.enabled(metadata) {
            true => Interest::always(),
            false => Interest::never(),
        }
    }

    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && (is_turned_away(metadata) || is_not_let_in(metadata))
    }

    fn max_level_hint(&self) -> Option<LevelFilter> {
        Some(LevelFilter::DEBUG)
    }

    fn event(&self, event: &Event<'_>) {
        let turned_away = is_turned_away(event.metadata());
        let mut line = Line::default();
        event.record(&mut line);
        if tells_why(turned_away, &line.0) {
            self.0.note(turned_away, &line.0);
        }
    }

    fn new_span(&self, _: &span::Attributes<'_>) -> span::Id {
        span::Id::from_u64(1)
    }

    fn record(&self, _: &span::Id, _: &span::Record<'_>) {}
    fn record_follows_from(&self, _: &span::Id, _: &span::Id) {}
    fn enter(&self, _: &span::Id) {}
    fn exit(&self, _: &span::Id) {}
}

/// The text of an event.
#[derive(Default)]
struct Line(String);

impl Visit for Line {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        if field.name() == "message" {
            // A text that cannot be written is left out.
            let _ = write!(self.0, "{value:?}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_essence_of_what_is_logged() {
        for (text, expected) in [
            (
                "invalid peer certificate: UnknownIssuer. Hint: increase the system open file limit.",
                "invalid peer certificate: UnknownIssuer",
            ),
            (
                "Unable to connect to configured peer quic/10.0.0.2:7448! no route at /home/x/y.rs:7.. Retry in 1s.",
                "no route",
            ),
            (
                r#"QUIC acceptor failed: E { frame: None, reason: "invalid peer certificate" } Hint: x"#,
                "invalid peer certificate",
            ),
            (r#"reason: b"" at /x"#, r#"reason: b"""#),
            ("something else", "something else"),
        ] {
            assert_eq!(essence(text), expected);
        }
    }

    #[test]
    fn what_is_told_of_every_connection_is_no_reason() {
        assert!(!tells_why(
            true,
            "Skipping name verification of QUIC server"
        ));
        assert!(tells_why(true, "QUIC acceptor failed"));
        assert!(tells_why(
            false,
            "Unable to connect to x! two. Retry in 1s."
        ));
        assert!(!tells_why(false, "Connected to x"));
    }

    #[test]
    fn what_was_seen_is_counted() {
        let door = Door::default();
        door.note(true, "one. Hint: none");
        door.note(false, "Unable to connect to x! two. Retry in 1s.");
        assert_eq!(door.turned_away(), 1);
        assert_eq!(door.last_turned_away(), Some(Reason::new("one")));
        assert_eq!(door.not_let_in(), Some(Reason::new("two")));
    }
}

//! Feeds a recording again through the nodes that can be replayed: servo,
//! estimator and, if asked, a twin.

use std::path::Path;

use ferntast_bus::{
    Bus, CreateError, Depth, McapBus, Subscriber,
    mcap::{self, BagReader},
};
use ferntast_emulation::channel::LinkConfig;
use ferntast_lab::experiment::RECORD;
use ferntast_msgs::{
    Message, Time,
    topics::{self, Topic, Visitor},
};
use serde::Serialize;

use crate::{
    carry::{Carrier, Carry, Stamp},
    config::Loaded,
    graph::{Graph, NodeRow},
    lockstep::{RunError, VirtualTime},
    process::SessionContext,
    twin::TwinSummary,
};

/// Why a recording cannot be fed again.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// It cannot be opened.
    #[error("{0}")]
    Open(String),
    /// It does not say what it was made of.
    #[error(
        "the recording does not say what it was made of ({0}); only recordings of `ferntast lockstep` can be fed again"
    )]
    Origin(String),
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// A node cannot be made.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// How the outputs compare.
#[derive(Debug, Serialize)]
pub struct Comparison {
    /// Whether all were equal, bit for bit.
    pub equal: bool,
    /// Output messages compared.
    pub compared: u64,
    /// Messages that differ, are missing or are too many.
    pub different: u64,
    /// The first difference.
    pub first_difference: Option<String>,
    /// The twin's last word; `null` without one.
    pub twin: Option<TwinSummary>,
}

trait Check {
    fn check(&mut self, now: Time, result: &mut Comparison);
}

struct TypedCheck<M: Message> {
    topic: &'static str,
    recorded: Subscriber<M>,
    replayed: Subscriber<M>,
}

impl<M: Message> Check for TypedCheck<M> {
    fn check(&mut self, now: Time, result: &mut Comparison) {
        loop {
            let recorded = self.recorded.next(now);
            let replayed = self.replayed.next(now);
            if recorded.is_none() && replayed.is_none() {
                return;
            }
            result.compared += 1;
            // In the ROS 2 form: what the recording cannot hold does not count.
            let recorded = recorded.map(|own| (own.received, own.message.to_ros()));
            let replayed = replayed.map(|own| (own.received, own.message.to_ros()));
            let equal = match (&recorded, &replayed) {
                (Some(first), Some(second)) => {
                    first.0 == second.0 && same_bytes(&first.1, &second.1)
                }
                _ => false,
            };
            if !equal {
                result.different += 1;
                result.equal = false;
                if result.first_difference.is_none() {
                    let which = match (&recorded, &replayed) {
                        (Some(_), None) => "missing in the replay",
                        (None, Some(_)) => "not in the recording",
                        _ => "different",
                    };
                    let at = recorded
                        .as_ref()
                        .or(replayed.as_ref())
                        .map_or(0, |own| own.0.nanos());
                    result.first_difference = Some(format!("{} at {at} ns: {which}", self.topic));
                }
            }
        }
    }
}

/// Whether two messages are the same bytes on the wire (NaN equals NaN).
fn same_bytes<R: ferntast_msgs::RosMessage>(first: &R, second: &R) -> bool {
    let (mut first_bytes, mut second_bytes) = (Vec::new(), Vec::new());
    ferntast_bus::cdr::encode(first, &mut first_bytes).is_ok()
        && ferntast_bus::cdr::encode(second, &mut second_bytes).is_ok()
        && first_bytes == second_bytes
}

/// Feeds the recording at `path` again through the nodes of `graph` that can
/// be replayed, and through a twin of the experiment `twin`, and compares what
/// they publish with what is recorded: of the twin only where one was recorded.
///
/// # Errors
///
/// A recording that cannot be opened, or that lockstep did not make; an
/// experiment that cannot be followed.
pub fn run(
    graph: &Graph,
    path: &Path,
    twin: Option<&Path>,
    progress: &mut dyn FnMut(f64),
) -> Result<Comparison, ReplayError> {
    let recorded = Recorded::open(path)?;
    let mut session = SessionContext::in_virtual_time(recorded.loaded()?);
    session.twin = twin.map(Path::to_owned);
    let rows: Vec<&NodeRow> = graph
        .rows()
        .filter(|row| (row.in_replay)(&session))
        .collect();

    let mut time = VirtualTime::new(recorded.start)?;
    let mut carrier = recorded.inputs(&rows, time.bus())?;
    time.add(move |now| {
        carrier.carry(now);
    })?;
    time.add_nodes(rows.iter().copied(), &session)?;
    let mut checks = recorded.checks(&rows, time.bus())?;
    let mut said = time
        .bus()
        .subscriber(topics::TWIN_PARAMETERS, Depth::Newest)?;

    let mut result = Comparison {
        equal: true,
        compared: 0,
        different: 0,
        first_difference: None,
        twin: None,
    };
    let duration = recorded.end.seconds_since(recorded.start).max(1e-9);
    while time.now() <= recorded.end {
        let now = time.tick();
        for check in &mut checks {
            check.check(now, &mut result);
        }
        if now.nanos_since(recorded.start) % 1_000_000_000 == 0 {
            progress(now.seconds_since(recorded.start) / duration);
        }
    }
    // What was published at the end is visible after it.
    let last = said.newest(time.now());
    result.twin = last.map(|own| TwinSummary::of(&own.message));
    Ok(result)
}

/// A recording of lockstep.
struct Recorded {
    bus: Bus,
    info: mcap::BagInfo,
    /// Topics that it has, with messages or without.
    topics: Vec<String>,
    start: Time,
    end: Time,
}

impl Recorded {
    fn open(path: &Path) -> Result<Recorded, ReplayError> {
        let open = |error: &dyn std::fmt::Display| ReplayError::Open(error.to_string());
        let info = mcap::info(path).map_err(|error| open(&error))?;
        let (Some(start), Some(end)) = (info.start, info.end) else {
            return Err(ReplayError::Open(format!(
                "{} holds no message",
                path.display()
            )));
        };
        let reader = BagReader::open(path).map_err(|error| open(&error))?;
        Ok(Recorded {
            bus: Bus::Mcap(McapBus::open(path).map_err(|error| open(&error))?),
            topics: reader.topics().map(|own| own.name.to_string()).collect(),
            info,
            start,
            end,
        })
    }

    /// What it was made of; the link and the hand have no part in a replay.
    fn loaded(&self) -> Result<Loaded, ReplayError> {
        let origin = self.info.metadata.get(RECORD);
        let origin =
            origin.ok_or_else(|| ReplayError::Origin(format!("no metadata record {RECORD:?}")))?;
        let entry = |key: &str| origin.get(key).map(String::as_str).unwrap_or_default();
        if entry("mode") != "lockstep" {
            return Err(ReplayError::Origin(format!(
                "its mode is {:?}, in which steps are not at known times",
                entry("mode")
            )));
        }
        let bad = |error: serde_json::Error| ReplayError::Origin(error.to_string());
        Ok(Loaded {
            path: String::new(),
            scenario: serde_json::from_str(entry("scenario")).map_err(bad)?,
            arm: serde_json::from_str(entry("arm")).map_err(bad)?,
            link: LinkConfig::default(),
            hand_recording: None,
        })
    }

    fn has(&self, topic: &str) -> bool {
        self.topics.iter().any(|own| own == topic)
    }

    fn has_messages(&self, topic: &str) -> bool {
        let counted = self.info.topics.iter().find(|own| own.name == topic);
        counted.is_some_and(|own| own.messages > 0)
    }

    /// Carries what the nodes of `rows` take and none of them publishes.
    fn inputs(&self, rows: &[&NodeRow], to: &Bus) -> Result<Carrier, CreateError> {
        let mut carrier = Carrier::default();
        carrier.add_topics(&self.bus, to, Stamp::Received, |topic, _| {
            let taken = rows.iter().any(|row| row.inputs().contains(&topic));
            let published = rows.iter().any(|row| row.outputs().contains(&topic));
            match taken && !published && self.has(topic) {
                true => Carry::Every { queue: 64 },
                false => Carry::Not,
            }
        })?;
        Ok(carrier)
    }

    /// Compares what the nodes of `rows` publish with what is recorded.
    /// Recordings of earlier versions lack some topics; one without a twin has
    /// its topics without messages.
    fn checks(&self, rows: &[&NodeRow], bus: &Bus) -> Result<Vec<Box<dyn Check>>, CreateError> {
        let outputs = rows
            .iter()
            .filter(|row| row.outputs().iter().any(|topic| self.has_messages(topic)))
            .flat_map(|row| row.outputs())
            .copied()
            .filter(|topic| self.has(topic))
            .collect();
        let mut add = AddChecks {
            outputs,
            recorded: &self.bus,
            bus,
            checks: Ok(Vec::new()),
        };
        topics::visit(&mut add);
        add.checks
    }
}

/// Adds a check of each topic that is an output.
struct AddChecks<'a> {
    outputs: Vec<&'static str>,
    recorded: &'a Bus,
    bus: &'a Bus,
    checks: Result<Vec<Box<dyn Check>>, CreateError>,
}

impl AddChecks<'_> {
    fn check<M: Message>(&self, topic: Topic<M>) -> Result<Box<dyn Check>, CreateError> {
        Ok(Box::new(TypedCheck {
            topic: topic.name,
            recorded: self.recorded.subscriber(topic, Depth::Queue(64))?,
            replayed: self.bus.subscriber(topic, Depth::Queue(64))?,
        }))
    }
}

impl Visitor for AddChecks<'_> {
    fn topic<M: Message>(&mut self, topic: Topic<M>) {
        if !self.outputs.contains(&topic.name) {
            return;
        }
        let check = self.check(topic);
        if let Ok(checks) = &mut self.checks {
            match check {
                Ok(check) => checks.push(check),
                Err(error) => self.checks = Err(error),
            }
        }
    }
}

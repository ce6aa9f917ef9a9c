//! Feeds a recording again through servo, estimator and, if asked, a twin.

use std::path::Path;

use ferntast_bus::{
    Bus, CreateError, Depth, MemoryBus, Subscriber,
    mcap::{self, BagReader},
};
use ferntast_lab::experiment::RECORD;
use ferntast_model::ParameterError;
use ferntast_msgs::{
    Message, Time,
    sample::Faults,
    topics::{self, Topic},
};
use serde::Serialize;

use crate::{
    carry::{Carrier, Carry, Stamp},
    config::{ArmFile, Scenario},
    estimator::{EstimatorNode, EstimatorPorts},
    node::{HealthMeter, Runner},
    node_name::NodeName,
    process::PERIOD_NANOS,
    servo::{ServoNode, ServoPorts},
    twin::{Assessing, TwinModel, TwinNode, TwinPorts, TwinSummary},
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
    /// A parameter is out of its bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
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

/// Inputs of servo and estimator.
const INPUTS: [&str; 5] = [
    "/follower/measured_js",
    "/follower/servo_cp",
    "/follower/servo_jp",
    "/follower/state_command",
    "/follower/friction_command",
];

/// What the servo takes of a twin: from the recording, where no twin is run anew.
const FROM_THE_TWIN: &str = "/twin/parameters";

/// Inputs of a twin beside those.
const OF_THE_TWIN: [&str; 3] = [
    "/follower/motor_js",
    "/follower/joint_1/temperature",
    "/follower/joint_2/temperature",
];

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

/// Feeds the recording at `path` again through servo, estimator and `twin` and
/// compares what they publish with what is recorded: of the twin only where one
/// was recorded.
///
/// # Errors
///
/// A recording that cannot be opened, or that lockstep did not make.
pub fn run(
    path: &Path,
    twin: Option<TwinModel>,
    progress: &mut dyn FnMut(f64),
) -> Result<Comparison, ReplayError> {
    let open = |error: &dyn std::fmt::Display| ReplayError::Open(error.to_string());
    let info = mcap::info(path).map_err(|error| open(&error))?;
    let (Some(start), Some(end)) = (info.start, info.end) else {
        return Err(ReplayError::Open(format!(
            "{} holds no message",
            path.display()
        )));
    };
    let origin = info
        .metadata
        .get(RECORD)
        .ok_or_else(|| ReplayError::Origin(format!("no metadata record {RECORD:?}")))?;
    let entry = |key: &str| origin.get(key).map(String::as_str).unwrap_or_default();
    if entry("mode") != "lockstep" {
        return Err(ReplayError::Origin(format!(
            "its mode is {:?}, in which steps are not at known times",
            entry("mode")
        )));
    }
    let bad = |error: serde_json::Error| ReplayError::Origin(error.to_string());
    let scenario: Scenario = serde_json::from_str(entry("scenario")).map_err(bad)?;
    let arm: ArmFile = serde_json::from_str(entry("arm")).map_err(bad)?;

    let bus = Bus::Memory(MemoryBus::new());
    let recording = Bus::Mcap(ferntast_bus::McapBus::open(path).map_err(|error| open(&error))?);
    let topics_there: Vec<String> = BagReader::open(path)
        .map_err(|error| open(&error))?
        .topics()
        .map(|topic| topic.name.to_string())
        .collect();
    let recorded = |name: &str| {
        let counted = info.topics.iter().find(|own| own.name == name);
        counted.is_some_and(|own| own.messages > 0)
    };
    let there = |name: &str| topics_there.iter().any(|own| own == name);
    let mut carrier = Carrier::default();
    carrier.add_topics(&recording, &bus, Stamp::Received, |topic| {
        let topic = topic.name;
        let wanted = INPUTS.contains(&topic)
            || match twin.is_some() {
                true => OF_THE_TWIN.contains(&topic),
                false => topic == FROM_THE_TWIN,
            };
        if wanted && there(topic) {
            Carry::Every { queue: 64 }
        } else {
            Carry::Not
        }
    })?;
    let mut checks: Vec<Box<dyn Check>> = Vec::new();
    add_check(&mut checks, &recording, &bus, topics::FOLLOWER_SERVO_JF)?;
    add_check(&mut checks, &recording, &bus, topics::FOLLOWER_SETPOINT_JS)?;
    add_check(
        &mut checks,
        &recording,
        &bus,
        topics::FOLLOWER_OPERATING_STATE,
    )?;
    for topic in [
        topics::FOLLOWER_JOINT_1_FRICTION,
        topics::FOLLOWER_JOINT_2_FRICTION,
    ] {
        // Recordings of earlier versions have none.
        if there(topic.name) {
            add_check(&mut checks, &recording, &bus, topic)?;
        }
    }
    add_check(&mut checks, &recording, &bus, topics::FOLLOWER_MEASURED_CP)?;
    add_check(&mut checks, &recording, &bus, topics::FOLLOWER_MEASURED_CF)?;
    add_check(&mut checks, &recording, &bus, topics::FOLLOWER_CONTACT_CF)?;
    add_check(
        &mut checks,
        &recording,
        &bus,
        topics::FOLLOWER_CONTACT_STATE,
    )?;

    if twin.is_some() && recorded(topics::TWIN_PARAMETERS.name) {
        add_check(&mut checks, &recording, &bus, topics::TWIN_MOTOR_JS)?;
        add_check(&mut checks, &recording, &bus, topics::TWIN_RESIDUAL_JS)?;
        add_check(&mut checks, &recording, &bus, topics::TWIN_PARAMETERS)?;
    }

    let meter =
        |name: NodeName| HealthMeter::new(name.as_str(), 0, PERIOD_NANOS, Faults::default());
    let servo = ServoNode::new(&arm.model, &scenario.servo)?;
    let mut servo = Runner::new(
        &bus,
        servo,
        ServoPorts::connect(&bus)?,
        meter(NodeName::Servo),
    )?;
    let estimator = EstimatorNode::new(&arm.model, &arm.estimator)?;
    let ports = EstimatorPorts::connect(&bus)?;
    let mut estimator = Runner::new(&bus, estimator, ports, meter(NodeName::Estimator))?;

    let mut said = bus.subscriber(topics::TWIN_PARAMETERS, Depth::Newest)?;
    let mut twin = match twin {
        None => None,
        Some(model) => {
            let node = TwinNode::new(model, Assessing::Inline);
            let ports = TwinPorts::connect(&bus)?;
            Some(Runner::new(&bus, node, ports, meter(NodeName::Twin))?)
        }
    };

    let mut result = Comparison {
        equal: true,
        compared: 0,
        different: 0,
        first_difference: None,
        twin: None,
    };
    let duration = end.seconds_since(start).max(1e-9);
    let mut now = start;
    while now <= end {
        carrier.carry(now);
        servo.tick(now, 0, 0);
        estimator.tick(now, 0, 0);
        if let Some(twin) = &mut twin {
            twin.tick(now, 0, 0);
        }
        if let Some(own) = said.newest(now) {
            result.twin = Some(TwinSummary::of(&own.message));
        }
        for check in &mut checks {
            check.check(now, &mut result);
        }
        if now.nanos_since(start) % 1_000_000_000 == 0 {
            progress(now.seconds_since(start) / duration);
        }
        now = now.plus_nanos(PERIOD_NANOS);
    }
    // What was published at the end is visible after it.
    if let Some(own) = said.newest(now) {
        result.twin = Some(TwinSummary::of(&own.message));
    }
    Ok(result)
}

fn add_check<M: Message>(
    checks: &mut Vec<Box<dyn Check>>,
    recording: &Bus,
    bus: &Bus,
    topic: Topic<M>,
) -> Result<(), CreateError> {
    checks.push(Box::new(TypedCheck {
        topic: topic.name,
        recorded: recording.subscriber(topic, Depth::Queue(64))?,
        replayed: bus.subscriber(topic, Depth::Queue(64))?,
    }));
    Ok(())
}

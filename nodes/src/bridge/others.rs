//! What in a recording is not ours: topics that the table has not, of whatever type. They
//! go from the recording straight to ROS 2, as bytes.

use std::collections::BTreeSet;

use ferntast_bag::{BagReader, BagTopic, QosProfile};
use ferntast_bus::{Bus, OpenError, RawPublisher, RawTopic, ZenohBus, ZenohConfig, ZenohMode};
use ferntast_config::{GatewaySection, Middleware};
use ferntast_msgs::{
    Message, Time,
    interface::Library,
    sample::JointNames,
    topics::{self, JointNameError, Topic, Visitor},
};
use serde::Serialize;

use ferntast_lab::experiment::RECORD;

use super::gateway;

/// Topics of the table that other people's recordings have, too: they go as bytes there, since
/// what others say on them need not be what we can say.
const SHARED: [&str; 3] = ["/tf", "/diagnostics", "/robot_description"];
/// How many messages wait where the recording does not say.
const DEPTH: usize = 10;
/// Most that wait or are kept, whatever it says.
const MOST_DEPTH: usize = 1000;

/// A topic that is not played, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// The topic.
    pub topic: String,
    /// Its type.
    #[serde(rename = "type")]
    pub interface: String,
    /// Why.
    pub reason: String,
}

/// What becomes of the topics of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sorted {
    /// Those that go to ROS 2 as bytes.
    pub raw: Vec<RawTopic>,
    /// Those that are not played.
    pub left_out: Vec<LeftOut>,
}

impl Sorted {
    /// Whether the table does not play that topic.
    pub fn has(&self, name: &str) -> bool {
        let raw = self.raw.iter().any(|own| own.name == name);
        raw || self.left_out.iter().any(|own| own.topic == name)
    }
}

/// Whether `name`, of that type, is played by the table in a recording that is `ours` or not.
pub fn is_of_the_table(name: &str, ours: bool) -> bool {
    ours || !SHARED.contains(&name)
}

/// Whether a session made the recording.
pub fn is_ours(bag: &BagReader) -> bool {
    bag.metadata().contains_key(RECORD)
}

/// Sorts the topics of `bag`, but for those that are named in `except`, which live nodes publish.
///
/// # Errors
///
/// A joint whose name cannot be part of a topic's.
pub fn sort(
    bag: &BagReader,
    joints: &JointNames,
    except: &[String],
    middleware: Middleware,
) -> Result<Sorted, JointNameError> {
    let mut table = Table::default();
    topics::visit(joints, &mut table)?;
    let ours = is_ours(bag);
    let mut sorted = Sorted::default();
    let mut seen = BTreeSet::new();
    for topic in bag.topics() {
        let name = topic.name.as_str();
        let known = table
            .0
            .contains(&(name.to_owned(), topic.schema_name.clone()));
        let played = known && is_of_the_table(name, ours);
        if played || except.iter().any(|own| own == name) || !seen.insert(name) {
            continue;
        }
        match raw(topic, middleware) {
            Ok(own) => sorted.raw.push(own),
            Err(reason) => sorted.left_out.push(LeftOut {
                topic: name.to_owned(),
                interface: topic.schema_name.clone(),
                reason,
            }),
        }
    }
    Ok(sorted)
}

/// Names and types of the table's topics.
#[derive(Default)]
struct Table(BTreeSet<(String, String)>);

impl Visitor for Table {
    fn topic<M: Message>(&mut self, topic: Topic<M>) {
        use ferntast_msgs::RosMessage;
        self.0
            .insert((topic.name.to_string(), M::Ros::INTERFACE.to_owned()));
    }
}

/// The topic as it goes out; else why it cannot.
fn raw(topic: &BagTopic, middleware: Middleware) -> Result<RawTopic, String> {
    if topic.message_encoding != "cdr" {
        return Err(format!(
            "its messages are {:?}, and ROS 2 speaks cdr",
            topic.message_encoding
        ));
    }
    let is_message = topic.schema_name.split('/').nth(1) == Some("msg");
    if !is_message || topic.schema_name.split('/').count() != 3 {
        return Err(format!(
            "its type is {:?}, and a message's is package/msg/Type",
            topic.schema_name
        ));
    }
    if !is_name(&topic.name) {
        return Err(
            "ROS 2 has no topic of that name, or keeps it for services and actions".to_owned(),
        );
    }
    let type_hash = match topic.type_hash.is_empty() {
        true => hash_of(topic).unwrap_or_default(),
        false => topic.type_hash.clone(),
    };
    if middleware == Middleware::Zenoh && type_hash.is_empty() {
        return Err(
            "the recording tells no hash of its type, and its schema cannot be read".to_owned(),
        );
    }
    let offered = topic.offered_qos.iter();
    let any = |of: fn(&QosProfile) -> bool| offered.clone().any(of);
    let depth = topic.offered_qos.iter().map(|own| own.depth).max();
    Ok(RawTopic {
        name: topic.name.clone(),
        interface: topic.schema_name.clone(),
        type_hash,
        // Reliable goes to readers of either kind; who offered less is offered less.
        reliable: topic.offered_qos.is_empty() || any(|own| own.reliability != "best_effort"),
        transient_local: any(|own| own.durability == "transient_local"),
        depth: depth.map_or(DEPTH, |depth| (depth as usize).clamp(1, MOST_DEPTH)),
    })
}

/// Hash of the type by its schema, where that is one of `.msg` texts.
fn hash_of(topic: &BagTopic) -> Option<String> {
    if topic.schema_encoding != "ros2msg" {
        return None;
    }
    let library = Library::from_schema(&topic.schema_name, &topic.schema_text).ok()?;
    library.type_hash(&topic.schema_name).ok()
}

/// Whether ROS 2 takes the name: parts of letters, digits and _, none of them hidden.
fn is_name(name: &str) -> bool {
    let Some(parts) = name.strip_prefix('/') else {
        return false;
    };
    parts.split('/').all(|part| {
        let letters = part
            .bytes()
            .all(|own| own.is_ascii_alphanumeric() || own == b'_');
        letters && part.starts_with(|first: char| first.is_ascii_alphabetic())
    })
}

/// Joins ROS 2 beside the gateway.
///
/// # Errors
///
/// As [`gateway::open_ros`].
pub fn open_ros(section: &GatewaySection) -> Result<Bus, OpenError> {
    let node_name = format!("{}_player", section.node_name);
    match section.middleware {
        Middleware::Dds => gateway::open_ros(&GatewaySection {
            node_name,
            ..section.clone()
        }),
        // The gateway is the router.
        Middleware::Zenoh => Ok(Bus::Zenoh(ZenohBus::open(&ZenohConfig {
            mode: ZenohMode::Connect {
                endpoint: section.router_endpoint.clone(),
            },
            domain_id: section.domain_id,
            node_name,
            namespace: section.namespace.clone(),
        })?)),
    }
}

/// Plays such topics.
pub struct Others {
    publishers: Vec<(String, RawPublisher)>,
    bag: BagReader,
    waiting: Option<Waiting>,
}

type Waiting = ferntast_bag::RawMessages;

impl Others {
    /// Of `bag`, over `ros`.
    ///
    /// # Errors
    ///
    /// A publisher that cannot be had.
    pub fn new(
        bag: BagReader,
        ros: &Bus,
        topics: &[RawTopic],
    ) -> Result<Others, ferntast_bus::CreateError> {
        let mut publishers = Vec::new();
        for topic in topics {
            publishers.push((topic.name.clone(), ros.raw_publisher(topic)?));
        }
        Ok(Others {
            publishers,
            bag,
            waiting: None,
        })
    }

    /// Begins at the recording's start.
    pub fn begin(&mut self) {
        let names: Vec<&str> = self
            .publishers
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        // All of them are the recording's.
        self.waiting = self.bag.raw_topics(&names, Time::from_nanos(0)).ok();
    }

    /// Publishes what was recorded before `at`; gives the number of messages that could not be.
    pub fn publish(&mut self, at: Time) -> u64 {
        let Others {
            publishers,
            waiting,
            ..
        } = self;
        let Some(waiting) = waiting else {
            return 0;
        };
        let mut failed = 0;
        while waiting.peek().is_some_and(|time| time < at) {
            let sent = match waiting.next() {
                Some(Ok(message)) => {
                    let own = publishers
                        .iter_mut()
                        .find(|(name, _)| *name == message.topic.name);
                    own.is_some_and(|(_, publisher)| publisher.publish(message.bytes()).is_ok())
                }
                // Told by what says what the recording holds.
                Some(Err(_)) => true,
                None => break,
            };
            failed += u64::from(!sent);
        }
        failed
    }
}

//! ROS 2 over DDS, as every stock ROS 2 speaks it (ros2-client on RustDDS).
//!
//! One participant and one node a bus. Messages go in their ROS 2 form; what
//! comes in is bounded, decoded, and checked before it is handed out.

mod encoded;
mod publisher;
mod qos;
mod raw;
mod senders;
mod subscriber;
mod writer;

use std::{
    fmt,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use ferntast_msgs::{Message, RosMessage, topics::Topic};
use ros2_client::{
    Context, ContextOptions, MessageTypeName, Name, Node, NodeName, NodeOptions,
    dds::rustdds::{self, DomainParticipant},
};

pub use publisher::DdsPublisher;
pub(crate) use qos::service_qos;
pub use raw::RawDdsPublisher;
pub use subscriber::DdsSubscriber;

use crate::{
    error::{CreateError, OpenError},
    namespace::within,
    types::Depth,
};

/// Highest domain for which DDS has port numbers.
pub const MAX_DOMAIN: u32 = 232;
/// Longest queue of a subscriber.
const MAX_QUEUE: usize = 1024;

/// Where on ROS 2 to appear.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DdsConfig {
    /// ROS domain, 0 to 232.
    pub domain_id: u32,
    /// Name of the node, without namespace.
    pub node_name: String,
    /// Namespace of the node, its topics and services: `/` or `/some/space`.
    pub namespace: String,
}

/// The bus on ROS 2 over DDS. A clone is another handle to the same node.
#[derive(Clone)]
pub struct DdsBus {
    node: Arc<Mutex<Node>>,
    context: Context,
    participant: DomainParticipant,
}

impl DdsBus {
    /// Joins the domain as a node of that name.
    ///
    /// # Errors
    ///
    /// [`OpenError::DomainOutOfRange`], [`OpenError::BadName`], [`OpenError::Middleware`].
    pub fn open(config: &DdsConfig) -> Result<DdsBus, OpenError> {
        let domain_id = config.domain_id;
        let out_of_range = OpenError::DomainOutOfRange { domain_id };
        if domain_id > MAX_DOMAIN {
            return Err(out_of_range);
        }
        let name = NodeName::new(&config.namespace, &config.node_name).map_err(|error| {
            OpenError::BadName {
                what: "node",
                name: format!("{} in {}", config.node_name, config.namespace),
                reason: format!("{error:?}"),
            }
        })?;
        let middleware = |reason: String| OpenError::Middleware {
            transport: "DDS",
            reason: format!("domain {domain_id}: {reason}"),
        };
        let domain = u16::try_from(domain_id).map_err(|_| out_of_range)?;
        let context = Context::with_options(ContextOptions::new().domain_id(domain))
            .map_err(|error| middleware(error.to_string()))?;
        let options = NodeOptions::new().enable_rosout(false);
        let node = context
            .new_node(name, options)
            .map_err(|error| middleware(format!("{error:?}")))?;
        Ok(DdsBus {
            node: Arc::new(Mutex::new(node)),
            participant: context.domain_participant(),
            context,
        })
    }

    /// A publisher on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError::Middleware`].
    pub fn publisher<M: Message>(&self, topic: Topic<M>) -> Result<DdsPublisher<M>, CreateError> {
        DdsPublisher::create(self, topic)
    }

    /// A subscriber on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError::BadDepth`], [`CreateError::Middleware`].
    pub fn subscriber<M: Message>(
        &self,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<DdsSubscriber<M>, CreateError> {
        DdsSubscriber::create(self, topic, depth)
    }

    /// The topics of others that discovery has found so far, each with its
    /// type as DDS names it.
    pub fn topics_seen(&self) -> Vec<(String, String)> {
        let writers = self.participant.discovered_writers().into_iter();
        let readers = self.participant.discovered_readers().into_iter();
        let written = writers.map(|own| {
            let data = own.publication_topic_data;
            (data.topic_name, data.type_name)
        });
        let read = readers.map(|own| {
            let data = own.subscription_topic_data;
            (data.topic_name().clone(), data.type_name().clone())
        });
        let mut topics: Vec<(String, String)> = written
            .chain(read)
            // ROS 2 marks its topics so; the rest are services and discovery.
            .filter_map(|(name, kind)| Some((format!("/{}", name.strip_prefix("rt/")?), kind)))
            .collect();
        topics.sort();
        topics.dedup();
        topics
    }

    /// For further nodes of this participant.
    pub(crate) fn context(&self) -> &Context {
        &self.context
    }

    /// For services of this bus's node.
    pub(crate) fn node(&self) -> MutexGuard<'_, Node> {
        self.node.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for DdsBus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DdsBus")
            .field("node", &self.node().fully_qualified_name())
            .finish_non_exhaustive()
    }
}

/// The topic as the node creates it.
fn create_topic<M: Message>(
    node: &Node,
    topic: Topic<M>,
    qos: &ros2_client::QosProfile,
    what: &'static str,
) -> Result<rustdds::Topic, CreateError> {
    let name = Name::parse(&within(node.namespace(), &topic.name))
        .map_err(|error| middleware(&topic.name, what, format!("{error:?}")))?;
    node.create_topic(&name, type_name::<M>(), qos)
        .map_err(|error| middleware(&topic.name, what, error.to_string()))
}

/// The topic's ROS 2 type, as DDS names it.
fn type_name<M: Message>() -> MessageTypeName {
    let interface = M::Ros::INTERFACE;
    let (package, kind) = interface.split_once("/msg/").unwrap_or(("", interface));
    MessageTypeName::new(package, kind)
}

fn middleware(topic: &str, what: &'static str, reason: String) -> CreateError {
    CreateError::Middleware {
        transport: "DDS",
        topic: topic.into(),
        what,
        reason,
    }
}

//! ROS 2 over Zenoh, wire-compatible with rmw_zenoh (hiroz).
//!
//! Keys carry the true RIHS01 type hash, so that endpoints of unlike types
//! never meet. One process of a session is the router that rmw_zenoh's nodes
//! connect to; all others connect to it.

mod publisher;
mod qos;
mod raw;
mod raw_publisher;
mod router;
mod session;
mod subscriber;

use std::{fmt, path::PathBuf, sync::Arc};

use ferntast_msgs::{Message, topics::Topic};
use hiroz::{context::ZContext, node::ZNode};

pub use publisher::ZenohPublisher;
pub use raw_publisher::RawZenohPublisher;
pub use subscriber::ZenohSubscriber;

use crate::{
    error::{CreateError, OpenError},
    types::Depth,
};

/// Longest queue of a subscriber.
const MAX_QUEUE: usize = 1024;

/// How a process takes part in Zenoh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ZenohMode {
    /// As the router, inside this process.
    Router {
        /// Where to listen, `tcp/HOST:PORT`; rmw_zenoh looks at `tcp/localhost:7447`.
        listen: String,
    },
    /// As the router, inside this process, set up by a file as rmw_zenoh's router takes
    /// it: TLS, access control, where to listen.
    RouterOf {
        /// The file, in Zenoh's own format.
        config: PathBuf,
    },
    /// Connected to a router that runs.
    Connect {
        /// Where the router listens, `tcp/HOST:PORT`.
        endpoint: String,
    },
}

/// Where on ROS 2 to appear.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ZenohConfig {
    /// Router or connected to one.
    pub mode: ZenohMode,
    /// ROS domain, 0 to 232 (as on DDS, so that a session can change over).
    pub domain_id: u32,
    /// Name of the node, without namespace.
    pub node_name: String,
    /// Namespace of the node, its topics and services: `/` or `/some/space`.
    pub namespace: String,
}

/// The bus on ROS 2 over Zenoh. A clone is another handle to the same node.
#[derive(Clone)]
pub struct ZenohBus {
    node: Arc<ZNode>,
    context: Arc<ZContext>,
    namespace: Arc<str>,
}

impl ZenohBus {
    /// Joins the domain as a node of that name.
    ///
    /// # Errors
    ///
    /// [`OpenError::PortTaken`], [`OpenError::Unreachable`] after 3 s,
    /// [`OpenError::BadEndpoint`], [`OpenError::DomainOutOfRange`],
    /// [`OpenError::BadName`], [`OpenError::RouterConfig`], [`OpenError::Middleware`].
    pub fn open(config: &ZenohConfig) -> Result<ZenohBus, OpenError> {
        let (context, node) = session::open(config)?;
        Ok(ZenohBus {
            node: Arc::new(node),
            context: Arc::new(context),
            namespace: config.namespace.as_str().into(),
        })
    }

    /// Where a router of that mode lets in whoever comes from another host, without TLS
    /// that asks for a certificate; `None` where it lets in nobody so.
    ///
    /// # Errors
    ///
    /// As [`ZenohBus::open`], of a mode that cannot be used.
    pub fn unprotected(mode: &ZenohMode) -> Result<Option<String>, OpenError> {
        Ok(router::unprotected(&session::settings(mode)?))
    }

    /// For further nodes of this session.
    pub(crate) fn context(&self) -> &ZContext {
        &self.context
    }

    /// Where its topics and services are.
    pub(crate) fn namespace(&self) -> &str {
        &self.namespace
    }

    /// For services of this bus's node.
    pub(crate) fn node(&self) -> &ZNode {
        &self.node
    }

    /// The topics that discovery has found so far, each with its type.
    pub fn topics_seen(&self) -> Vec<(String, String)> {
        self.context.graph().get_topic_names_and_types()
    }

    /// A publisher on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError::Middleware`].
    pub fn publisher<M: Message>(&self, topic: Topic<M>) -> Result<ZenohPublisher<M>, CreateError> {
        ZenohPublisher::create(self, topic)
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
    ) -> Result<ZenohSubscriber<M>, CreateError> {
        ZenohSubscriber::create(self, topic, depth)
    }
}

impl fmt::Debug for ZenohBus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ZenohBus")
            .field("node", &self.node.name())
            .finish_non_exhaustive()
    }
}

fn middleware(topic: &str, what: &'static str, reason: String) -> CreateError {
    CreateError::Middleware {
        transport: "Zenoh",
        topic: topic.into(),
        what,
        reason,
    }
}

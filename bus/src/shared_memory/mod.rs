//! Between processes of one host, over iceoryx2's shared memory.
//!
//! Samples cross as they are. A full queue drops its oldest message and the
//! publisher never waits. Each session has a prefix and a directory of its
//! own, so that two sessions on one host do not meet.

mod free_memory;
mod late_joiners;
mod payload;
mod publisher;
mod service;
mod session;
mod subscriber;

use std::{fmt, sync::Arc};

use ferntast_msgs::{
    Message,
    topics::{Delivery, EVENT_QUEUE, Topic},
};
use iceoryx2::{
    config::Config,
    node::{NodeBuilder, NodeCreationFailure},
    prelude::{
        LogLevel, Node, NodeName, SignalHandlingMode, ipc_threadsafe, set_log_level_from_env_or,
    },
};

pub use publisher::SharedMemoryPublisher;
pub use subscriber::SharedMemorySubscriber;

use crate::{
    error::{CleanUpError, CreateError, OpenError},
    types::Depth,
};
use late_joiners::ConnectionUpdater;

/// iceoryx2's service variant: ports may move between threads.
type Service = ipc_threadsafe::Service;

/// Publishers on one topic at most (every node is one on `/diagnostics`).
const MAX_PUBLISHERS: usize = 16;
/// Subscribers on one topic at most.
const MAX_SUBSCRIBERS: usize = 12;
/// Processes on one topic at most.
const MAX_PROCESSES: usize = 24;
/// Longest queue on a stream: half a second at 1 kHz.
const STREAM_QUEUE: usize = 512;

/// Which session's shared memory to use.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharedMemoryConfig {
    /// The session: 1 to 48 of a-z, A-Z, 0-9, `-` and `_`.
    pub session: String,
}

/// The bus in shared memory. A clone is another handle to the same bus.
#[derive(Clone)]
pub struct SharedMemoryBus {
    session: String,
    node: Arc<Node<Service>>,
    connections: Arc<ConnectionUpdater>,
}

impl SharedMemoryBus {
    /// Joins the session, the first process as well as every further one.
    /// Removes what dead processes left in it. Installs no signal handlers.
    ///
    /// # Errors
    ///
    /// [`OpenError::BadName`], [`OpenError::NoPermission`],
    /// [`OpenError::NoRoom`], [`OpenError::Middleware`].
    pub fn open(config: &SharedMemoryConfig) -> Result<SharedMemoryBus, OpenError> {
        let session = &config.session;
        let settings = session::config(session)?;
        session::check_access(session)?;
        let bus = SharedMemoryBus::join(session, &settings, "member")?;
        session::remove_dead(&settings);
        Ok(bus)
    }

    /// Joins a session that others run, to look or to give a word. A visitor
    /// is in nobody's way: it does not count for [`SharedMemoryBus::clean_up`],
    /// and leaves the dead to the members. `None` where there is no session.
    ///
    /// # Errors
    ///
    /// As [`SharedMemoryBus::open`].
    pub fn visit(session: &str) -> Result<Option<SharedMemoryBus>, OpenError> {
        let settings = session::config(session)?;
        session::check_access(session)?;
        match session::is_there(session) {
            true => SharedMemoryBus::join(session, &settings, session::VISITOR).map(Some),
            false => Ok(None),
        }
    }

    fn join(session: &str, settings: &Config, role: &str) -> Result<SharedMemoryBus, OpenError> {
        // iceoryx2 logs to stderr; its errors come back as ours, so of its
        // own accord only what it considers fatal is worth a line.
        set_log_level_from_env_or(LogLevel::Fatal);
        free_memory::check_for_session()?;
        let role = NodeName::new(role).map_err(|error| OpenError::Middleware {
            transport: "shared memory",
            reason: format!("{role:?} is no name of a node: {error}"),
        })?;
        let node = NodeBuilder::new()
            .name(&role)
            .config(settings)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Service>()
            .map_err(|failure| match failure {
                NodeCreationFailure::InsufficientPermissions => OpenError::NoPermission {
                    path: session::directory(session),
                    reason: failure.to_string(),
                },
                _ => OpenError::Middleware {
                    transport: "shared memory",
                    reason: format!(
                        "session {session:?}: {failure}; is {} writable and the disk not full?",
                        session::directory(session)
                    ),
                },
            })?;
        Ok(SharedMemoryBus {
            session: session.to_owned(),
            node: Arc::new(node),
            connections: Arc::new(ConnectionUpdater::default()),
        })
    }

    /// All sessions on this host, in use or left behind ([`SharedMemoryBus::processes`] tells which).
    pub fn sessions() -> Vec<String> {
        session::sessions()
    }

    /// The processes that are in the session now, by id; empty when it is not
    /// in use. The calling process counts when it has joined.
    ///
    /// # Errors
    ///
    /// [`OpenError::BadName`], [`OpenError::NoPermission`], [`OpenError::Middleware`].
    pub fn processes(session: &str) -> Result<Vec<u32>, OpenError> {
        session::processes(session)
    }

    /// The same without visitors ([`SharedMemoryBus::visit`]).
    ///
    /// # Errors
    ///
    /// As [`SharedMemoryBus::processes`].
    pub fn members(session: &str) -> Result<Vec<u32>, OpenError> {
        session::members(session)
    }

    /// Removes everything that a dead session left in shared memory and in
    /// its directory; the number of segments and files removed. While visitors
    /// are in it nothing is.
    ///
    /// # Errors
    ///
    /// [`CleanUpError::InUse`] when a member of the session lives; nothing is removed then.
    pub fn clean_up(session: &str) -> Result<usize, CleanUpError> {
        session::clean_up(session)
    }

    /// The session's name.
    pub fn session(&self) -> &str {
        &self.session
    }

    /// A publisher on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError`].
    pub fn publisher<M: Message>(
        &self,
        topic: Topic<M>,
    ) -> Result<SharedMemoryPublisher<M>, CreateError> {
        SharedMemoryPublisher::create(self, topic)
    }

    /// A subscriber on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError`].
    pub fn subscriber<M: Message>(
        &self,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<SharedMemorySubscriber<M>, CreateError> {
        SharedMemorySubscriber::create(self, topic, depth)
    }

    /// Longest queue of a subscriber on a topic of that delivery.
    pub const fn max_queue(delivery: Delivery) -> usize {
        match delivery {
            Delivery::Stream => STREAM_QUEUE,
            Delivery::State | Delivery::Event => EVENT_QUEUE,
        }
    }
}

impl fmt::Debug for SharedMemoryBus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SharedMemoryBus")
            .field("session", &self.session)
            .finish_non_exhaustive()
    }
}

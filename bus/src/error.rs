//! What can go wrong: one enum an operation.

use std::path::PathBuf;

use ferntast_msgs::{
    cdr::EncodeError,
    topics::{JointNameError, TopicName},
};

/// Why a bus cannot be opened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenError {
    /// Something else listens on the port.
    #[error(
        "{endpoint} is taken: {reason}; stop what listens there (`ss -ltnp` names it) or choose another port"
    )]
    PortTaken {
        /// The endpoint that was to be listened on, `tcp/HOST:PORT`.
        endpoint: String,
        /// What the system said.
        reason: String,
    },
    /// Nobody answers at the endpoint.
    #[error(
        "no Zenoh router answers at {endpoint} ({reason}); start one there (`ferntast session` does) or correct the endpoint"
    )]
    Unreachable {
        /// The endpoint that was to be connected to, `tcp/HOST:PORT`.
        endpoint: String,
        /// What the library said.
        reason: String,
    },
    /// An endpoint that Zenoh cannot read.
    #[error(
        "{endpoint:?} is no endpoint: {reason}; write tcp/HOST:PORT, for example tcp/127.0.0.1:7447"
    )]
    BadEndpoint {
        /// What was given.
        endpoint: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The link would leave this host with nothing that keeps strangers out of it.
    #[error(
        "the link's endpoint {endpoint} leaves this host without TLS; write {instead} at both ends, or \
         sealed-udp/HOST:PORT where a long way loses frames (docs/who_may_do_what.md; keys: 'ferntast link keys --help')"
    )]
    Unprotected {
        /// What was given.
        endpoint: String,
        /// What to write in place of it.
        instead: String,
    },
    /// A file that is no configuration of a Zenoh router.
    #[error(
        "{path}: no configuration of a Zenoh router: {reason}; begin with the one that rmw_zenoh ships, \
         DEFAULT_RMW_ZENOH_ROUTER_CONFIG.json5", path = path.display()
    )]
    RouterConfig {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// TLS over TCP, which Zenoh cannot do both ways at once.
    #[error(
        "the link does not go over {endpoint}: where frames go both ways Zenoh's TLS over TCP ends the process by a bad \
         access (eclipse-zenoh/zenoh#2557); write {instead}, TLS within QUIC"
    )]
    TlsStream {
        /// What was given.
        endpoint: String,
        /// What to write in place of it.
        instead: String,
    },
    /// TLS is asked for, and there is no key, or nobody is known.
    #[error(
        "{endpoint} is met over TLS, and this end has no key for it, or knows nobody: 'ferntast link keys --help' says how"
    )]
    NoCertificate {
        /// The endpoint.
        endpoint: String,
    },
    /// An address that others could reach, where nothing asks who they are.
    #[error(
        "Foxglove is not served at {address}: its protocol knows no password; serve it at \
         127.0.0.1:{} and reach it from afar through `ssh -L {}:127.0.0.1:{} HOST`",
        address.port(), address.port(), address.port()
    )]
    NotLoopback {
        /// The address asked for.
        address: std::net::SocketAddr,
    },
    /// The ROS domain is outside 0 to 232.
    #[error(
        "ROS domain {domain_id} is outside 0..=232, where DDS has ports; set ROS_DOMAIN_ID to one of those"
    )]
    DomainOutOfRange {
        /// The domain asked for.
        domain_id: u32,
    },
    /// A name that the middleware does not take.
    #[error("{what} {name:?} is not usable: {reason}")]
    BadName {
        /// What the name is for: session, node, namespace.
        what: &'static str,
        /// The name given.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// No permission to use the directory or shared memory.
    #[error(
        "no permission for shared memory at {path} ({reason}); run as the user who started the session, or correct the directory's owner"
    )]
    NoPermission {
        /// The directory or segment.
        path: String,
        /// What the system said.
        reason: String,
    },
    /// Shared memory or disk is full.
    #[error(
        "no room in shared memory at {path} ({reason}); see `df -h /dev/shm`, and `ferntast doctor` for segments of dead sessions"
    )]
    NoRoom {
        /// The directory or segment.
        path: String,
        /// What the system said.
        reason: String,
    },
    /// Anything else, in the library's words.
    #[error("cannot open {transport}: {reason}")]
    Middleware {
        /// Which way across.
        transport: &'static str,
        /// What the library said.
        reason: String,
    },
}

/// Why a publisher or a subscriber cannot be created.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CreateError {
    /// The topic exists with another type.
    #[error("{topic} carries {found}, not {wanted}: use the topic's own type, or another name")]
    WrongType {
        /// The topic.
        topic: String,
        /// The type asked for.
        wanted: String,
        /// The type of the topic.
        found: String,
    },
    /// All places on the topic are taken.
    #[error(
        "{topic} has no place left for another {what} (at most {limit}); stop one of them, or another session of that name"
    )]
    TooMany {
        /// The topic.
        topic: String,
        /// Publisher, subscriber or node.
        what: &'static str,
        /// How many there may be.
        limit: usize,
    },
    /// A queue without a place, or longer than the bus allows.
    #[error("a queue of {depth} on {topic} is not possible: choose 1 to {limit}")]
    BadDepth {
        /// The topic.
        topic: String,
        /// The depth asked for.
        depth: usize,
        /// The longest queue.
        limit: usize,
    },
    /// The recording has no such topic, or cannot take one.
    #[error("{topic} cannot be used in the recording: {reason}")]
    Recording {
        /// The topic.
        topic: String,
        /// Why not.
        reason: String,
    },
    /// Only publishers are possible there.
    #[error("{topic} cannot be read from Foxglove, which only watches: publish on ROS 2 instead")]
    OneWay {
        /// The topic.
        topic: String,
    },
    /// A sample that is not among those that can be sent.
    #[error("{topic} cannot carry {sample}: no row of msgs/src/topics/mod.rs has it")]
    NoSample {
        /// The topic.
        topic: String,
        /// Its sample.
        sample: String,
    },
    /// A joint whose name cannot be part of a topic's.
    #[error(transparent)]
    Joint(#[from] JointNameError),
    /// No permission to use the topic's shared memory.
    #[error(
        "no permission for the shared memory of {topic} ({reason}); run as the user who started the session"
    )]
    NoPermission {
        /// The topic.
        topic: String,
        /// What the library said.
        reason: String,
    },
    /// Shared memory is full.
    #[error(
        "no room in shared memory for {topic} ({reason}); see `df -h /dev/shm`, and `ferntast doctor` for segments of dead sessions"
    )]
    NoRoom {
        /// The topic.
        topic: String,
        /// What the library said.
        reason: String,
    },
    /// Anything else, in the library's words.
    #[error("cannot create a {what} on {topic} over {transport}: {reason}")]
    Middleware {
        /// Which way across.
        transport: &'static str,
        /// The topic.
        topic: String,
        /// Publisher or subscriber.
        what: &'static str,
        /// What the library said.
        reason: String,
    },
}

/// Why bytes were not published.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RawPublishError {
    /// More than is sent in one message.
    #[error("the message has {length} bytes, more than {limit}")]
    TooLong {
        /// Bytes given.
        length: usize,
        /// Most bytes.
        limit: usize,
    },
    /// Not what ROS 2 writes.
    #[error("the message is no CDR in little endian")]
    Encoding,
    /// Anything else, in the library's words.
    #[error("it cannot be sent over {transport}: {reason}")]
    Middleware {
        /// The way across.
        transport: &'static str,
        /// What the library said.
        reason: String,
    },
}

/// Why a message was not published.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PublishError {
    /// The message does not go into CDR.
    #[error("{topic}: {source}")]
    Encode {
        /// The topic.
        topic: TopicName,
        /// What is wrong.
        source: EncodeError,
    },
    /// No free place in shared memory at this moment.
    #[error("{topic}: no free place in shared memory: {reason}")]
    NoPlace {
        /// The topic.
        topic: TopicName,
        /// What the library said.
        reason: String,
    },
    /// A bus in memory that was told to refuse.
    #[error("the bus in memory was told to refuse every message")]
    Refused,
    /// The recording cannot be written.
    #[error("{topic} cannot be recorded: {reason}")]
    Recording {
        /// The topic.
        topic: TopicName,
        /// What the system said.
        reason: String,
    },
    /// Anything else, in the library's words.
    #[error("{topic} cannot be sent over {transport}: {reason}")]
    Middleware {
        /// Which way across.
        transport: &'static str,
        /// The topic.
        topic: TopicName,
        /// What the library said.
        reason: String,
    },
}

/// Why what a dead session left in shared memory cannot be removed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CleanUpError {
    /// The session is alive.
    #[error(
        "session {session:?} is in use by process {}; stop it first, or choose another session name",
        processes.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
    )]
    InUse {
        /// The session.
        session: String,
        /// Its live processes.
        processes: Vec<u32>,
    },
    /// A session name that cannot be used.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The directory cannot be read or emptied.
    #[error("cannot clean up {path}: {reason}")]
    Directory {
        /// Where.
        path: String,
        /// What the system said.
        reason: String,
    },
}

/// Why a frame was not sent.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SendError {
    /// Longer than [`crate::frames::MAX_FRAME`].
    #[error("a frame of {length} bytes is longer than the {limit} allowed")]
    TooLong {
        /// Bytes given.
        length: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// Anything else, in the library's words.
    #[error("cannot send on {link}: {reason}")]
    Middleware {
        /// The link's key.
        link: String,
        /// What the library said.
        reason: String,
    },
}

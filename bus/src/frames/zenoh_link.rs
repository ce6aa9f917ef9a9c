//! The link between two hosts, over a Zenoh session of its own.
//!
//! One end listens on a port, the other connects, and connects again by itself
//! whenever the connection breaks. Nothing scouts, nothing is batched, and what
//! does not get through is dropped.
//!
//! Beyond this host frames go as datagrams of QUIC (`quic/…`), within TLS 1.3 to which
//! both ends show certificates ([`LinkTls`]); a frame that is lost stays lost, which the
//! delay laws are made for. On the loopback it may be plain UDP (`udp/…`), or TCP
//! (`tcp/…`), where what is lost would be sent again and hold up all frames behind it.

use std::{fmt, sync::Arc};

use ferntast_msgs::Time;
use zenoh::{
    Session, Wait,
    bytes::ZBytes,
    pubsub::{Publisher, Subscriber},
    qos::{CongestionControl, Priority},
};

use super::{
    FrameReceiver, FrameSender, MAX_FRAME, SenderKind,
    door::Door,
    queue::Queue,
    tls::{self, LinkTls},
};
use crate::{
    endpoint,
    error::{OpenError, SendError},
    zenoh_words::words,
};

/// Gives the time of arrival; called where Zenoh receives.
pub type Clock = Arc<dyn Fn() -> Time + Send + Sync>;

/// Environment of a process whose only use of Zenoh is one end of a link: one thread of
/// Zenoh's does all that there is to do.
///
/// Left to itself Zenoh has five, three of which a single frame wakes one after the other:
/// the one that hears of the socket, the one that reads, and one more that might have.
/// That costs more than the frame and comes before it is heard. Zenoh reads this when its
/// first session is opened.
pub const ONE_THREAD: (&str, &str) = (
    "ZENOH_RUNTIME",
    "(rx: (handover: net), tx: (handover: net), acc: (handover: net), app: (handover: net))",
);

/// Which way a frame goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkDirection {
    /// From the operator to the arm: motion.
    Forward,
    /// From the arm to the operator: force.
    Back,
}

impl LinkDirection {
    /// The other way.
    pub const fn opposite(self) -> LinkDirection {
        match self {
            LinkDirection::Forward => LinkDirection::Back,
            LinkDirection::Back => LinkDirection::Forward,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            LinkDirection::Forward => "forward",
            LinkDirection::Back => "back",
        }
    }
}

/// What an end does to meet the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkEndpoint {
    /// Listens on `quic/HOST:PORT`, on the loopback also on `tcp/…` and `udp/…`.
    Listen(String),
    /// Connects to one of those, again and again until it succeeds.
    Connect(String),
}

/// One end of a link.
#[derive(Clone)]
pub struct ZenohLinkConfig {
    /// The session: 1 to 48 of a-z, A-Z, 0-9, `-` and `_`; the same at both ends.
    pub session: String,
    /// How to meet the other end.
    pub endpoint: LinkEndpoint,
    /// The way that this end sends.
    pub sends: LinkDirection,
    /// By what it is known and whom it trusts; over QUIC there has to be some.
    pub tls: Option<LinkTls>,
    /// Gives the time of arrival.
    pub clock: Clock,
}

/// One end of a link, open: its sender and its receiver.
#[derive(Debug)]
pub struct ZenohLink {
    /// Sends the way that was configured.
    pub sender: FrameSender,
    /// Receives from the other way.
    pub receiver: FrameReceiver,
    /// Who did not come in.
    pub door: Door,
}

impl ZenohLink {
    /// Opens one end. The connecting end need not find the other; frames go
    /// through as soon as it does. The link stays open as long as the sender lives.
    ///
    /// # Errors
    ///
    /// [`OpenError::PortTaken`], [`OpenError::BadEndpoint`],
    /// [`OpenError::Unprotected`], [`OpenError::NoCertificate`],
    /// [`OpenError::BadName`], [`OpenError::Middleware`].
    pub fn open(config: ZenohLinkConfig) -> Result<ZenohLink, OpenError> {
        check_session(&config.session)?;
        let (LinkEndpoint::Listen(endpoint) | LinkEndpoint::Connect(endpoint)) = &config.endpoint;
        endpoint::check_link(endpoint)?;
        if matches!(config.endpoint, LinkEndpoint::Connect(_)) {
            endpoint::check_server(&endpoint::to_connect_to(endpoint))?;
        }
        let settings = settings(&config)?;
        let door = Door::of_process();
        let session = zenoh::open(settings)
            .wait()
            .map_err(|error| endpoint::open_error(endpoint, "the link", &error))?;

        let queue = Arc::new(Queue::new());
        let (arrivals, clock) = (queue.clone(), config.clock.clone());
        let subscriber = session
            .declare_subscriber(key(&config.session, config.sends.opposite()))
            .callback(move |sample| receive(&arrivals, clock(), sample.payload()))
            .wait()
            .map_err(middleware)?;
        let key = key(&config.session, config.sends);
        let publisher = session
            .declare_publisher(key.clone())
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::RealTime)
            .express(true)
            .wait()
            .map_err(middleware)?;
        Ok(ZenohLink {
            sender: FrameSender(SenderKind::Zenoh(ZenohFrameSender {
                key,
                publisher,
                _subscriber: subscriber,
                _session: session,
            })),
            receiver: FrameReceiver {
                queue,
                in_virtual_time: false,
            },
            door,
        })
    }
}

/// Sends frames over Zenoh.
pub(super) struct ZenohFrameSender {
    key: String,
    publisher: Publisher<'static>,
    _subscriber: Subscriber<()>,
    _session: Session,
}

impl ZenohFrameSender {
    pub(super) fn send(&mut self, frame: &[u8]) -> Result<(), SendError> {
        self.publisher
            .put(frame)
            .wait()
            .map_err(|error| SendError::Middleware {
                link: self.key.clone(),
                reason: words(error),
            })
    }
}

impl fmt::Debug for ZenohFrameSender {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ZenohFrameSender")
            .field("key", &self.key)
            .finish_non_exhaustive()
    }
}

fn receive(queue: &Queue, arrived: Time, payload: &ZBytes) {
    let mut frame = [0; MAX_FRAME];
    let mut length = 0;
    // No more is looked at than a frame has, however long the payload is.
    for slice in payload.slices() {
        let taken = slice.len().min(MAX_FRAME - length);
        frame[length..length + taken].copy_from_slice(&slice[..taken]);
        length += taken;
    }
    queue.push(arrived, &frame[..length]);
}

fn key(session: &str, direction: LinkDirection) -> String {
    format!("ferntast/{session}/link/{}", direction.name())
}

fn settings(link: &ZenohLinkConfig) -> Result<zenoh::Config, OpenError> {
    let (LinkEndpoint::Listen(endpoint) | LinkEndpoint::Connect(endpoint)) = &link.endpoint;
    let protected = endpoint::is_protected(endpoint);
    let tls = link.tls.as_ref().filter(|_| protected);
    if protected && tls.is_none_or(|own| own.known.is_empty()) {
        return Err(OpenError::NoCertificate {
            endpoint: endpoint.clone(),
        });
    }
    let certificates = tls.map(tls::settings).transpose();
    let certificates = certificates.map_err(|error| OpenError::Middleware {
        transport: "the link",
        reason: format!("no certificate can be made of the key: {error}"),
    })?;
    let [sends, receives] = [link.sends, link.sends.opposite()].map(|way| key(&link.session, way));
    let access = tls::access(tls, &sends, &receives);
    zenoh_settings(&link.endpoint, certificates, &access).map_err(middleware)
}

fn zenoh_settings(
    endpoint: &LinkEndpoint,
    certificates: Option<serde_json::Value>,
    access: &serde_json::Value,
) -> Result<zenoh::Config, zenoh::Error> {
    let mut config = zenoh::Config::default();
    let mut set = |key: &str, value: &str| config.insert_json5(key, value);
    if let Some(certificates) = certificates {
        set("transport/link/tls", &certificates.to_string())?;
    }
    set("access_control", &access.to_string())?;
    // What a peer may cost, known or not.
    set("transport/unicast/max_sessions", "8")?;
    set("transport/unicast/accept_pending", "16")?;
    set("transport/unicast/accept_timeout", "5000")?;
    set("transport/link/rx/max_message_size", "2097152")?;
    set("mode", r#""peer""#)?;
    set("scouting/multicast/enabled", "false")?;
    set("scouting/gossip/enabled", "false")?;
    // A dead connection is given up, and a new one tried, after 2 s instead of 10 s.
    set("transport/link/tx/lease", "2000")?;
    match endpoint {
        LinkEndpoint::Listen(endpoint) => {
            let endpoint = endpoint::of_zenoh(endpoint);
            set("listen/endpoints", &format!("[{endpoint:?}]"))?;
            set("listen/exit_on_failure", "true")?;
            set("listen/timeout_ms", "0")?;
        }
        LinkEndpoint::Connect(endpoint) => {
            let endpoint = endpoint::of_zenoh(&endpoint::to_connect_to(endpoint));
            set("listen/endpoints", "[]")?;
            set("connect/endpoints", &format!("[{endpoint:?}]"))?;
            set("connect/exit_on_failure", "false")?;
            set("connect/timeout_ms", "-1")?;
            set(
                "connect/retry",
                "{ period_init_ms: 200, period_max_ms: 1000, period_increase_factor: 2 }",
            )?;
        }
    }
    Ok(config)
}

fn check_session(session: &str) -> Result<(), OpenError> {
    let allowed = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    if session.is_empty() || session.len() > 48 || !session.bytes().all(allowed) {
        return Err(OpenError::BadName {
            what: "session",
            name: session.into(),
            reason: "use 1 to 48 of a-z, A-Z, 0-9, - and _".into(),
        });
    }
    Ok(())
}

fn middleware(error: zenoh::Error) -> OpenError {
    OpenError::Middleware {
        transport: "the link",
        reason: words(error),
    }
}

//! To Foxglove and Lichtblick over a WebSocket: one way, for watching.
//!
//! Messages and schemas are those of ROS 2 and of recordings (`cdr`,
//! `ros2msg`), so that a layout made for the one shows the others. Clients can
//! subscribe and nothing else. The protocol knows no password, so that only
//! loopback addresses are listened at.

mod last;
mod publisher;

pub use publisher::FoxglovePublisher;

use std::{fmt, io::ErrorKind, net::SocketAddr, sync::Arc};

use ferntast_msgs::{Message, topics::Topic};
use foxglove::{Context, FoxgloveError, WebSocketServer, WebSocketServerHandle};

use self::last::LastMessages;
use crate::error::{CreateError, OpenError};

/// How a WebSocket for Foxglove is served.
#[derive(Clone, Debug, PartialEq)]
pub struct FoxgloveConfig {
    /// Where; a loopback address. Port 0: any free one.
    pub address: SocketAddr,
    /// Name that clients show.
    pub name: String,
}

/// A WebSocket that Foxglove and Lichtblick connect to. A clone is another
/// handle to it; the last one closes it.
#[derive(Clone)]
pub struct FoxgloveBus(Arc<Serving>);

struct Serving {
    context: Arc<Context>,
    last: Arc<LastMessages>,
    /// Taken when it is closed.
    server: Option<WebSocketServerHandle>,
    address: SocketAddr,
}

impl Drop for Serving {
    fn drop(&mut self) {
        if let Some(server) = self.server.take() {
            // Dropped, not waited for: clients are cut off at once.
            let _ = server.stop();
        }
    }
}

impl FoxgloveBus {
    /// Serves the WebSocket. Not to be called from an async context.
    ///
    /// # Errors
    ///
    /// An address beyond loopback; a port that is taken.
    pub fn open(config: &FoxgloveConfig) -> Result<FoxgloveBus, OpenError> {
        let address = config.address;
        if !address.ip().is_loopback() {
            return Err(OpenError::NotLoopback { address });
        }
        let context = Context::new();
        let last = Arc::new(LastMessages::new(&context));
        let server = WebSocketServer::new()
            .name(&config.name)
            .context(&context)
            .listener(last.clone())
            .bind(address.ip().to_string(), address.port())
            .start_blocking()
            .map_err(|error| open_error(address, &error))?;
        Ok(FoxgloveBus(Arc::new(Serving {
            context,
            last,
            address: SocketAddr::new(address.ip(), server.port()),
            server: Some(server),
        })))
    }

    /// Where it is served.
    pub fn address(&self) -> SocketAddr {
        self.0.address
    }

    /// Clients that are connected.
    pub fn clients(&self) -> usize {
        self.0
            .server
            .as_ref()
            .map_or(0, WebSocketServerHandle::client_count)
    }

    /// A publisher to all clients that subscribe to the topic.
    ///
    /// # Errors
    ///
    /// [`CreateError::Middleware`].
    pub fn publisher<M: Message>(
        &self,
        topic: Topic<M>,
    ) -> Result<FoxglovePublisher<M>, CreateError> {
        FoxglovePublisher::create(self, topic)
    }
}

fn open_error(address: SocketAddr, error: &FoxgloveError) -> OpenError {
    match error {
        FoxgloveError::Bind(error) if error.kind() == ErrorKind::AddrInUse => {
            OpenError::PortTaken {
                endpoint: format!("tcp/{address}"),
                reason: error.to_string(),
            }
        }
        error => OpenError::Middleware {
            transport: "a WebSocket for Foxglove",
            reason: error.to_string(),
        },
    }
}

impl fmt::Debug for FoxgloveBus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FoxgloveBus")
            .field("address", &self.0.address)
            .finish_non_exhaustive()
    }
}

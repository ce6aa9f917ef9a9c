//! A connection to the service.

use std::{
    io::ErrorKind,
    net::{TcpStream, ToSocketAddrs},
    time::Duration,
};

use ferntast_config::HaplyConfig;
use tungstenite::{Error, Message, WebSocket};

use super::message::{self, FrameError, Heard};

/// For so long a connection, and then its answer, is waited for.
const PATIENCE: Duration = Duration::from_millis(200);
/// So many frames are read at a time at most: the newest counts.
const BATCH: usize = 256;

/// Why there is nothing from the service.
#[derive(Debug, thiserror::Error)]
pub(super) enum DeviceError {
    /// Nobody listens there.
    #[error("no Haply service at {url}: {reason}; is the Inverse Service running?")]
    NotThere { url: String, reason: String },
    /// It ended, or broke.
    #[error("Haply's service has gone: {0}")]
    Gone(Box<Error>),
    /// It says something else.
    #[error(transparent)]
    Frame(#[from] FrameError),
}

/// A connection to the service.
pub(super) struct Device {
    socket: WebSocket<TcpStream>,
}

impl Device {
    pub(super) fn connect(url: &str) -> Result<Device, DeviceError> {
        let refused = |reason: String| DeviceError::NotThere {
            url: url.to_owned(),
            reason,
        };
        let place = HaplyConfig::address_of(url)
            .ok_or_else(|| refused("the address is no ws://HOST:PORT".to_owned()))?;
        let all = place
            .to_socket_addrs()
            .map_err(|error| refused(error.to_string()))?;
        let mut reason = "the address is none".to_owned();
        for address in all {
            let stream = match TcpStream::connect_timeout(&address, PATIENCE) {
                Ok(stream) => stream,
                Err(error) => {
                    reason = error.to_string();
                    continue;
                }
            };
            let ready = stream
                .set_read_timeout(Some(PATIENCE))
                .and_then(|()| stream.set_nodelay(true));
            ready.map_err(|error| refused(error.to_string()))?;
            let (socket, _) =
                tungstenite::client(url, stream).map_err(|error| refused(error.to_string()))?;
            socket
                .get_ref()
                .set_nonblocking(true)
                .map_err(|error| refused(error.to_string()))?;
            return Ok(Device { socket });
        }
        Err(refused(reason))
    }

    /// The newest frame that is there, if there is one.
    pub(super) fn receive(&mut self) -> Result<Option<Heard>, DeviceError> {
        let mut newest = None;
        for _ in 0..BATCH {
            match self.socket.read() {
                Ok(Message::Text(text)) => newest = Some(text),
                Ok(_) => {}
                Err(error) if waits(&error) => break,
                Err(error) => return Err(DeviceError::Gone(Box::new(error))),
            }
        }
        Ok(newest.map(|text| message::read(&text)).transpose()?)
    }

    /// Puts `force` \[N\], of the device's frame, on the hand.
    pub(super) fn push(
        &mut self,
        device: &serde_json::Value,
        force: [f64; 3],
    ) -> Result<(), DeviceError> {
        match self
            .socket
            .send(Message::text(message::force(device, force)))
        {
            // What cannot go out now goes with the next.
            Err(error) if !waits(&error) => Err(DeviceError::Gone(Box::new(error))),
            _ => Ok(()),
        }
    }
}

fn waits(error: &Error) -> bool {
    matches!(error, Error::Io(error) if error.kind() == ErrorKind::WouldBlock)
}

//! The last state for late joiners.
//!
//! iceoryx2 hands its history to a new subscriber when the publisher next
//! looks after its connections, which it does while sending. A state that
//! does not change is not sent, so a thread looks after the connections of
//! state publishers in the meantime.

use std::{
    fmt, io,
    sync::{Arc, Mutex, PoisonError, Weak, mpsc},
    thread,
    time::Duration,
};

use ferntast_msgs::Message;
use iceoryx2::port::{publisher::Publisher, update_connections::UpdateConnections};

use super::{Service, payload::Payload};

/// How long a late joiner waits for the last state at most.
const PERIOD: Duration = Duration::from_millis(20);

/// A publisher to look after; false once it is gone.
type Visit = Box<dyn FnMut() -> bool + Send>;

/// Hands publishers to the thread, which starts with the first one and ends with this value.
#[derive(Default)]
pub(super) struct ConnectionUpdater {
    visits: Mutex<Option<mpsc::Sender<Visit>>>,
}

impl ConnectionUpdater {
    /// Looks after the connections of `port` until it is dropped.
    ///
    /// # Errors
    ///
    /// The thread cannot be started.
    pub(super) fn serve<M: Message>(
        &self,
        port: &Arc<Publisher<Service, Payload<M>, ()>>,
    ) -> io::Result<()> {
        let port: Weak<_> = Arc::downgrade(port);
        let visit: Visit = Box::new(move || match port.upgrade() {
            Some(port) => {
                // A connection that fails here fails again, and is reported, when sending.
                let _ = port.update_connections();
                true
            }
            None => false,
        });
        let mut visits = self.visits.lock().unwrap_or_else(PoisonError::into_inner);
        let sender = match visits.take() {
            Some(sender) => sender,
            None => start()?,
        };
        let sent = sender.send(visit);
        *visits = Some(sender);
        sent.map_err(|_| io::Error::other("it ended"))
    }
}

impl fmt::Debug for ConnectionUpdater {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ConnectionUpdater").finish_non_exhaustive()
    }
}

fn start() -> io::Result<mpsc::Sender<Visit>> {
    let (sender, receiver) = mpsc::channel::<Visit>();
    thread::Builder::new()
        .name("bus-late-joiners".into())
        .spawn(move || {
            let mut visits: Vec<Visit> = Vec::new();
            loop {
                match receiver.recv_timeout(PERIOD) {
                    Ok(visit) => visits.push(visit),
                    Err(mpsc::RecvTimeoutError::Timeout) => visits.retain_mut(|visit| visit()),
                    Err(mpsc::RecvTimeoutError::Disconnected) => return,
                }
            }
        })?;
    Ok(sender)
}

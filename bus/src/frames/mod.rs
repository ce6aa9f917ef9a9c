//! Short raw records between the two ends of the teleoperation link.
//!
//! A frame is what the link made of it, byte for byte; nothing here looks
//! into it. Two variants: in memory, in virtual time, for lockstep and tests
//! ([`memory`]); over Zenoh, between two hosts ([`ZenohLink`]).

mod door;
mod queue;
mod tls;
mod zenoh_link;

use std::sync::Arc;

use ferntast_msgs::Time;

pub use door::{Door, Reason};
pub use tls::LinkTls;
pub use zenoh_link::{Clock, LinkDirection, LinkEndpoint, ONE_THREAD, ZenohLink, ZenohLinkConfig};

pub use crate::endpoint::{check_link as check_endpoint, is_loopback};
use crate::error::SendError;
use queue::Queue;
use zenoh_link::ZenohFrameSender;

/// Longest frame \[byte\].
pub const MAX_FRAME: usize = 256;

/// How many frames wait for a reader (two seconds at 500 Hz); past that the oldest is dropped.
pub const FRAME_QUEUE: usize = 1024;

/// Sends frames one way. Neither waits nor retries: a frame that does not get
/// through is lost.
#[derive(Debug)]
pub struct FrameSender(SenderKind);

#[derive(Debug)]
enum SenderKind {
    Memory(Arc<Queue>),
    Zenoh(ZenohFrameSender),
}

impl FrameSender {
    /// Sends `frame` at time `now`.
    ///
    /// # Errors
    ///
    /// [`SendError::TooLong`]; [`SendError::Middleware`] when the session is
    /// closed. That nobody listens is no error: the link's meters notice.
    pub fn send(&mut self, now: Time, frame: &[u8]) -> Result<(), SendError> {
        if frame.len() > MAX_FRAME {
            return Err(SendError::TooLong {
                length: frame.len(),
                limit: MAX_FRAME,
            });
        }
        match &mut self.0 {
            SenderKind::Memory(queue) => {
                queue.push(now, frame);
                Ok(())
            }
            SenderKind::Zenoh(sender) => sender.send(frame),
        }
    }
}

/// Receives frames from one way, each once, the oldest first.
#[derive(Debug)]
pub struct FrameReceiver {
    queue: Arc<Queue>,
    in_virtual_time: bool,
}

impl FrameReceiver {
    /// The next frame: its bytes are in `buffer`, the result is its length and
    /// when it arrived. A frame longer than the buffer is cut, and its length
    /// given as the buffer's.
    ///
    /// In memory a frame arrives when it is sent, and is visible to reads at
    /// times later than that; over Zenoh all that arrived is visible.
    pub fn receive(&mut self, now: Time, buffer: &mut [u8; MAX_FRAME]) -> Option<(usize, Time)> {
        let before = self.in_virtual_time.then_some(now);
        self.queue.pop(before, buffer)
    }

    /// Frames dropped because the queue was full.
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }
}

/// One way of a link in memory; take two for both ways.
pub fn memory() -> (FrameSender, FrameReceiver) {
    let queue = Arc::new(Queue::new());
    let receiver = FrameReceiver {
        queue: queue.clone(),
        in_virtual_time: true,
    };
    (FrameSender(SenderKind::Memory(queue)), receiver)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(nanos: i64) -> Time {
        Time::from_nanos(nanos)
    }

    #[test]
    fn in_memory_a_frame_is_visible_after_it_was_sent() {
        let (mut sender, mut receiver) = memory();
        let mut buffer = [0; MAX_FRAME];
        sender.send(at(10), b"first").unwrap();
        sender.send(at(11), b"second").unwrap();
        assert_eq!(receiver.receive(at(10), &mut buffer), None);
        assert_eq!(receiver.receive(at(11), &mut buffer), Some((5, at(10))));
        assert_eq!(&buffer[..5], b"first");
        assert_eq!(receiver.receive(at(11), &mut buffer), None);
        assert_eq!(receiver.receive(at(12), &mut buffer), Some((6, at(11))));
        assert_eq!(&buffer[..6], b"second");
        assert_eq!(receiver.receive(at(99), &mut buffer), None);
    }

    #[test]
    fn a_full_queue_drops_the_oldest_and_counts() {
        let (mut sender, mut receiver) = memory();
        for number in 0..FRAME_QUEUE as i64 + 3 {
            sender.send(at(number + 1), &number.to_le_bytes()).unwrap();
        }
        assert_eq!(receiver.dropped(), 3);
        let mut buffer = [0; MAX_FRAME];
        assert_eq!(
            receiver.receive(at(i64::MAX), &mut buffer),
            Some((8, at(4)))
        );
        assert_eq!(buffer[..8], 3_i64.to_le_bytes());
    }

    #[test]
    fn a_frame_too_long_is_refused() {
        let (mut sender, mut receiver) = memory();
        assert_eq!(
            sender.send(at(1), &[0; MAX_FRAME + 1]),
            Err(SendError::TooLong {
                length: MAX_FRAME + 1,
                limit: MAX_FRAME
            })
        );
        assert_eq!(receiver.receive(at(2), &mut [0; MAX_FRAME]), None);
    }
}

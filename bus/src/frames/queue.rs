//! Frames that wait for their reader.

use std::{
    collections::VecDeque,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};

use ferntast_msgs::Time;

use super::{FRAME_QUEUE, MAX_FRAME};

/// A queue of fixed size; it allocates when made and never after.
#[derive(Debug)]
pub(super) struct Queue {
    waiting: Mutex<Waiting>,
    /// How many wait: who finds none need not take the lock.
    count: AtomicUsize,
}

#[derive(Debug)]
struct Waiting {
    frames: VecDeque<Frame>,
    dropped: u64,
}

#[derive(Debug)]
struct Frame {
    arrived: Time,
    length: usize,
    bytes: [u8; MAX_FRAME],
}

impl Queue {
    pub(super) fn new() -> Queue {
        Queue {
            waiting: Mutex::new(Waiting {
                frames: VecDeque::with_capacity(FRAME_QUEUE),
                dropped: 0,
            }),
            count: AtomicUsize::new(0),
        }
    }

    /// Appends a frame; what is longer than [`MAX_FRAME`] is cut.
    pub(super) fn push(&self, arrived: Time, frame: &[u8]) {
        let length = frame.len().min(MAX_FRAME);
        let mut bytes = [0; MAX_FRAME];
        bytes[..length].copy_from_slice(&frame[..length]);
        let mut waiting = self.lock();
        if waiting.frames.len() == FRAME_QUEUE {
            waiting.frames.pop_front();
            waiting.dropped += 1;
        }
        waiting.frames.push_back(Frame {
            arrived,
            length,
            bytes,
        });
        self.count.store(waiting.frames.len(), Ordering::Release);
    }

    /// Takes the oldest frame, if it arrived before the time given.
    pub(super) fn pop(
        &self,
        before: Option<Time>,
        buffer: &mut [u8; MAX_FRAME],
    ) -> Option<(usize, Time)> {
        if self.count.load(Ordering::Acquire) == 0 {
            return None;
        }
        let mut waiting = self.lock();
        let frame = waiting
            .frames
            .pop_front_if(|frame| before.is_none_or(|before| frame.arrived < before))?;
        self.count.store(waiting.frames.len(), Ordering::Release);
        buffer[..frame.length].copy_from_slice(&frame.bytes[..frame.length]);
        Some((frame.length, frame.arrived))
    }

    pub(super) fn dropped(&self) -> u64 {
        self.lock().dropped
    }

    /// A poisoned lock only says that another thread panicked; the queue is whole.
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

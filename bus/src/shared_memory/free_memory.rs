//! Whether shared memory has enough free space.
//!
//! Segments take their pages when they are first written to, and a page that
//! does not exist kills the process (SIGBUS). So there must be space for all
//! of a segment, and some to spare, before it is made.

use std::{ffi::CStr, io, mem};

use super::{MAX_SUBSCRIBERS, SharedMemoryBus, payload::Payload, service::history};
use crate::error::{CreateError, OpenError};
use ferntast_msgs::{Message, topics::Topic};

/// Where Linux keeps POSIX shared memory.
const SHARED_MEMORY: &CStr = c"/dev/shm";
/// What iceoryx2 needs beside the messages, for all topics of a session \[byte\].
const MARGIN: u64 = 2 << 20;
/// iceoryx2's header of a message, and its place in the queues \[byte\].
const OVERHEAD: u64 = 128;

/// Whether a session can be opened.
pub(super) fn check_for_session() -> Result<(), OpenError> {
    missing(MARGIN).map_or(Ok(()), |reason| {
        Err(OpenError::NoRoom {
            path: SHARED_MEMORY.to_string_lossy().into(),
            reason,
        })
    })
}

/// Whether a publisher of the topic can be created.
pub(super) fn check_for_publisher<M: Message>(topic: Topic<M>) -> Result<(), CreateError> {
    let queue = SharedMemoryBus::max_queue(topic.delivery);
    let messages = MAX_SUBSCRIBERS * (queue + 1) + history(topic.delivery) + 1;
    let bytes = messages as u64 * (size_of::<Payload<M>>() as u64 + OVERHEAD);
    missing(bytes + MARGIN).map_or(Ok(()), |reason| {
        Err(CreateError::NoRoom {
            topic: topic.name.into(),
            reason,
        })
    })
}

/// What is missing to `bytes`, for people; `None` when that is free.
fn missing(bytes: u64) -> Option<String> {
    // A system that does not say is taken to have enough.
    let free = free().ok()?;
    (free < bytes).then(|| {
        format!(
            "{} KiB are free, {} KiB needed",
            free >> 10,
            bytes.div_ceil(1 << 10)
        )
    })
}

/// Free bytes for this user.
fn free() -> io::Result<u64> {
    // SAFETY: all-zero is a value of this plain structure of integers.
    let mut state: libc::statvfs = unsafe { mem::zeroed() };
    // SAFETY: the path ends in a zero byte, and the structure lives through the call.
    if unsafe { libc::statvfs(SHARED_MEMORY.as_ptr(), &raw mut state) } != 0 {
        return Err(io::Error::last_os_error());
    }
    Ok(state.f_bavail.saturating_mul(state.f_frsize))
}

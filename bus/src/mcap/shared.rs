//! What the publishers or the subscribers of one recording share.

use std::sync::{
    Arc, Mutex, MutexGuard, PoisonError,
    atomic::{AtomicI64, Ordering},
};

use ferntast_bag::{BagReader, BagWriter};
use ferntast_msgs::Time;

/// A recording that several publishers write to; empty once closed.
#[derive(Clone)]
pub(super) struct SharedWriter(Arc<Mutex<Option<BagWriter>>>);

impl SharedWriter {
    pub(super) fn new(writer: BagWriter) -> SharedWriter {
        SharedWriter(Arc::new(Mutex::new(Some(writer))))
    }

    /// A poisoned lock says that another publisher panicked; the recording
    /// takes whole messages only.
    pub(super) fn lock(&self) -> MutexGuard<'_, Option<BagWriter>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for SharedWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let guard = self.lock();
        f.debug_tuple("SharedWriter")
            .field(&guard.as_ref().map(BagWriter::directory))
            .finish()
    }
}

/// A recording that several subscribers read.
#[derive(Debug)]
pub(super) struct Reading {
    pub(super) reader: BagReader,
    clock: AtomicI64,
}

impl Reading {
    pub(super) fn new(reader: BagReader) -> Reading {
        Reading {
            reader,
            clock: AtomicI64::new(0),
        }
    }

    pub(super) fn now(&self) -> Time {
        Time::from_nanos(self.clock.load(Ordering::Relaxed))
    }

    pub(super) fn advance(&self, now: Time) {
        self.clock.fetch_max(now.nanos(), Ordering::Relaxed);
    }
}

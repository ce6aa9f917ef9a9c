//! A recording as a way across.

use std::{path::Path, sync::Arc};

use ferntast_bag::{
    BagOptions, BagReader, BagSummary, BagWriter, CreateBagError, FinishBagError, OpenBagError,
    SelectTopicError, WriteBagError,
};
use ferntast_msgs::{Message, Time, topics::Topic};

use super::{
    publisher::McapPublisher,
    shared::{Reading, SharedWriter},
    subscriber::McapSubscriber,
};
use crate::{
    error::CreateError,
    types::{Depth, type_name},
};

/// Longest queue of a subscriber.
pub(super) const MAX_QUEUE: usize = 1 << 20;

/// A recording that is either written ([`McapBus::create`]: publishers) or
/// read ([`McapBus::open`]: subscribers). A clone is another handle to it.
///
/// A message is logged and published at the time that it is published at, and
/// visible to reads later than that, as in [`MemoryBus`](crate::MemoryBus).
///
/// The reading side's time is the latest that any of its subscribers was
/// asked with. A subscriber made later than that is a late joiner: it begins
/// with the next message, on a state topic with the last.
#[derive(Clone, Debug)]
pub struct McapBus {
    side: Side,
}

#[derive(Clone, Debug)]
enum Side {
    Writing(SharedWriter),
    Reading(Arc<Reading>),
}

impl McapBus {
    /// A bus that records into the new rosbag2 directory `directory`.
    ///
    /// # Errors
    ///
    /// [`CreateBagError`].
    pub fn create(directory: &Path) -> Result<McapBus, CreateBagError> {
        McapBus::create_with(directory, BagOptions::default())
    }

    /// The same with other than the usual options.
    ///
    /// # Errors
    ///
    /// [`CreateBagError`].
    pub fn create_with(directory: &Path, options: BagOptions) -> Result<McapBus, CreateBagError> {
        let writer = BagWriter::create(directory, options)?;
        Ok(McapBus {
            side: Side::Writing(SharedWriter::new(writer)),
        })
    }

    /// A bus that plays the rosbag2 directory or MCAP file at `path`.
    ///
    /// # Errors
    ///
    /// [`OpenBagError`].
    pub fn open(path: &Path) -> Result<McapBus, OpenBagError> {
        let reader = BagReader::open(path)?;
        Ok(McapBus {
            side: Side::Reading(Arc::new(Reading::new(reader))),
        })
    }

    /// The recording that is read; `None` while one is written.
    pub fn reader(&self) -> Option<&BagReader> {
        match &self.side {
            Side::Reading(reading) => Some(&reading.reader),
            Side::Writing(_) => None,
        }
    }

    /// Moves the reading side's time to `now`, as a read at `now` would.
    pub fn advance(&self, now: Time) {
        if let Side::Reading(reading) = &self.side {
            reading.advance(now);
        }
    }

    /// Closes the recording that is written: its publishers then refuse.
    /// `None` when one is read, or when it is closed already. Without this
    /// the last handle closes it, and does not say how that went.
    ///
    /// # Errors
    ///
    /// [`FinishBagError`].
    pub fn finish(&self) -> Result<Option<BagSummary>, FinishBagError> {
        match &self.side {
            Side::Reading(_) => Ok(None),
            Side::Writing(shared) => {
                let writer = shared.lock().take();
                writer.map(BagWriter::finish).transpose()
            }
        }
    }

    /// A publisher into the recording; a topic that is in it is continued.
    ///
    /// # Errors
    ///
    /// [`CreateError::WrongType`], [`CreateError::Recording`].
    pub fn publisher<M: Message>(&self, topic: Topic<M>) -> Result<McapPublisher<M>, CreateError> {
        let refused = |reason: String| CreateError::Recording {
            topic: topic.name.into(),
            reason,
        };
        let Side::Writing(shared) = &self.side else {
            return Err(refused(
                "the recording is being read; publish into a new one".to_owned(),
            ));
        };
        let mut guard = shared.lock();
        let Some(writer) = guard.as_mut() else {
            return Err(refused("the recording is closed".to_owned()));
        };
        let channel = writer.topic(topic).map_err(|error| match error {
            WriteBagError::WrongType { found, .. } => CreateError::WrongType {
                topic: topic.name.into(),
                wanted: type_name::<M>(),
                found,
            },
            error => refused(error.to_string()),
        })?;
        Ok(McapPublisher::new(shared.clone(), topic, channel))
    }

    /// A subscriber to the recording.
    ///
    /// # Errors
    ///
    /// [`CreateError::WrongType`], [`CreateError::BadDepth`],
    /// [`CreateError::Recording`] when it has no such topic or is being
    /// written.
    pub fn subscriber<M: Message>(
        &self,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<McapSubscriber<M>, CreateError> {
        let refused = |reason: String| CreateError::Recording {
            topic: topic.name.into(),
            reason,
        };
        if !(1..=MAX_QUEUE).contains(&depth.places()) {
            return Err(CreateError::BadDepth {
                topic: topic.name.into(),
                depth: depth.places(),
                limit: MAX_QUEUE,
            });
        }
        let Side::Reading(reading) = &self.side else {
            return Err(refused(
                "the recording is being written; close it and open it to subscribe".to_owned(),
            ));
        };
        McapSubscriber::new(reading.clone(), topic, depth).map_err(|error| match error {
            SelectTopicError::WrongType { found, .. } => CreateError::WrongType {
                topic: topic.name.into(),
                wanted: type_name::<M>(),
                found,
            },
            error => refused(error.to_string()),
        })
    }
}

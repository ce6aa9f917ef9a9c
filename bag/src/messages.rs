//! Going through the messages of a recording.

use std::{collections::BTreeMap, marker::PhantomData, sync::Arc};

use ferntast_msgs::{
    Message, Time,
    cdr::{self, DecodeError},
};

use super::{
    cursor::{Cursor, Found},
    error::ReadMessageError,
    topic::{BagTopic, time},
};

/// A message of a recording as it stands there.
#[derive(Clone, Debug)]
pub struct RawMessage {
    /// Its topic.
    pub topic: Arc<BagTopic>,
    /// When it was recorded.
    pub log_time: Time,
    /// When it was published; [`Time::INVALID`] where that is not known.
    pub publish_time: Time,
    /// Its number on its topic, as far as the recorder counted.
    pub sequence: u32,
    found: Found,
}

/// Where a message stands in its recording: ascending in the order in which
/// messages were written, which need not be that of their log times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    file: usize,
    within: (u64, usize),
}

impl RawMessage {
    /// Where it stands in its recording.
    pub fn place(&self) -> Place {
        Place {
            file: self.found.file,
            within: self.found.block.place(&self.found.entry),
        }
    }

    /// The message, encoded as the topic says.
    pub fn bytes(&self) -> &[u8] {
        self.found.block.data(&self.found.entry)
    }
}

/// Messages of a recording in the order of log time. After an error the
/// iteration goes on behind the fault.
#[derive(Debug)]
pub struct RawMessages {
    cursor: Cursor,
    channels: Vec<BTreeMap<u16, Arc<BagTopic>>>,
}

impl RawMessages {
    /// `channels` says by file the topic of each channel.
    pub(crate) fn new(cursor: Cursor, channels: Vec<BTreeMap<u16, Arc<BagTopic>>>) -> RawMessages {
        RawMessages { cursor, channels }
    }

    /// Log time of the message to come; `None` at the end and in front of an
    /// error.
    pub fn peek(&mut self) -> Option<Time> {
        self.cursor.peek().ok().flatten().map(time)
    }

    /// The next message if it was logged before `end`.
    ///
    /// # Errors
    ///
    /// [`ReadMessageError`]; reading goes on behind what is damaged.
    pub fn next_before(&mut self, end: Time) -> Result<Option<RawMessage>, ReadMessageError> {
        loop {
            match self.cursor.peek()? {
                Some(log_time) if time(log_time) < end => {}
                _ => return Ok(None),
            }
            let Some(found) = self.cursor.take()? else {
                return Ok(None);
            };
            if let Some(message) = self.named(found) {
                return Ok(Some(message));
            }
        }
    }

    /// `None` for a message of a channel that is described nowhere: it has no
    /// topic.
    fn named(&self, found: Found) -> Option<RawMessage> {
        let header = found.entry.header;
        let topic = self.channels.get(found.file)?.get(&header.channel_id)?;
        Some(RawMessage {
            topic: topic.clone(),
            log_time: time(header.log_time),
            publish_time: time(header.publish_time),
            sequence: header.sequence,
            found,
        })
    }
}

impl Iterator for RawMessages {
    type Item = Result<RawMessage, ReadMessageError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.cursor.take() {
                Ok(found) => {
                    if let Some(message) = self.named(found?) {
                        return Some(Ok(message));
                    }
                }
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

/// A message of a recording as a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypedMessage<M> {
    /// When it was recorded.
    pub log_time: Time,
    /// When it was published; [`Time::INVALID`] where that is not known.
    pub publish_time: Time,
    /// The message.
    pub message: M,
}

/// Messages of one topic in the order of log time. After an error the
/// iteration goes on with the next message.
#[derive(Debug)]
pub struct Messages<M: Message> {
    raw: RawMessages,
    message: PhantomData<fn() -> M>,
}

impl<M: Message> Messages<M> {
    pub(crate) fn new(raw: RawMessages) -> Messages<M> {
        Messages {
            raw,
            message: PhantomData,
        }
    }

    /// Log time of the message to come; `None` at the end and in front of an
    /// error.
    pub fn peek(&mut self) -> Option<Time> {
        self.raw.peek()
    }
}

impl<M: Message> Iterator for Messages<M> {
    type Item = Result<TypedMessage<M>, ReadMessageError>;

    fn next(&mut self) -> Option<Self::Item> {
        let raw = match self.raw.next()? {
            Ok(raw) => raw,
            Err(error) => return Some(Err(error)),
        };
        let topic = || raw.topic.name.clone();
        let message = cdr::decode_sample(raw.bytes()).map_err(|error| match error {
            DecodeError::Invalid(source) => ReadMessageError::Invalid {
                topic: topic(),
                log_time: raw.log_time,
                source,
            },
            source => ReadMessageError::Decode {
                topic: topic(),
                log_time: raw.log_time,
                source,
            },
        });
        Some(message.map(|message| TypedMessage {
            log_time: raw.log_time,
            publish_time: raw.publish_time,
            message,
        }))
    }
}

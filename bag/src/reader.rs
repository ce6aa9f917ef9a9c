//! Reading recordings, of whoever made them.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    sync::Arc,
};

use ferntast_msgs::{Message, RosMessage, Time, interface};

use super::{
    cursor::{Cursor, SharedFile},
    directory::bag_files,
    error::{OpenBagError, SelectTopicError},
    layout::Layout,
    messages::{Messages, RawMessages},
    metadata::join_bounds,
    rosbag2_record::ROSBAG2_RECORD,
    topic::{BagTopic, time, topic_of},
};

/// An open recording. A clone reads the same files.
#[derive(Clone, Debug)]
pub struct BagReader {
    path: PathBuf,
    files: Vec<Arc<SharedFile>>,
    /// In the order of the files' channels, each once.
    topics: Vec<Arc<BagTopic>>,
    /// By file: the topic of each channel.
    channels: Vec<BTreeMap<u16, Arc<BagTopic>>>,
}

impl BagReader {
    /// Opens a rosbag2 directory or one MCAP file.
    ///
    /// # Errors
    ///
    /// [`OpenBagError`]; a recording that was cut off is refused here and
    /// repaired by [`repair`](super::repair).
    pub fn open(path: &Path) -> Result<BagReader, OpenBagError> {
        let layouts: Result<Vec<_>, _> = bag_files(path)?
            .iter()
            .map(|file| Layout::open(file))
            .collect();
        Ok(BagReader::over(path, layouts?))
    }

    pub(crate) fn over(path: &Path, layouts: Vec<Layout>) -> BagReader {
        let mut topics: Vec<Arc<BagTopic>> = Vec::new();
        let channels = layouts
            .iter()
            .map(|layout| {
                let mut channels = BTreeMap::new();
                for &id in layout.channels.keys() {
                    let Some(topic) = topic_of(layout, id) else {
                        continue;
                    };
                    let topic = match topics.iter().find(|known| ***known == topic) {
                        Some(known) => known.clone(),
                        None => {
                            topics.push(Arc::new(topic));
                            topics[topics.len() - 1].clone()
                        }
                    };
                    channels.insert(id, topic);
                }
                channels
            })
            .collect();
        BagReader {
            path: path.to_owned(),
            files: layouts
                .into_iter()
                .map(|layout| Arc::new(SharedFile::new(layout)))
                .collect(),
            topics,
            channels,
        }
    }

    /// What was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The topics.
    pub fn topics(&self) -> impl Iterator<Item = &BagTopic> {
        self.topics.iter().map(|topic| &**topic)
    }

    /// First and last log time; `None` without a message.
    pub fn bounds(&self) -> Option<(Time, Time)> {
        let bounds = self.files.iter().flat_map(|file| {
            let blocks = file.layout.blocks.iter();
            // A chunk without messages has the bounds 0, 0.
            blocks
                .filter(|block| block.end > 0)
                .map(|block| Some((block.start, block.end)))
        });
        join_bounds(bounds).map(|(first, last)| (time(first), time(last)))
    }

    /// The metadata records by name, without rosbag2's own.
    pub fn metadata(&self) -> BTreeMap<String, BTreeMap<String, String>> {
        let records = self.files.iter().flat_map(|file| &file.layout.metadata);
        records
            .filter(|record| record.name != ROSBAG2_RECORD)
            .map(|record| (record.name.clone(), record.metadata.clone()))
            .collect()
    }

    /// All messages in the order of log time.
    pub fn raw(&self) -> RawMessages {
        self.raw_from(Time::from_nanos(0))
    }

    /// All messages logged at `from` or later.
    pub fn raw_from(&self, from: Time) -> RawMessages {
        self.messages_of(None, from)
    }

    /// The messages of some topics, logged at `from` or later.
    ///
    /// # Errors
    ///
    /// [`SelectTopicError::NoSuchTopic`].
    pub fn raw_topics(&self, names: &[&str], from: Time) -> Result<RawMessages, SelectTopicError> {
        for name in names {
            self.topic(name)?;
        }
        Ok(self.messages_of(Some(names), from))
    }

    /// The messages of one topic as what `M` is in ROS 2.
    ///
    /// # Errors
    ///
    /// [`SelectTopicError`]: no such topic, or of another type. Types are the
    /// same when their names are, and their hashes where the recording has
    /// them.
    pub fn messages<M: Message>(&self, topic: &str) -> Result<Messages<M>, SelectTopicError> {
        self.messages_from(topic, Time::from_nanos(0))
    }

    /// The same, logged at `from` or later.
    ///
    /// # Errors
    ///
    /// As [`BagReader::messages`].
    pub fn messages_from<M: Message>(
        &self,
        topic: &str,
        from: Time,
    ) -> Result<Messages<M>, SelectTopicError> {
        Ok(Messages::new(self.typed_raw::<M>(topic, from)?))
    }

    /// The messages of a topic whose type is what `M` is in ROS 2, as bytes; logged at `from` or later.
    ///
    /// # Errors
    ///
    /// As [`BagReader::messages`].
    pub fn typed_raw<M: Message>(
        &self,
        topic: &str,
        from: Time,
    ) -> Result<RawMessages, SelectTopicError> {
        self.topic(topic)?;
        for found in self.topics.iter().filter(|found| found.name == topic) {
            check_type::<M>(found)?;
        }
        Ok(self.messages_of(Some(&[topic]), from))
    }

    fn topic(&self, name: &str) -> Result<&BagTopic, SelectTopicError> {
        self.topics()
            .find(|topic| topic.name == name)
            .ok_or_else(|| {
                let available: BTreeSet<_> =
                    self.topics().map(|topic| topic.name.clone()).collect();
                SelectTopicError::NoSuchTopic {
                    topic: name.to_owned(),
                    available: available.into_iter().collect(),
                }
            })
    }

    fn messages_of(&self, names: Option<&[&str]>, from: Time) -> RawMessages {
        let wanted = names.map(|names| {
            let of_file = |channels: &BTreeMap<u16, Arc<BagTopic>>| {
                channels
                    .iter()
                    .filter(|(_, topic)| names.contains(&topic.name.as_str()))
                    .map(|(&id, _)| id)
                    .collect()
            };
            self.channels.iter().map(of_file).collect()
        });
        RawMessages::new(
            Cursor::new(
                &self.files,
                wanted,
                u64::try_from(from.nanos()).unwrap_or(0),
            ),
            self.channels.clone(),
        )
    }
}

fn check_type<M: Message>(topic: &BagTopic) -> Result<(), SelectTopicError> {
    let wanted = M::Ros::INTERFACE;
    let wrong = |wanted: String, found: String| SelectTopicError::WrongType {
        topic: topic.name.clone(),
        wanted,
        found,
    };
    if topic.schema_name != wanted {
        return Err(wrong(wanted.to_owned(), topic.schema_name.clone()));
    }
    if topic.message_encoding != "cdr" {
        return Err(SelectTopicError::NotCdr {
            topic: topic.name.clone(),
            encoding: topic.message_encoding.clone(),
        });
    }
    match interface::type_hash(wanted) {
        // An empty hash, or one of another kind, says nothing.
        Ok(hash) if topic.type_hash.starts_with("RIHS01_") && topic.type_hash != hash => {
            Err(wrong(
                format!("{wanted} ({hash})"),
                format!("{wanted} ({})", topic.type_hash),
            ))
        }
        _ => Ok(()),
    }
}

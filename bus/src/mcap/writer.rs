//! Recording.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
};

use ferntast_msgs::{
    Message, RosMessage, Time,
    interface::{self, InterfaceError},
    topics::{Topic, TopicName},
};
use mcap::records::{MessageHeader, Metadata};

use super::{
    error::{CreateBagError, FinishBagError, WriteBagError},
    file_writer::FileWriter,
    metadata::{BagMetadata, METADATA_FILE, TopicEntry},
    options::{BagOptions, BagSummary, TopicCount},
    qos::{QosProfile, to_yaml},
};
use crate::cdr;

/// A topic of one recording that is being written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ChannelId(pub(super) u16);

struct Channel {
    topic: TopicName,
    interface: &'static str,
    type_hash: String,
    qos: QosProfile,
    id: u16,
    sequence: u32,
}

/// Writes a recording. Dropping it closes it as well as it can; only
/// [`BagWriter::finish`] says whether that went well.
pub struct BagWriter {
    directory: PathBuf,
    file: FileWriter,
    channels: Vec<Channel>,
    options: BagOptions,
    buffer: Vec<u8>,
    finished: bool,
}

impl BagWriter {
    /// Begins a recording in `directory`, which is made, with those above it,
    /// unless it is there and empty.
    ///
    /// # Errors
    ///
    /// [`CreateBagError`]: a directory that is not empty is never touched.
    pub fn create(directory: &Path, options: BagOptions) -> Result<BagWriter, CreateBagError> {
        let io_error = |path: &Path, source: io::Error| CreateBagError::Io {
            path: path.to_owned(),
            source,
        };
        let Some(name) = directory.file_name().and_then(|name| name.to_str()) else {
            return Err(CreateBagError::NoName {
                path: directory.to_owned(),
            });
        };
        fs::create_dir_all(directory).map_err(|error| io_error(directory, error))?;
        let mut entries = fs::read_dir(directory).map_err(|error| io_error(directory, error))?;
        if entries.next().is_some() {
            return Err(CreateBagError::NotEmpty {
                path: directory.to_owned(),
            });
        }
        let path = directory.join(format!("{name}_0.mcap"));
        let mut file =
            FileWriter::create(&path, &options).map_err(|error| io_error(&path, error))?;
        // Like rosbag2, the record comes first without counts and last with
        // them: a recording that is cut off still says what it is.
        let mut records = vec![rosbag2_record(&BagMetadata {
            custom_data: custom_data(&options.custom),
            ros_distro: options.ros_distro.clone(),
            ..BagMetadata::default()
        })];
        records.extend(options.custom.iter().map(|(name, entries)| Metadata {
            name: name.clone(),
            metadata: entries.clone(),
        }));
        for record in &records {
            file.metadata(record)
                .and_then(|()| file.flush())
                .map_err(|error| CreateBagError::Format {
                    path: path.clone(),
                    reason: error.to_string(),
                })?;
        }
        Ok(BagWriter {
            directory: directory.to_owned(),
            file,
            channels: Vec::new(),
            options,
            buffer: Vec::new(),
            finished: false,
        })
    }

    /// The rosbag2 directory.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Registers `topic`; a topic that is registered already is continued.
    ///
    /// # Errors
    ///
    /// [`WriteBagError::WrongType`] when it is registered with another type,
    /// [`WriteBagError::NoSchema`], and what the file refuses.
    pub fn topic<M: Message>(&mut self, topic: Topic<M>) -> Result<ChannelId, WriteBagError> {
        let interface = M::Ros::INTERFACE;
        if let Some(index) = self
            .channels
            .iter()
            .position(|channel| channel.topic == topic.name)
        {
            self.check_type::<M>(index)?;
            return Ok(ChannelId(index as u16));
        }
        let no_schema = |error: InterfaceError| WriteBagError::NoSchema {
            interface,
            reason: error.to_string(),
        };
        let schema = interface::schema(interface).map_err(no_schema)?;
        let type_hash = interface::type_hash(interface).map_err(no_schema)?;
        let qos = QosProfile::for_delivery(topic.delivery);
        let metadata = BTreeMap::from([
            (
                "offered_qos_profiles".to_owned(),
                to_yaml(std::slice::from_ref(&qos)).trim_end().to_owned(),
            ),
            ("topic_type_hash".to_owned(), type_hash.clone()),
        ]);
        let schema = self.file.schema(interface, "ros2msg", schema.as_bytes())?;
        let id = self.file.channel(schema, &topic.name, "cdr", &metadata)?;
        self.channels.push(Channel {
            topic: topic.name,
            interface,
            type_hash,
            qos,
            id,
            sequence: 0,
        });
        Ok(ChannelId((self.channels.len() - 1) as u16))
    }

    /// Records `message` as logged at `log_time` and published at
    /// `publish_time`. Takes the memory that it needs with the first messages.
    ///
    /// # Errors
    ///
    /// [`WriteBagError`]; the recording can be continued.
    pub fn write<M: Message>(
        &mut self,
        channel: ChannelId,
        log_time: Time,
        publish_time: Time,
        message: &M,
    ) -> Result<(), WriteBagError> {
        let index = usize::from(channel.0);
        self.check_type::<M>(index)?;
        let Some(channel) = self.channels.get_mut(index) else {
            return Err(WriteBagError::UnknownChannel { channel: channel.0 });
        };
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time: nanos(&channel.topic, "log time", log_time)?,
            publish_time: nanos(&channel.topic, "publish time", publish_time)?,
        };
        cdr::encode(&message.to_ros(), &mut self.buffer).map_err(|source| {
            WriteBagError::Encode {
                topic: channel.topic.into(),
                source,
            }
        })?;
        // MCAP's sequence numbers have 32 bits and begin again.
        channel.sequence = channel.sequence.wrapping_add(1);
        self.file.message(&header, &self.buffer)
    }

    /// Hands what was recorded to the system. Needed only where log time
    /// stands still: else it happens by itself, see [`BagOptions`].
    ///
    /// # Errors
    ///
    /// [`WriteBagError::DiskFull`] and [`WriteBagError::Io`]; what could not
    /// be written waits for the next attempt.
    pub fn flush(&mut self) -> Result<(), WriteBagError> {
        self.file.flush()
    }

    /// Closes the MCAP file and writes `metadata.yaml`.
    ///
    /// # Errors
    ///
    /// [`FinishBagError`].
    pub fn finish(mut self) -> Result<BagSummary, FinishBagError> {
        self.close()
    }

    fn close(&mut self) -> Result<BagSummary, FinishBagError> {
        self.finished = true;
        let metadata = self.metadata();
        let path = self.file.path().to_owned();
        let record = rosbag2_record(&metadata);
        let bytes = self
            .file
            .metadata(&record)
            .and_then(|()| self.file.finish())
            .map_err(|source| FinishBagError::File { path, source })?;
        write_metadata(&self.directory, &metadata)?;
        let entry = self.file.entry();
        let time = |nanos: u64| Time::from_nanos(i64::try_from(nanos).unwrap_or(i64::MAX));
        Ok(BagSummary {
            path: self.directory.clone(),
            bytes,
            messages: entry.messages,
            start: entry.bounds.map(|(first, _)| time(first)),
            end: entry.bounds.map(|(_, last)| time(last)),
            topics: metadata
                .topics
                .into_iter()
                .map(|topic| TopicCount {
                    topic: topic.name,
                    interface: topic.schema_name,
                    messages: topic.messages,
                })
                .collect(),
        })
    }

    fn metadata(&self) -> BagMetadata {
        let counts = self.file.counts();
        BagMetadata {
            files: vec![self.file.entry()],
            topics: self
                .channels
                .iter()
                .map(|channel| TopicEntry {
                    name: channel.topic.into(),
                    schema_name: channel.interface.to_owned(),
                    message_encoding: "cdr".to_owned(),
                    qos: vec![channel.qos.clone()],
                    type_hash: channel.type_hash.clone(),
                    messages: counts.get(&channel.id).copied().unwrap_or(0),
                })
                .collect(),
            custom_data: custom_data(&self.options.custom),
            ros_distro: self.options.ros_distro.clone(),
        }
    }

    fn check_type<M: Message>(&self, index: usize) -> Result<(), WriteBagError> {
        match self.channels.get(index) {
            Some(channel) if channel.interface != M::Ros::INTERFACE => {
                Err(WriteBagError::WrongType {
                    topic: channel.topic.into(),
                    wanted: M::Ros::INTERFACE.to_owned(),
                    found: channel.interface.to_owned(),
                })
            }
            _ => Ok(()),
        }
    }
}

impl Drop for BagWriter {
    fn drop(&mut self) {
        if !self.finished {
            let _ = self.close();
        }
    }
}

/// rosbag2's own record inside the MCAP file.
pub(super) fn rosbag2_record(metadata: &BagMetadata) -> Metadata {
    Metadata {
        name: ROSBAG2_RECORD.to_owned(),
        metadata: BTreeMap::from([("serialized_metadata".to_owned(), metadata.to_yaml())]),
    }
}

/// The name of that record.
pub(super) const ROSBAG2_RECORD: &str = "rosbag2";

/// Metadata records in one map, `name.key`.
pub(super) fn custom_data(
    records: &BTreeMap<String, BTreeMap<String, String>>,
) -> BTreeMap<String, String> {
    records
        .iter()
        .flat_map(|(name, entries)| {
            entries
                .iter()
                .map(move |(key, value)| (format!("{name}.{key}"), value.clone()))
        })
        .collect()
}

/// Writes `metadata.yaml` whole or not at all.
pub(super) fn write_metadata(
    directory: &Path,
    metadata: &BagMetadata,
) -> Result<(), FinishBagError> {
    let path = directory.join(METADATA_FILE);
    let part = directory.join("metadata.yaml.part");
    fs::write(&part, metadata.to_file())
        .and_then(|()| fs::rename(&part, &path))
        .map_err(|source| FinishBagError::Metadata { path, source })
}

fn nanos(topic: &str, what: &'static str, time: Time) -> Result<u64, WriteBagError> {
    match u64::try_from(time.nanos()) {
        Ok(nanos) if time.is_valid() => Ok(nanos),
        _ => Err(WriteBagError::NoTime {
            topic: topic.to_owned(),
            what,
            nanos: time.nanos(),
        }),
    }
}

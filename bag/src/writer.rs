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
    full_files::FullFiles,
    metadata::{BagMetadata, METADATA_FILE, TopicEntry, join_bounds},
    options::{BagOptions, BagSummary, TopicCount},
    qos::{QosProfile, to_yaml},
    rosbag2_record::{custom_data, finish_file, rosbag2_record},
};

/// A topic of one recording that is being written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ChannelId(pub(crate) u16);

struct Channel {
    topic: TopicName,
    interface: &'static str,
    schema: String,
    type_hash: String,
    qos: QosProfile,
    id: u16,
    sequence: u32,
}

impl Channel {
    /// Registers it with `file`; gives its number there.
    fn register(&self, file: &mut FileWriter) -> Result<u16, WriteBagError> {
        let metadata = BTreeMap::from([
            (
                "offered_qos_profiles".to_owned(),
                to_yaml(std::slice::from_ref(&self.qos))
                    .trim_end()
                    .to_owned(),
            ),
            ("topic_type_hash".to_owned(), self.type_hash.clone()),
        ]);
        let schema = file.schema(self.interface, "ros2msg", self.schema.as_bytes())?;
        file.channel(schema, &self.topic, "cdr", &metadata)
    }

    fn entry(&self, messages: u64) -> TopicEntry {
        TopicEntry {
            name: self.topic.into(),
            schema_name: self.interface.to_owned(),
            message_encoding: "cdr".to_owned(),
            qos: vec![self.qos.clone()],
            type_hash: self.type_hash.clone(),
            messages,
        }
    }
}

/// Writes a recording. Dropping it closes it as well as it can; only
/// [`BagWriter::finish`] says whether that went well.
pub struct BagWriter {
    directory: PathBuf,
    name: String,
    file: FileWriter,
    full: FullFiles,
    /// Where the file is full \[bytes\].
    full_at: u64,
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
        Ok(BagWriter {
            directory: directory.to_owned(),
            name: name.to_owned(),
            file: begin_file(&file_path(directory, name, 0), &options)?,
            full: FullFiles::default(),
            full_at: options.max_file_size,
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
        let mut channel = Channel {
            topic: topic.name,
            interface,
            schema: interface::schema(interface).map_err(no_schema)?,
            type_hash: interface::type_hash(interface).map_err(no_schema)?,
            qos: QosProfile::for_delivery(topic.delivery),
            id: 0,
            sequence: 0,
        };
        channel.id = channel.register(&mut self.file)?;
        self.channels.push(channel);
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
        let encoded = message.to_ros().encode(&mut self.buffer);
        encoded.map_err(|source| WriteBagError::Encode {
            topic: channel.topic.into(),
            source,
        })?;
        // MCAP's sequence numbers have 32 bits and begin again.
        channel.sequence = channel.sequence.wrapping_add(1);
        self.file.message(&header, &self.buffer)?;
        if self.file.stored() >= self.full_at && self.begin_next().is_err() {
            // Whatever keeps a file from being made, this one may still take more; if
            // not, the next message says so.
            self.full_at += self.options.max_file_size / 8 + 1;
        }
        Ok(())
    }

    /// The file is full: goes on in another one.
    fn begin_next(&mut self) -> Result<(), WriteBagError> {
        let number = self.full.count() + 1;
        let path = file_path(&self.directory, &self.name, number);
        let begun = begin_file(&path, &self.options).and_then(|mut file| {
            let ids = self.channels.iter().map(|own| own.register(&mut file));
            match ids.collect::<Result<Vec<_>, _>>() {
                Ok(ids) => Ok((file, ids)),
                Err(error) => Err(cannot_begin(&path, &error)),
            }
        });
        let (next, ids) = begun.map_err(|error| WriteBagError::Io {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        let metadata = self.metadata();
        let full = std::mem::replace(&mut self.file, next);
        for (channel, id) in self.channels.iter_mut().zip(ids) {
            channel.id = id;
        }
        self.full.close(full, metadata);
        self.full_at = self.options.max_file_size;
        Ok(())
    }

    /// Of the present file alone.
    fn metadata(&self) -> BagMetadata {
        let counts = self.file.counts();
        let count = |own: &Channel| counts.get(&own.id).copied().unwrap_or(0);
        let topics = self.channels.iter().map(|own| own.entry(count(own)));
        BagMetadata {
            files: vec![self.file.entry()],
            topics: topics.collect(),
            ..first_metadata(&self.options)
        }
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
        let mut metadata = self.metadata();
        let last = finish_file(&mut self.file, &metadata);
        let (files, counts, full) = self.full.end();
        metadata.files.splice(0..0, files);
        for topic in &mut metadata.topics {
            topic.messages += counts.get(&topic.name).copied().unwrap_or(0);
        }
        let bytes = full? + last?;
        write_metadata(&self.directory, &metadata)?;
        let time = |nanos: u64| Time::from_nanos(i64::try_from(nanos).unwrap_or(i64::MAX));
        let bounds = join_bounds(metadata.files.iter().map(|file| file.bounds));
        Ok(BagSummary {
            path: self.directory.clone(),
            bytes,
            messages: metadata.files.iter().map(|file| file.messages).sum(),
            start: bounds.map(|(first, _)| time(first)),
            end: bounds.map(|(_, last)| time(last)),
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

fn file_path(directory: &Path, name: &str, number: usize) -> PathBuf {
    directory.join(format!("{name}_{number}.mcap"))
}

/// Begins a file. Like rosbag2, its record comes first without counts and last with
/// them: a recording that is cut off still says what it is.
fn begin_file(path: &Path, options: &BagOptions) -> Result<FileWriter, CreateBagError> {
    let mut file = FileWriter::create(path, options).map_err(|source| CreateBagError::Io {
        path: path.to_owned(),
        source,
    })?;
    let mut records = vec![rosbag2_record(&first_metadata(options))];
    records.extend(options.custom.iter().map(|(name, entries)| Metadata {
        name: name.clone(),
        metadata: entries.clone(),
    }));
    for record in &records {
        let written = file.metadata(record).and_then(|()| file.flush());
        if let Err(error) = written {
            // Nothing is lost with it; it would only be in the way.
            let _ = fs::remove_file(path);
            return Err(cannot_begin(path, &error));
        }
    }
    Ok(file)
}

/// What is known of a file before there is a message in it.
fn first_metadata(options: &BagOptions) -> BagMetadata {
    BagMetadata {
        custom_data: custom_data(&options.custom),
        ros_distro: options.ros_distro.clone(),
        ..BagMetadata::default()
    }
}

fn cannot_begin(path: &Path, error: &WriteBagError) -> CreateBagError {
    CreateBagError::Format {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}

/// Writes `metadata.yaml` whole or not at all.
pub(crate) fn write_metadata(
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

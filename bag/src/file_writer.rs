//! One MCAP file being written, for recording and for repair.

use std::{
    collections::BTreeMap,
    fs::File,
    io,
    path::{Path, PathBuf},
    sync::Arc,
};

use mcap::{
    McapError,
    records::{MessageHeader, Metadata},
};

use super::{
    definitions::{DefinitionWriter, Definitions},
    error::WriteBagError,
    metadata::FileEntry,
    options::{BagOptions, ChunkCompression},
    sink::{Sink, Storage, Stored},
    write_behind::WriteBehind,
};

/// The tool named in the file's header. It holds no version: the same
/// messages shall give the same bytes from one release to the next.
const LIBRARY: &str = "ferntast";

/// What a message costs in a chunk besides its data \[bytes\].
const MESSAGE_OVERHEAD: u64 = 31;

/// An MCAP file with profile `ros2`.
pub(crate) struct FileWriter<S: Storage = File> {
    /// `None` once closed.
    writer: Option<mcap::Writer<Sink<S>>>,
    store: Arc<WriteBehind<S>>,
    definitions: Definitions,
    definition_writer: DefinitionWriter,
    path: PathBuf,
    stored: Stored,
    chunk_size: u64,
    flush_interval: u64,
    /// Bytes of messages since the last chunk was closed.
    pending: u64,
    /// Log time of the first message since the last chunk was closed.
    pending_since: Option<u64>,
    /// Set while the disk refuses: the log time of the last attempt.
    refused_at: Option<u64>,
    bounds: Option<(u64, u64)>,
    counts: BTreeMap<u16, u64>,
}

impl FileWriter<File> {
    /// A new file; an existing one is refused.
    pub(crate) fn create(path: &Path, options: &BagOptions) -> io::Result<FileWriter<File>> {
        let file = File::options().write(true).create_new(true).open(path)?;
        FileWriter::over(file, path, options)
    }
}

impl<S: Storage> FileWriter<S> {
    /// A file over any store.
    pub(crate) fn over(store: S, path: &Path, options: &BagOptions) -> io::Result<FileWriter<S>> {
        let definitions = Definitions::default();
        let definition_writer = DefinitionWriter::new(definitions.clone()).map_err(into_io)?;
        let store = Arc::new(WriteBehind::begin(store)?);
        let sink = Sink::new(store.clone(), definitions.clone());
        let stored = sink.stored();
        let writer = mcap::WriteOptions::new()
            .profile("ros2")
            .library(LIBRARY)
            .compression(match options.compression {
                ChunkCompression::None => None,
                ChunkCompression::Zstd => Some(mcap::Compression::Zstd),
                ChunkCompression::Lz4 => Some(mcap::Compression::Lz4),
            })
            // Worker threads would cut the data where timing has it.
            .compression_threads(0)
            // Chunks are closed here, so that the disk sees whole ones only.
            .chunk_size(None)
            .disable_seeking(true)
            // Counted by the sink, which puts copies of the definitions in.
            .calculate_data_section_crc(false)
            .create(sink)
            .map_err(into_io)?;
        let mut file = FileWriter {
            writer: Some(writer),
            store,
            definitions,
            definition_writer,
            path: path.to_owned(),
            stored,
            chunk_size: options.chunk_size,
            flush_interval: options.flush_interval_ns,
            pending: 0,
            pending_since: None,
            refused_at: None,
            bounds: None,
            counts: BTreeMap::new(),
        };
        // A file killed right away still is an MCAP file.
        if let Some(writer) = &mut file.writer {
            writer.flush().map_err(into_io)?;
        }
        Ok(file)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes in the file.
    pub(crate) fn stored(&self) -> u64 {
        self.stored.bytes()
    }

    /// Messages by channel.
    pub(crate) fn counts(&self) -> &BTreeMap<u16, u64> {
        &self.counts
    }

    /// What `metadata.yaml` says of this file.
    pub(crate) fn entry(&self) -> FileEntry {
        FileEntry {
            name: self
                .path
                .file_name()
                .map(|name| name.to_string_lossy().into_owned())
                .unwrap_or_default(),
            bounds: self.bounds,
            messages: self.counts.values().sum(),
        }
    }

    /// Registers a schema; the same content gives the same number.
    pub(crate) fn schema(
        &mut self,
        name: &str,
        encoding: &str,
        text: &[u8],
    ) -> Result<u16, WriteBagError> {
        let id = self.with(|writer| writer.add_schema(name, encoding, text))?;
        let copy = self.definition_writer.writer();
        let copied = copy.add_schema_with_id(id, name, encoding, text);
        copied.map_err(|error| self.error(error))
    }

    /// Registers a channel; the same content gives the same number.
    pub(crate) fn channel(
        &mut self,
        schema: u16,
        topic: &str,
        message_encoding: &str,
        metadata: &BTreeMap<String, String>,
    ) -> Result<u16, WriteBagError> {
        let id =
            self.with(|writer| writer.add_channel(schema, topic, message_encoding, metadata))?;
        let copy = self.definition_writer.writer();
        let copied = copy.add_channel_with_id(id, schema, topic, message_encoding, metadata);
        copied.map_err(|error| self.error(error))
    }

    /// Writes a metadata record; closes the chunk.
    pub(crate) fn metadata(&mut self, metadata: &Metadata) -> Result<(), WriteBagError> {
        self.with(|writer| writer.write_metadata(metadata))
    }

    /// Writes a message and, when it is time, closes the chunk.
    pub(crate) fn message(
        &mut self,
        header: &MessageHeader,
        data: &[u8],
    ) -> Result<(), WriteBagError> {
        self.retry(header.log_time)?;
        self.with(|writer| writer.write_to_known_channel(header, data))?;
        *self.counts.entry(header.channel_id).or_insert(0) += 1;
        let (first, last) = self.bounds.unwrap_or((header.log_time, header.log_time));
        self.bounds = Some((first.min(header.log_time), last.max(header.log_time)));

        self.pending += MESSAGE_OVERHEAD + data.len() as u64;
        let since = *self.pending_since.get_or_insert(header.log_time);
        if self.pending >= self.chunk_size
            || header.log_time.saturating_sub(since) >= self.flush_interval
        {
            let flushed = self.flush();
            if flushed.is_err() {
                self.refused_at = Some(header.log_time);
            }
            return flushed;
        }
        Ok(())
    }

    /// While the disk refuses, nothing more is taken into memory; the waiting
    /// chunk is tried again once an interval.
    fn retry(&mut self, now: u64) -> Result<(), WriteBagError> {
        let Some(refused_at) = self.refused_at else {
            return Ok(());
        };
        if now.abs_diff(refused_at) < self.flush_interval {
            return Err(WriteBagError::DiskFull {
                path: self.path.clone(),
            });
        }
        self.refused_at = Some(now);
        self.flush()?;
        self.refused_at = None;
        Ok(())
    }

    /// Closes the chunk and hands it to the disk, which takes it when it can.
    pub(crate) fn flush(&mut self) -> Result<(), WriteBagError> {
        self.pending = 0;
        self.pending_since = None;
        self.with(|writer| writer.flush())
    }

    /// Writes the summary and closes the file. Bytes in the file.
    pub(crate) fn finish(&mut self) -> Result<u64, WriteBagError> {
        // With the chunks on disk first, a summary that finds no space leaves
        // a file that can be repaired.
        self.definitions.end();
        self.flush()?;
        let Some(mut writer) = self.writer.take() else {
            return Err(self.format("it is closed"));
        };
        let finished = writer.finish();
        let mut sink = writer.into_inner();
        finished.map_err(|error| self.error(error))?;
        io::Write::flush(&mut sink)
            .and_then(|()| self.store.sync())
            .map_err(|error| self.error(McapError::Io(error)))?;
        Ok(self.stored())
    }

    fn with<T>(
        &mut self,
        act: impl FnOnce(&mut mcap::Writer<Sink<S>>) -> Result<T, McapError>,
    ) -> Result<T, WriteBagError> {
        match &mut self.writer {
            Some(writer) => act(writer).map_err(|error| self.error(error)),
            None => Err(self.format("it is closed")),
        }
    }

    fn format(&self, reason: &str) -> WriteBagError {
        WriteBagError::Format {
            path: self.path.clone(),
            reason: reason.to_owned(),
        }
    }

    fn error(&self, error: McapError) -> WriteBagError {
        match error {
            McapError::Io(error) => match error.kind() {
                io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                    WriteBagError::DiskFull {
                        path: self.path.clone(),
                    }
                }
                _ => WriteBagError::Io {
                    path: self.path.clone(),
                    reason: error.to_string(),
                },
            },
            error => self.format(&error.to_string()),
        }
    }
}

impl<S: Storage> Drop for FileWriter<S> {
    fn drop(&mut self) {
        if self.writer.is_some() {
            let _ = self.finish();
        }
    }
}

fn into_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use mcap::MessageStream;

    use super::*;
    use crate::sink::tests::SmallDisk;

    const SECOND: u64 = 1_000_000_000;

    /// 100 messages a second that cannot be compressed.
    fn write(file: &mut FileWriter<SmallDisk>, channel: u16, k: u32) -> Result<(), WriteBagError> {
        let header = MessageHeader {
            channel_id: channel,
            sequence: k,
            log_time: SECOND + u64::from(k) * SECOND / 100,
            publish_time: 1,
        };
        let mut state = u64::from(k) + 1;
        let data: Vec<u8> = (0..200)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> 56) as u8
            })
            .collect();
        let written = file.message(&header, &data);
        // What a disk refuses is known at the next chunk.
        file.store.settle();
        written
    }

    fn begin(disk: &SmallDisk) -> (FileWriter<SmallDisk>, u16) {
        let path = Path::new("run_0.mcap");
        let options = BagOptions::default();
        let mut file = FileWriter::over(disk.clone(), path, &options).unwrap();
        let schema = file
            .schema("std_msgs/msg/String", "ros2msg", b"string data")
            .unwrap();
        let channel = file
            .channel(schema, "/text", "cdr", &BTreeMap::new())
            .unwrap();
        (file, channel)
    }

    /// The numbers of the messages on the disk; it may lack its end.
    fn numbers(disk: &SmallDisk) -> Vec<u32> {
        let content = disk.content.lock().unwrap();
        let options = mcap::read::Options::IgnoreEndMagic.into();
        MessageStream::new_with_options(&content, options)
            .unwrap()
            .map(|message| message.unwrap().sequence)
            .collect()
    }

    #[test]
    fn a_full_disk_loses_nothing_that_was_recorded() {
        let disk = SmallDisk::new(60_000);
        let (mut file, channel) = begin(&disk);
        let refused = (0..1000).find_map(|k| Some((k, write(&mut file, channel, k).err()?)));
        let (k, error) = refused.unwrap();
        assert!(matches!(error, WriteBagError::DiskFull { .. }), "{error}");
        assert!((250..370).contains(&k), "{k}");
        let kept = numbers(&disk);
        // All but what was refused and what came until that was known, half a second each.
        assert_eq!(kept, (0..kept.len() as u32).collect::<Vec<_>>());
        assert!(kept.len() as u32 >= k - 101, "{} of {k}", kept.len());

        // While it stays full, memory does not grow.
        for k in k + 1..k + 500 {
            assert!(write(&mut file, channel, k).is_err());
        }
        assert_eq!(file.entry().messages, u64::from(k) + 1);
        assert!(file.finish().is_err());
        assert_eq!(numbers(&disk), kept);
    }

    #[test]
    fn recording_goes_on_when_there_is_room_again() {
        let disk = SmallDisk::new(60_000);
        let (mut file, channel) = begin(&disk);
        let full = (0..1000)
            .find(|&k| write(&mut file, channel, k).is_err())
            .unwrap();
        *disk.size.lock().unwrap() = 1_000_000;
        let lost = (full + 1..1000)
            .filter(|&k| write(&mut file, channel, k).is_err())
            .count();
        // It tries again half a second later.
        assert_eq!(lost, 49);
        let bytes = file.finish().unwrap();
        assert_eq!(disk.content.lock().unwrap().len() as u64, bytes);
        assert_eq!(numbers(&disk).len(), 1000 - lost);
        assert_eq!(file.entry().messages as usize, 1000 - lost);
    }
}

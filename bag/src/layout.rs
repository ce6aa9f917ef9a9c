//! Where the messages of one MCAP file stand.

use std::{
    borrow::Cow,
    collections::{BTreeMap, btree_map::Entry},
    fs::File,
    io,
    path::{Path, PathBuf},
};

use mcap::{
    MAGIC, Schema,
    records::{Channel, ChunkIndex, Footer, Metadata, Record, SchemaHeader, Statistics, op},
};

use super::{
    block::{Block, BlockError, BlockKind, FRAME, Fault, for_each_record, frame, parse, read_at},
    error::OpenBagError,
};

/// The footer record with its frame \[bytes\].
const FOOTER: u64 = FRAME as u64 + 20;

/// Footer and magic number at a file's end \[bytes\].
pub(crate) const TAIL: u64 = FOOTER + 8;

/// An open file, its channels, and where its messages are.
#[derive(Debug)]
pub(crate) struct Layout {
    pub(crate) file: File,
    pub(crate) path: PathBuf,
    /// Size of the file \[bytes\].
    pub(crate) length: u64,
    pub(crate) schemas: BTreeMap<u16, Schema<'static>>,
    pub(crate) channels: BTreeMap<u16, Channel>,
    /// In the order of the file.
    pub(crate) blocks: Vec<Block>,
    pub(crate) statistics: Option<Statistics>,
    pub(crate) metadata: Vec<Metadata>,
    /// Whether the file has its end.
    pub(crate) closed: bool,
    /// What is broken, in the order of the file.
    pub(crate) faults: Vec<Fault>,
}

impl Layout {
    /// Checksum of the bytes from `start` to `end`.
    pub(crate) fn checksum(&self, start: u64, end: u64) -> Result<u32, OpenBagError> {
        const PIECE: u64 = 1 << 20;
        let mut hasher = crc32fast::Hasher::new();
        for offset in (start..end).step_by(PIECE as usize) {
            hasher.update(&self.bytes(offset, PIECE.min(end - offset))?);
        }
        Ok(hasher.finalize())
    }

    /// Opens a file that begins as an MCAP file.
    pub(crate) fn begin(path: &Path) -> Result<Layout, OpenBagError> {
        let owned = || path.to_owned();
        let io_error = |error: io::Error| match error.kind() {
            io::ErrorKind::NotFound => OpenBagError::Missing { path: owned() },
            _ => OpenBagError::Io {
                path: owned(),
                reason: error.to_string(),
            },
        };
        let file = File::open(path).map_err(io_error)?;
        let length = file.metadata().map_err(io_error)?.len();
        if length == 0 {
            return Err(OpenBagError::Empty { path: owned() });
        }
        let known = length.min(MAGIC.len() as u64) as usize;
        let layout = Layout {
            file,
            path: owned(),
            length,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            blocks: Vec::new(),
            statistics: None,
            metadata: Vec::new(),
            closed: false,
            faults: Vec::new(),
        };
        if layout.bytes(0, known as u64)? != MAGIC[..known] {
            return Err(OpenBagError::NotMcap { path: owned() });
        }
        Ok(layout)
    }

    /// The footer; `None` when the file does not end as one that was closed.
    pub(crate) fn footer(&self) -> Result<Option<Footer>, OpenBagError> {
        let Some(start) = self.length.checked_sub(TAIL).filter(|&start| start >= 8) else {
            return Ok(None);
        };
        let tail = self.bytes(start, TAIL)?;
        let (record, magic) = tail.split_at(FOOTER as usize);
        match parse(op::FOOTER, &record[FRAME..]) {
            Ok(Record::Footer(footer))
                if magic == MAGIC && frame(record) == Some((op::FOOTER, 20)) =>
            {
                Ok(Some(footer))
            }
            _ => Ok(None),
        }
    }

    /// Takes in what the summary that `footer` tells of says.
    pub(crate) fn read_summary(&mut self, footer: &Footer) -> Result<(), OpenBagError> {
        let end = self.length - TAIL;
        let offset = footer.summary_start;
        let fault = |reason: String| Fault { offset, reason };
        let Some(length) = end.checked_sub(offset).filter(|_| offset >= 8) else {
            let reason = "the summary is said to begin outside the file";
            return Err(self.damaged(fault(reason.to_owned())));
        };
        let summary = self.bytes(offset, length)?;
        // Of the footer, all that stands before the checksum counts.
        if footer.summary_crc != 0 && self.checksum(offset, end + FOOTER - 4)? != footer.summary_crc
        {
            return Err(self.damaged(fault("the summary's checksum is wrong".to_owned())));
        }
        let mut metadata = Vec::new();
        for_each_record(&summary, false, |opcode, body| {
            self.read_summary_record(opcode, body, &mut metadata)
        })
        .map_err(|reason| self.damaged(fault(reason)))?;
        for (offset, length) in metadata {
            let record = read_metadata(&self.file, offset, length);
            self.metadata
                .push(record.map_err(|error| self.error(error))?);
        }
        Ok(())
    }

    /// Takes what is of use of a record of the summary; where metadata records
    /// stand, offset and length, goes to `metadata`.
    fn read_summary_record(
        &mut self,
        opcode: u8,
        body: &[u8],
        metadata: &mut Vec<(u64, u64)>,
    ) -> Result<(), String> {
        match opcode {
            op::SCHEMA | op::CHANNEL | op::CHUNK_INDEX | op::STATISTICS | op::METADATA_INDEX => {}
            _ => return Ok(()),
        }
        match parse(opcode, body)? {
            Record::ChunkIndex(index) => {
                let block = chunk_block(&index);
                let end = block.offset.checked_add(block.length);
                if end.is_none_or(|end| end > self.length) {
                    return Err("the index points outside the file".to_owned());
                }
                self.blocks.push(block);
            }
            Record::Statistics(statistics) => self.statistics = Some(statistics),
            Record::MetadataIndex(index) => metadata.push((index.offset, index.length)),
            record => self.define(record)?,
        }
        Ok(())
    }

    /// Whether the summary says where all messages are and what they are.
    pub(crate) fn is_indexed(&self) -> bool {
        let Some(statistics) = &self.statistics else {
            return false;
        };
        let described = |channel: &Channel| {
            channel.schema_id == 0 || self.schemas.contains_key(&channel.schema_id)
        };
        self.channels.len() == statistics.channel_count as usize
            && self.channels.values().all(described)
            && (!self.blocks.is_empty() || statistics.message_count == 0)
    }

    /// Takes a schema or channel; a repetition must be the same.
    pub(crate) fn define(&mut self, record: Record<'_>) -> Result<(), String> {
        match record {
            Record::Schema { header, .. } if header.id == 0 => {
                Err("a schema has the number 0".to_owned())
            }
            Record::Schema { header, data } => {
                let SchemaHeader { id, name, encoding } = header;
                let data = Cow::Owned(data.into_owned());
                let schema = Schema {
                    id,
                    name,
                    encoding,
                    data,
                };
                take_once(&mut self.schemas, id, schema, "schema")
            }
            Record::Channel(channel) => {
                take_once(&mut self.channels, channel.id, channel, "channel")
            }
            _ => Ok(()),
        }
    }

    /// Reads bytes of the file.
    pub(crate) fn bytes(&self, offset: u64, length: u64) -> Result<Vec<u8>, OpenBagError> {
        read_at(&self.file, offset, length).map_err(|error| self.error(error))
    }

    fn error(&self, error: BlockError) -> OpenBagError {
        match error {
            BlockError::Fault(fault) => self.damaged(fault),
            BlockError::Io(error) => self.io_error(&error),
        }
    }

    pub(crate) fn io_error(&self, error: &io::Error) -> OpenBagError {
        OpenBagError::Io {
            path: self.path.clone(),
            reason: error.to_string(),
        }
    }

    pub(crate) fn damaged(&self, fault: Fault) -> OpenBagError {
        OpenBagError::Damaged {
            path: self.path.clone(),
            offset: fault.offset,
            reason: fault.reason,
        }
    }
}

fn chunk_block(index: &ChunkIndex) -> Block {
    Block {
        offset: index.chunk_start_offset,
        length: index.chunk_length,
        kind: BlockKind::Chunk,
        start: index.message_start_time,
        end: index.message_end_time,
        channels: (!index.message_index_offsets.is_empty())
            .then(|| index.message_index_offsets.keys().copied().collect()),
    }
}

fn take_once<T: PartialEq>(
    known: &mut BTreeMap<u16, T>,
    id: u16,
    record: T,
    what: &str,
) -> Result<(), String> {
    match known.entry(id) {
        Entry::Occupied(known) if *known.get() != record => {
            return Err(format!("{what} {id} is there twice, and unlike"));
        }
        Entry::Occupied(_) => {}
        Entry::Vacant(place) => {
            place.insert(record);
        }
    }
    Ok(())
}

/// The metadata record at `offset`; `length` counts its frame.
pub(crate) fn read_metadata(file: &File, offset: u64, length: u64) -> Result<Metadata, BlockError> {
    let bytes = read_at(file, offset, length)?;
    match (frame(&bytes), bytes.get(FRAME..)) {
        (Some((op::METADATA, _)), Some(body)) => match parse(op::METADATA, body) {
            Ok(Record::Metadata(metadata)) => Some(metadata),
            _ => None,
        },
        _ => None,
    }
    .ok_or_else(|| {
        BlockError::Fault(Fault {
            offset,
            reason: "a metadata record cannot be parsed".to_owned(),
        })
    })
}

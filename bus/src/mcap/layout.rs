//! Where the messages of one MCAP file stand.

use std::{
    collections::BTreeMap,
    fs::File,
    io,
    path::{Path, PathBuf},
};

use mcap::{
    MAGIC,
    records::{self, ChunkIndex, Metadata, Record, SchemaHeader, Statistics, op},
};

use super::{
    block::{Block, BlockError, BlockKind, Fault, describe, read_at},
    error::OpenBagError,
    records::{FRAME, Records, frame, u32_at},
    scan::scan,
};

/// The footer record with its frame \[bytes\].
const FOOTER: u64 = FRAME as u64 + 20;

/// The record that ends the data section, with its frame \[bytes\].
const DATA_END: u64 = FRAME as u64 + 4;

/// Footer and magic number at a file's end \[bytes\].
const TAIL: u64 = FOOTER + 8;

/// An open file, its channels, and where its messages are.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) file: File,
    pub(super) path: PathBuf,
    /// Size of the file \[bytes\].
    pub(super) length: u64,
    pub(super) schemas: BTreeMap<u16, Schema>,
    pub(super) channels: BTreeMap<u16, records::Channel>,
    /// In the order of the file.
    pub(super) blocks: Vec<Block>,
    pub(super) statistics: Option<Statistics>,
    pub(super) metadata: Vec<Metadata>,
    /// Whether the file has its end.
    pub(super) closed: bool,
    /// What is broken, in the order of the file.
    pub(super) faults: Vec<Fault>,
}

/// A schema record.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Schema {
    pub(super) name: String,
    pub(super) encoding: String,
    pub(super) text: Vec<u8>,
}

impl Layout {
    /// Opens a file that is whole.
    pub(super) fn open(path: &Path) -> Result<Layout, OpenBagError> {
        let mut layout = Layout::begin(path)?;
        let truncated = || OpenBagError::Truncated {
            path: path.to_owned(),
        };
        let footer = layout.footer()?.ok_or_else(truncated)?;
        layout.closed = true;
        if footer.summary_start != 0 {
            layout.read_summary(&footer)?;
            if layout.is_indexed() {
                layout.blocks.sort_by_key(|block| block.offset);
                return Ok(layout);
            }
        }
        // Closed, but without an index that could be used.
        let layout = scan(Layout::begin(path)?)?;
        match layout.faults.first() {
            Some(fault) => Err(layout.damaged(fault.clone())),
            None => Ok(layout),
        }
    }

    /// Opens a file as far as it can be read; reads all of it once.
    pub(super) fn salvage(path: &Path) -> Result<Layout, OpenBagError> {
        let mut layout = match Layout::open(path) {
            Err(OpenBagError::Truncated { .. } | OpenBagError::Damaged { .. }) => {
                return scan(Layout::begin(path)?);
            }
            opened => opened?,
        };
        let broken = layout.check_data()?;
        layout.faults.extend(broken);
        Ok(layout)
    }

    /// Compares the data section with its checksum, if it has one.
    fn check_data(&self) -> Result<Option<Fault>, OpenBagError> {
        let Some(footer) = self.footer()? else {
            return Ok(None);
        };
        let summary = match footer.summary_start {
            0 => self.length - TAIL,
            start => start,
        };
        let Some(end) = summary.checked_sub(DATA_END) else {
            return Ok(None);
        };
        let record = self.bytes(end, DATA_END)?;
        let Some(expected) = u32_at(&record, FRAME) else {
            return Ok(None);
        };
        if frame(&record) != Some((op::DATA_END, 4)) || expected == 0 {
            return Ok(None);
        }
        // Some writers count the magic number, some do not.
        for start in [0, MAGIC.len() as u64] {
            let mut hasher = crc32fast::Hasher::new();
            let mut offset = start;
            while offset < end {
                let length = (end - offset).min(1 << 20);
                hasher.update(&self.bytes(offset, length)?);
                offset += length;
            }
            if hasher.finalize() == expected {
                return Ok(None);
            }
        }
        Ok(Some(Fault {
            offset: end,
            reason: "the checksum of all data is wrong".to_owned(),
        }))
    }

    /// Opens a file that begins as an MCAP file.
    fn begin(path: &Path) -> Result<Layout, OpenBagError> {
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
    pub(super) fn footer(&self) -> Result<Option<records::Footer>, OpenBagError> {
        let Some(start) = self.length.checked_sub(TAIL).filter(|&start| start >= 8) else {
            return Ok(None);
        };
        let tail = self.bytes(start, TAIL)?;
        if tail[FOOTER as usize..] != *MAGIC || frame(&tail) != Some((op::FOOTER, 20)) {
            return Ok(None);
        }
        match mcap::parse_record(op::FOOTER, &tail[FRAME..FOOTER as usize]) {
            Ok(Record::Footer(footer)) => Ok(Some(footer)),
            _ => Ok(None),
        }
    }

    fn read_summary(&mut self, footer: &records::Footer) -> Result<(), OpenBagError> {
        let end = self.length - TAIL;
        let start = footer.summary_start;
        let fault = |reason: &str| Fault {
            offset: start,
            reason: reason.to_owned(),
        };
        let Some(length) = end.checked_sub(start).filter(|_| start >= 8) else {
            return Err(self.damaged(fault("the summary is said to begin outside the file")));
        };
        let summary = self.bytes(start, length)?;
        if footer.summary_crc != 0 {
            // Of the footer, all that stands before the checksum counts.
            let mut hasher = crc32fast::Hasher::new();
            hasher.update(&summary);
            hasher.update(&self.bytes(end, FOOTER - 4)?);
            if hasher.finalize() != footer.summary_crc {
                return Err(self.damaged(fault("the summary's checksum is wrong")));
            }
        }
        let mut records = Records::new(&summary);
        for record in &mut records {
            match self.read_summary_record(record.opcode, record.body) {
                Ok(()) => {}
                Err(BlockError::Fault(fault)) => return Err(self.damaged(fault)),
                Err(BlockError::Io(error)) => return Err(self.io_error(&error)),
            }
        }
        if records.left() > 0 {
            return Err(self.damaged(fault("the summary ends in the middle of a record")));
        }
        Ok(())
    }

    fn read_summary_record(&mut self, opcode: u8, body: &[u8]) -> Result<(), BlockError> {
        let offset = self.length - TAIL;
        let fault = |reason: String| BlockError::Fault(Fault { offset, reason });
        if !matches!(
            opcode,
            op::SCHEMA | op::CHANNEL | op::CHUNK_INDEX | op::STATISTICS | op::METADATA_INDEX
        ) {
            return Ok(());
        }
        let record = mcap::parse_record(opcode, body).map_err(|error| fault(describe(&error)))?;
        match record {
            Record::ChunkIndex(index) => {
                let block = chunk_block(&index);
                if block
                    .offset
                    .checked_add(block.length)
                    .is_none_or(|end| end > self.length)
                {
                    return Err(fault("the index points outside the file".to_owned()));
                }
                self.blocks.push(block);
                Ok(())
            }
            Record::Statistics(statistics) => {
                self.statistics = Some(statistics);
                Ok(())
            }
            Record::MetadataIndex(index) => {
                let metadata = read_metadata(&self.file, index.offset, index.length)?;
                self.metadata.push(metadata);
                Ok(())
            }
            record => self.define(record.into_owned()).map_err(fault),
        }
    }

    /// Whether the summary says where all messages are and what they are.
    fn is_indexed(&self) -> bool {
        let Some(statistics) = &self.statistics else {
            return false;
        };
        let described = |channel: &records::Channel| {
            channel.schema_id == 0 || self.schemas.contains_key(&channel.schema_id)
        };
        self.channels.len() == statistics.channel_count as usize
            && self.channels.values().all(described)
            && (!self.blocks.is_empty() || statistics.message_count == 0)
    }

    /// Takes a schema or channel; a repetition must be the same.
    pub(super) fn define(&mut self, record: Record<'static>) -> Result<(), String> {
        match record {
            Record::Schema { header, data } => {
                let SchemaHeader { id, name, encoding } = header;
                let text = data.into_owned();
                let schema = Schema {
                    name,
                    encoding,
                    text,
                };
                if id == 0 {
                    return Err("a schema has the number 0".to_owned());
                }
                let known = self.schemas.entry(id).or_insert_with(|| schema.clone());
                if *known != schema {
                    return Err(format!("schema {id} is there twice, and unlike"));
                }
            }
            Record::Channel(channel) => {
                let known = self
                    .channels
                    .entry(channel.id)
                    .or_insert_with(|| channel.clone());
                if *known != channel {
                    return Err(format!("channel {} is there twice, and unlike", channel.id));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Reads bytes of the file.
    pub(super) fn bytes(&self, offset: u64, length: u64) -> Result<Vec<u8>, OpenBagError> {
        read_at(&self.file, offset, length).map_err(|error| match error {
            BlockError::Fault(fault) => self.damaged(fault),
            BlockError::Io(error) => self.io_error(&error),
        })
    }

    pub(super) fn io_error(&self, error: &io::Error) -> OpenBagError {
        OpenBagError::Io {
            path: self.path.clone(),
            reason: error.to_string(),
        }
    }

    fn damaged(&self, fault: Fault) -> OpenBagError {
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

/// The metadata record at `offset`; `length` counts its frame.
pub(super) fn read_metadata(file: &File, offset: u64, length: u64) -> Result<Metadata, BlockError> {
    let bytes = read_at(file, offset, length)?;
    let parsed = match Records::new(&bytes).next() {
        Some(record) if record.opcode == op::METADATA => {
            mcap::parse_record(op::METADATA, record.body).ok()
        }
        _ => None,
    };
    match parsed {
        Some(Record::Metadata(metadata)) => Ok(metadata),
        _ => Err(BlockError::Fault(Fault {
            offset,
            reason: "a metadata record cannot be parsed".to_owned(),
        })),
    }
}

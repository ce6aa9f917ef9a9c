//! Parts of a file's data section and the messages in them.

use std::{collections::BTreeSet, fs::File, io, os::unix::fs::FileExt};

use mcap::{
    McapError,
    records::{Record, op},
    sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

use super::records::{
    FRAME, LARGEST_RECORD, MESSAGE_HEADER, MessageHeader, Records, frame, message_header,
};

/// A part of a file's data section.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Where it begins \[byte\].
    pub(super) offset: u64,
    /// How long it is \[bytes\].
    pub(super) length: u64,
    pub(super) kind: BlockKind,
    /// Log time of its first and last message, as the file says \[ns\].
    pub(super) start: u64,
    pub(super) end: u64,
    /// The channels that have messages in it; `None` where unknown.
    pub(super) channels: Option<BTreeSet<u16>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BlockKind {
    /// A whole chunk.
    Chunk,
    /// A chunk at the end of a file that was cut off.
    CutChunk,
    /// Records outside any chunk.
    Plain,
}

/// The messages of a block in the order of their log time; those of the same
/// log time in the order of the file.
#[derive(Debug, Default)]
pub(super) struct DecodedBlock {
    /// Where it begins in its file \[byte\].
    offset: u64,
    bytes: Vec<u8>,
    pub(super) entries: Vec<Entry>,
}

/// One message of a decoded block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) header: MessageHeader,
    start: usize,
    end: usize,
}

impl DecodedBlock {
    /// Where the message stands in its file: ascending in the order in which
    /// messages were written.
    pub(super) fn place(&self, entry: &Entry) -> (u64, usize) {
        (self.offset, entry.start)
    }

    /// The message's CDR.
    pub(super) fn data(&self, entry: &Entry) -> &[u8] {
        self.bytes.get(entry.start..entry.end).unwrap_or_default()
    }

    /// Memory that it takes \[bytes\].
    pub(super) fn size(&self) -> usize {
        self.bytes.len() + self.entries.len() * size_of::<Entry>()
    }
}

/// What is wrong with a part of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    /// Where \[byte\].
    pub(super) offset: u64,
    pub(super) reason: String,
}

/// Why a block gives no messages.
#[derive(Debug)]
pub(super) enum BlockError {
    Io(io::Error),
    Fault(Fault),
}

/// Reads `length` bytes at `offset`.
pub(super) fn read_at(file: &File, offset: u64, length: u64) -> Result<Vec<u8>, BlockError> {
    let fault = |reason: String| BlockError::Fault(Fault { offset, reason });
    let length = match usize::try_from(length) {
        Ok(length) if length <= LARGEST_RECORD => length,
        _ => {
            return Err(fault(format!(
                "{length} bytes in one record are more than the {LARGEST_RECORD} that are read"
            )));
        }
    };
    let mut bytes = vec![0; length];
    match file.read_exact_at(&mut bytes, offset) {
        Ok(()) => Ok(bytes),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
            Err(fault("the file ends in the middle of a record".to_owned()))
        }
        Err(error) => Err(BlockError::Io(error)),
    }
}

/// The messages of `block`. Schemas and channels that stand in it go to
/// `definitions`. Of a [`BlockKind::CutChunk`] what is left of it.
pub(super) fn decode(
    file: &File,
    block: &Block,
    definitions: &mut Vec<Record<'static>>,
) -> Result<DecodedBlock, BlockError> {
    let fault = |reason: String| {
        BlockError::Fault(Fault {
            offset: block.offset,
            reason,
        })
    };
    let bytes = read_at(file, block.offset, block.length)?;
    let mut decoded = match block.kind {
        BlockKind::Plain => plain(bytes, definitions),
        BlockKind::Chunk => match frame(&bytes) {
            Some((op::CHUNK, length)) if length.checked_add(FRAME as u64) == Some(block.length) => {
                let mut decoded = DecodedBlock::default();
                unpack(&bytes, true, &mut decoded, definitions).map(|()| decoded)
            }
            _ => Err("the index points at something that is no chunk".to_owned()),
        },
        BlockKind::CutChunk => {
            let mut decoded = DecodedBlock::default();
            // That it ends in an error is known; what came before counts.
            let _ = unpack(&bytes, false, &mut decoded, definitions);
            Ok(decoded)
        }
    }
    .map_err(fault)?;
    decoded.offset = block.offset;
    decoded.entries.sort_by_key(|entry| entry.header.log_time);
    Ok(decoded)
}

fn plain(bytes: Vec<u8>, definitions: &mut Vec<Record<'static>>) -> Result<DecodedBlock, String> {
    let mut entries = Vec::new();
    let mut position = 0;
    let mut records = Records::new(&bytes);
    for record in &mut records {
        let body = position + FRAME;
        position = body + record.body.len();
        match record.opcode {
            op::MESSAGE => entries.push(entry(record.body, body)?),
            opcode => define(opcode, record.body, definitions)?,
        }
    }
    if records.left() > 0 {
        return Err("a record is longer than the data it stands in".to_owned());
    }
    Ok(DecodedBlock {
        offset: 0,
        bytes,
        entries,
    })
}

/// Unpacks the chunk record in `bytes`; with `check` its checksum is compared
/// before anything counts.
fn unpack(
    bytes: &[u8],
    check: bool,
    decoded: &mut DecodedBlock,
    definitions: &mut Vec<Record<'static>>,
) -> Result<(), String> {
    let mut options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_record_length_limit(LARGEST_RECORD);
    if check {
        options = options.with_prevalidate_chunk_crcs(true);
    }
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = bytes;
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| describe(&error))? {
            LinearReadEvent::ReadRequest(wanted) => {
                let (taken, left) = rest.split_at(wanted.min(rest.len()));
                reader.insert(taken.len()).copy_from_slice(taken);
                reader.notify_read(taken.len());
                rest = left;
            }
            LinearReadEvent::Record { data, opcode } => match opcode {
                op::MESSAGE => {
                    if decoded.bytes.len() + data.len() > LARGEST_RECORD {
                        return Err(format!(
                            "the chunk holds more than the {LARGEST_RECORD} bytes that are read"
                        ));
                    }
                    let entry = entry(data, decoded.bytes.len())?;
                    decoded.bytes.extend_from_slice(data);
                    decoded.entries.push(entry);
                }
                opcode => define(opcode, data, definitions)?,
            },
        }
    }
    Ok(())
}

/// The message in `body`, which stands at `start` of the block's bytes.
fn entry(body: &[u8], start: usize) -> Result<Entry, String> {
    let header = message_header(body).ok_or("a message has no header")?;
    Ok(Entry {
        header,
        start: start + MESSAGE_HEADER,
        end: start + body.len(),
    })
}

/// Keeps a schema or channel; other records are of no use here. They are
/// parsed only when they are wanted: the parser does not take every garbage.
fn define(opcode: u8, body: &[u8], definitions: &mut Vec<Record<'static>>) -> Result<(), String> {
    if matches!(opcode, op::SCHEMA | op::CHANNEL) {
        let record = mcap::parse_record(opcode, body).map_err(|error| describe(&error))?;
        definitions.push(record.into_owned());
    }
    Ok(())
}

/// The library's error with its cause, in one line.
pub(super) fn describe(error: &McapError) -> String {
    match error {
        McapError::Parse(_) => "a record cannot be parsed".to_owned(),
        McapError::Io(cause) => format!("cannot be unpacked: {cause}"),
        error => error.to_string(),
    }
}

//! Parts of a file's data section and the messages in them.

use std::{collections::BTreeSet, fs::File, io, os::unix::fs::FileExt};

use mcap::{
    McapError,
    records::{MessageHeader, Record, op},
    sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

/// Opcode and length in front of every record \[bytes\].
pub(crate) const FRAME: usize = 9;

/// Channel, sequence, log time and publish time in front of a message's data \[bytes\].
pub(crate) const MESSAGE_HEADER: usize = 22;

/// The longest record and the largest chunk that is read \[bytes\]: what
/// garbage may claim must not exhaust the memory. rosbag2's chunks have less
/// than 1 MiB.
const MAX_RECORD: usize = 256 << 20;

/// A part of a file's data section.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Where it begins \[byte\].
    pub(crate) offset: u64,
    /// How long it is \[bytes\].
    pub(crate) length: u64,
    pub(crate) kind: BlockKind,
    /// Log time of its first and last message, as the file says \[ns\].
    pub(crate) start: u64,
    pub(crate) end: u64,
    /// The channels that have messages in it; `None` where unknown.
    pub(crate) channels: Option<BTreeSet<u16>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BlockKind {
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
pub(crate) struct DecodedBlock {
    /// Where it begins in its file \[byte\].
    offset: u64,
    bytes: Vec<u8>,
    pub(crate) entries: Vec<Entry>,
}

/// One message of a decoded block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) header: MessageHeader,
    start: usize,
    end: usize,
}

impl DecodedBlock {
    /// Where the message stands in its file: ascending in the order in which
    /// messages were written.
    pub(crate) fn place(&self, entry: &Entry) -> (u64, usize) {
        (self.offset, entry.start)
    }

    /// The message's CDR.
    pub(crate) fn data(&self, entry: &Entry) -> &[u8] {
        self.bytes.get(entry.start..entry.end).unwrap_or_default()
    }

    /// Memory that it takes \[bytes\].
    pub(crate) fn size(&self) -> usize {
        self.bytes.len() + self.entries.len() * size_of::<Entry>()
    }

    /// Appends the message record whose content is `body`.
    fn push(&mut self, body: &[u8]) -> Result<(), String> {
        let header = message_header(body).ok_or("a message has no header")?;
        let data = &body[MESSAGE_HEADER..];
        if self.bytes.len() + data.len() > MAX_RECORD {
            return Err(format!(
                "the chunk holds more than the {MAX_RECORD} bytes that are read"
            ));
        }
        let start = self.bytes.len();
        self.bytes.extend_from_slice(data);
        self.entries.push(Entry {
            header,
            start,
            end: self.bytes.len(),
        });
        Ok(())
    }
}

/// What is wrong with a part of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    /// Where \[byte\].
    pub(crate) offset: u64,
    pub(crate) reason: String,
}

/// Why a block gives no messages.
#[derive(Debug)]
pub(crate) enum BlockError {
    Io(io::Error),
    Fault(Fault),
}

/// Reads `length` bytes at `offset`.
pub(crate) fn read_at(file: &File, offset: u64, length: u64) -> Result<Vec<u8>, BlockError> {
    let fault = |reason: String| BlockError::Fault(Fault { offset, reason });
    let length = match usize::try_from(length) {
        Ok(length) if length <= MAX_RECORD => length,
        _ => {
            return Err(fault(format!(
                "{length} bytes in one record are more than the {MAX_RECORD} that are read"
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
pub(crate) fn decode(
    file: &File,
    block: &Block,
    definitions: &mut Vec<Record<'static>>,
) -> Result<DecodedBlock, BlockError> {
    let bytes = read_at(file, block.offset, block.length)?;
    let is_chunk = frame(&bytes).is_some_and(|(opcode, length)| {
        opcode == op::CHUNK && length.checked_add(FRAME as u64) == Some(block.length)
    });
    let mut decoded = DecodedBlock {
        offset: block.offset,
        ..DecodedBlock::default()
    };
    let read = match block.kind {
        BlockKind::Chunk if !is_chunk => {
            Err("the index points at something that is no chunk".to_owned())
        }
        // With its checksum compared before anything counts, where it is whole.
        kind => for_each_record(
            &bytes,
            kind == BlockKind::Chunk,
            |opcode, body| match opcode {
                op::MESSAGE => decoded.push(body),
                op::SCHEMA | op::CHANNEL => {
                    definitions.push(parse(opcode, body)?.into_owned());
                    Ok(())
                }
                _ => Ok(()),
            },
        ),
    };
    match read {
        // That it ends in an error is known; what came before counts.
        Err(reason) if block.kind != BlockKind::CutChunk => Err(BlockError::Fault(Fault {
            offset: block.offset,
            reason,
        })),
        _ => {
            decoded.entries.sort_by_key(|entry| entry.header.log_time);
            Ok(decoded)
        }
    }
}

/// Hands opcode and content of every record in `bytes` to `each`, and in place
/// of a chunk the records in it; `check` compares its checksum first.
pub(crate) fn for_each_record(
    bytes: &[u8],
    check: bool,
    mut each: impl FnMut(u8, &[u8]) -> Result<(), String>,
) -> Result<(), String> {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_record_length_limit(MAX_RECORD)
        .with_prevalidate_chunk_crcs(check);
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
            LinearReadEvent::Record { data, opcode } => each(opcode, data)?,
        }
    }
    Ok(())
}

/// Opcode and length of the record at the front of `bytes`.
pub(crate) fn frame(bytes: &[u8]) -> Option<(u8, u64)> {
    let (opcode, rest) = bytes.split_first()?;
    Some((*opcode, u64::from_le_bytes(*rest.first_chunk()?)))
}

/// The header in a message record's content; `None` when that is too short.
pub(crate) fn message_header(body: &[u8]) -> Option<MessageHeader> {
    match mcap::parse_record(op::MESSAGE, body) {
        Ok(Record::Message { header, .. }) => Some(header),
        _ => None,
    }
}

/// The record with that content. Records are parsed only where they are
/// wanted: the library's parser panics at an attachment that is too short.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, String> {
    mcap::parse_record(opcode, body).map_err(|error| describe(&error))
}

/// The library's error with its cause, in one line.
fn describe(error: &McapError) -> String {
    match error {
        McapError::Parse(_) => "a record cannot be parsed".to_owned(),
        McapError::Io(cause) => format!("cannot be unpacked: {cause}"),
        error => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_record_ends_in_an_error_behind_what_is_whole() {
        let mut bytes = vec![0x80, 2, 0, 0, 0, 0, 0, 0, 0, 0xAA, 0xBB];
        let mut read = Vec::new();
        let whole = for_each_record(&bytes, true, |opcode, body| {
            read.push((opcode, body.to_vec()));
            Ok(())
        });
        assert_eq!((whole, read), (Ok(()), vec![(0x80, vec![0xAA, 0xBB])]));
        for cut in [
            &[5, 200, 0, 0, 0, 0, 0, 0, 0, 1][..],
            &[5, 255, 255, 255, 255, 255, 255, 255, 255, 0],
        ] {
            bytes.truncate(11);
            bytes.extend(cut);
            let mut records = 0;
            let read = for_each_record(&bytes, true, |_, _| {
                records += 1;
                Ok(())
            });
            assert!(read.is_err());
            assert_eq!(records, 1);
        }
    }

    #[test]
    fn a_message_header_is_22_bytes() {
        let mut body = vec![3, 0, 9, 0, 0, 0];
        body.extend(11_u64.to_le_bytes());
        body.extend(12_u64.to_le_bytes());
        let header = MessageHeader {
            channel_id: 3,
            sequence: 9,
            log_time: 11,
            publish_time: 12,
        };
        assert_eq!(message_header(&body), Some(header));
        assert_eq!(body.len(), MESSAGE_HEADER);
        assert_eq!(message_header(&body[..21]), None);
    }
}

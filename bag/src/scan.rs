//! Finding the messages of a file without its index, up to where it breaks.

use std::{
    fs::File,
    io::{self, BufReader, Read, Seek, SeekFrom},
};

use mcap::{
    MAGIC,
    records::{Record, op},
};

use super::{
    block::{
        Block, BlockError, BlockKind, FRAME, Fault, MESSAGE_HEADER, decode, frame, message_header,
    },
    chunk_search::next_chunk,
    error::OpenBagError,
    layout::{Layout, read_metadata},
};

/// Messages outside chunks are taken together up to this length \[bytes\].
const PLAIN_BLOCK: u64 = 1 << 20;

/// Goes through the records of `layout`'s file from the front; what it finds
/// replaces what the layout holds. Every chunk is unpacked once: one that is
/// broken is left out, and what is left of a last one that was cut is kept.
/// Schemas and channels in chunks, which have a checksum, come before those
/// outside.
pub(crate) fn scan(mut layout: Layout) -> Result<Layout, OpenBagError> {
    let file = match layout.file.try_clone() {
        Ok(file) => file,
        Err(error) => return Err(layout.io_error(&error)),
    };
    let mut reader = BufReader::new(file);
    let mut scanner = Scanner {
        offset: MAGIC.len() as u64,
        plain: None,
        plain_definitions: Vec::new(),
    };
    if let Err(error) = scanner.run(&mut layout, &mut reader) {
        return Err(layout.io_error(&error));
    }
    for (offset, definitions) in scanner.plain_definitions {
        define(&mut layout, offset, definitions);
    }
    Ok(layout)
}

struct Scanner {
    offset: u64,
    /// The messages outside chunks that are being gathered.
    plain: Option<Block>,
    /// Schemas and channels outside chunks, and where they stand.
    plain_definitions: Vec<(u64, Vec<Record<'static>>)>,
}

impl Scanner {
    fn run(&mut self, layout: &mut Layout, reader: &mut BufReader<File>) -> io::Result<()> {
        reader.seek(SeekFrom::Start(self.offset))?;
        loop {
            let left = layout.length.saturating_sub(self.offset);
            if left == 0 {
                self.stop(layout, "the file ends without an end: it was not closed");
                return Ok(());
            }
            let mut head = [0; FRAME];
            if left < FRAME as u64 {
                self.stop(layout, "the file ends in the middle of a record");
                return Ok(());
            }
            reader.read_exact(&mut head)?;
            let Some((opcode, body)) = frame(&head) else {
                return Ok(());
            };
            let whole = body <= left - FRAME as u64;
            let no_record = opcode == 0 || (op::DATA_END < opcode && opcode < 0x80);
            if no_record || !whole {
                if opcode == op::CHUNK {
                    self.chunk(layout, left, BlockKind::CutChunk)?;
                }
                let reason = match no_record {
                    true => "this is no record",
                    false => "the file ends in the middle of a record",
                };
                self.stop(layout, reason);
                // Where only a record's head is damaged, whole chunks follow.
                let Some(next) = next_chunk(&layout.file, self.offset + 1, layout.length)? else {
                    return Ok(());
                };
                self.offset = next;
                reader.seek(SeekFrom::Start(next))?;
                continue;
            }
            let length = body + FRAME as u64;
            if !matches!(opcode, op::MESSAGE | op::SCHEMA | op::CHANNEL) {
                self.close_plain(layout);
            }
            match opcode {
                op::DATA_END | op::FOOTER => {
                    match layout.footer() {
                        Ok(Some(_)) => layout.closed = true,
                        _ => self.stop(layout, "the file's summary is missing or cut"),
                    }
                    return Ok(());
                }
                op::CHUNK => self.chunk(layout, length, BlockKind::Chunk)?,
                op::MESSAGE => {
                    let mut header = [0; MESSAGE_HEADER];
                    if body < MESSAGE_HEADER as u64 {
                        self.stop(layout, "a message has no header");
                        return Ok(());
                    }
                    reader.read_exact(&mut header)?;
                    if let Some(header) = message_header(&header) {
                        self.message(layout, length, header.channel_id, header.log_time);
                    }
                    reader.seek_relative(-(MESSAGE_HEADER as i64))?;
                }
                op::METADATA => match read_metadata(&layout.file, self.offset, length) {
                    Ok(metadata) => layout.metadata.push(metadata),
                    Err(error) => note(layout, error)?,
                },
                op::SCHEMA | op::CHANNEL => {
                    let offset = self.offset;
                    let record = block(offset, length, BlockKind::Plain);
                    let mut definitions = Vec::new();
                    match decode(&layout.file, &record, &mut definitions) {
                        Ok(_) => self.plain_definitions.push((offset, definitions)),
                        Err(error) => note(layout, error)?,
                    }
                }
                _ => {}
            }
            // `whole` bounds the length by the file's.
            reader.seek_relative(body as i64)?;
            self.offset += length;
        }
    }

    fn chunk(&mut self, layout: &mut Layout, length: u64, kind: BlockKind) -> io::Result<()> {
        self.close_plain(layout);
        let mut block = block(self.offset, length, kind);
        let mut definitions = Vec::new();
        match decode(&layout.file, &block, &mut definitions) {
            Ok(decoded) => {
                define(layout, self.offset, definitions);
                let times = || decoded.entries.iter().map(|entry| entry.header.log_time);
                block.start = times().min().unwrap_or(0);
                block.end = times().max().unwrap_or(0);
                let channels = decoded.entries.iter().map(|entry| entry.header.channel_id);
                block.channels = Some(channels.collect());
                if !decoded.entries.is_empty() {
                    layout.blocks.push(block);
                }
                Ok(())
            }
            Err(error) => note(layout, error),
        }
    }

    fn message(&mut self, layout: &mut Layout, length: u64, channel: u16, log_time: u64) {
        let gathered = self.plain.get_or_insert_with(|| Block {
            start: log_time,
            end: log_time,
            channels: Some(Default::default()),
            ..block(self.offset, 0, BlockKind::Plain)
        });
        gathered.start = gathered.start.min(log_time);
        gathered.end = gathered.end.max(log_time);
        if let Some(channels) = &mut gathered.channels {
            channels.insert(channel);
        }
        gathered.length = self.offset + length - gathered.offset;
        if gathered.length >= PLAIN_BLOCK {
            self.close_plain(layout);
        }
    }

    fn close_plain(&mut self, layout: &mut Layout) {
        layout.blocks.extend(self.plain.take());
    }

    fn stop(&mut self, layout: &mut Layout, reason: &str) {
        self.close_plain(layout);
        layout.faults.push(Fault {
            offset: self.offset,
            reason: reason.to_owned(),
        });
    }
}

fn block(offset: u64, length: u64, kind: BlockKind) -> Block {
    Block {
        offset,
        length,
        kind,
        start: 0,
        end: 0,
        channels: None,
    }
}

fn define(layout: &mut Layout, offset: u64, definitions: Vec<Record<'static>>) {
    for record in definitions {
        if let Err(reason) = layout.define(record) {
            layout.faults.push(Fault { offset, reason });
        }
    }
}

fn note(layout: &mut Layout, error: BlockError) -> io::Result<()> {
    match error {
        BlockError::Fault(fault) => {
            layout.faults.push(fault);
            Ok(())
        }
        BlockError::Io(error) => Err(error),
    }
}

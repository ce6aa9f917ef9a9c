//! Schemas and channels, repeated outside the chunks.
//!
//! The MCAP writer puts each into the chunk that was open when it was added,
//! and into the summary when the file is closed: a file that was cut off, and
//! whose first chunk is damaged, could not be read at all. Copies as plain
//! records between chunks, which MCAP allows, let every chunk do without the
//! others.

use std::{
    io::{self, Seek, SeekFrom, Write},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use mcap::McapError;

/// The next copy comes when the file has grown by this many times its length:
/// copies take less than one percent.
const SPACING: u64 = 128;

/// The records of all schemas and channels so far. A clone is another handle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Definitions(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    /// All records, one behind the other.
    records: Vec<u8>,
    /// Bytes of them in the last copy.
    copied: usize,
    /// Where the next copy of the same records is due \[byte of the file\].
    due: u64,
    /// Whether the summary comes next, which holds them too.
    ended: bool,
}

impl Definitions {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A copy for a file of `length` bytes that ends behind a chunk, if one is due.
    pub(crate) fn copy_due(&self, length: u64) -> Option<Vec<u8>> {
        let mut state = self.lock();
        let is_new = state.records.len() > state.copied;
        if state.ended || state.records.is_empty() || !(is_new || length >= state.due) {
            return None;
        }
        state.copied = state.records.len();
        state.due = length + SPACING * state.records.len() as u64;
        Some(state.records.clone())
    }

    /// No further copy: the summary comes next.
    pub(crate) fn end(&self) {
        self.lock().ended = true;
    }
}

/// Takes records as the MCAP library writes them.
impl Write for Definitions {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.lock().records.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The library only asks where it is.
impl Seek for Definitions {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) | SeekFrom::End(0) => Ok(self.lock().records.len() as u64),
            _ => Err(io::Error::from(io::ErrorKind::Unsupported)),
        }
    }
}

/// Writes the records of schemas and channels into [`Definitions`].
pub(crate) struct DefinitionWriter {
    writer: mcap::Writer<Definitions>,
}

impl DefinitionWriter {
    /// A writer into `definitions`, which are empty.
    pub(crate) fn new(definitions: Definitions) -> Result<DefinitionWriter, McapError> {
        let writer = mcap::WriteOptions::new()
            .use_chunks(false)
            .create(definitions.clone())?;
        // Magic number and header are the file's own.
        definitions.lock().records.clear();
        Ok(DefinitionWriter { writer })
    }

    /// The writer: of use are its schemas and channels only.
    pub(crate) fn writer(&mut self) -> &mut mcap::Writer<Definitions> {
        &mut self.writer
    }
}

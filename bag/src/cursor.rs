//! The messages of several files in the order of log time, a block at a time.

use std::{
    collections::{BTreeSet, VecDeque},
    sync::{Arc, Mutex, PoisonError},
};

use super::{
    block::{BlockError, DecodedBlock, Entry, Fault, decode},
    error::ReadMessageError,
    layout::Layout,
};

/// Unpacked blocks that are kept for other readers of the same recording.
const CACHED_BLOCKS: usize = 4;

/// Memory that blocks overlapping in time may take together \[bytes\]. Files
/// are written about in the order of time, so one or two blocks do; an index
/// that says otherwise is broken.
const MAX_OVERLAP: usize = 1 << 30;

/// One file, shared by all that read it.
#[derive(Debug)]
pub(crate) struct SharedFile {
    pub(crate) layout: Layout,
    cache: Mutex<VecDeque<(usize, Arc<DecodedBlock>)>>,
}

impl SharedFile {
    pub(crate) fn new(layout: Layout) -> SharedFile {
        SharedFile {
            layout,
            cache: Mutex::new(VecDeque::with_capacity(CACHED_BLOCKS)),
        }
    }

    /// The block of that index, unpacked.
    pub(crate) fn load(&self, index: usize) -> Result<Arc<DecodedBlock>, ReadMessageError> {
        // A poisoned lock only says that another reader panicked; the cache
        // holds whole blocks at any time.
        let mut cache = self.cache.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, block)) = cache.iter().find(|(cached, _)| *cached == index) {
            return Ok(block.clone());
        }
        let Some(block) = self.layout.blocks.get(index) else {
            return Ok(Arc::default());
        };
        // All definitions are known from the summary or the scan.
        let decoded = decode(&self.layout.file, block, &mut Vec::new());
        let decoded = Arc::new(decoded.map_err(|error| self.error(error))?);
        if cache.len() >= CACHED_BLOCKS {
            cache.pop_front();
        }
        cache.push_back((index, decoded.clone()));
        Ok(decoded)
    }

    fn error(&self, error: BlockError) -> ReadMessageError {
        let path = self.layout.path.clone();
        match error {
            BlockError::Fault(Fault { offset, reason }) => ReadMessageError::Damaged {
                path,
                offset,
                reason,
            },
            BlockError::Io(error) => ReadMessageError::Io {
                path,
                reason: error.to_string(),
            },
        }
    }
}

/// A message where it stands.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Which of the files.
    pub(crate) file: usize,
    pub(crate) block: Arc<DecodedBlock>,
    pub(crate) entry: Entry,
}

/// A block of a file.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    /// Log time of its first message, as the file says \[ns\].
    start: u64,
    file: usize,
    index: usize,
}

/// A block that is being read.
#[derive(Debug)]
struct Active {
    file: usize,
    index: usize,
    block: Arc<DecodedBlock>,
    position: usize,
}

impl Active {
    fn entry(&self) -> Option<Entry> {
        self.block.entries.get(self.position).copied()
    }
}

/// Goes through several files at once.
#[derive(Debug)]
pub(crate) struct Cursor {
    files: Vec<Arc<SharedFile>>,
    /// The channels wanted of each file; `None` for all.
    channels: Option<Vec<BTreeSet<u16>>>,
    /// Messages logged before are passed over \[ns\].
    from: u64,
    /// Blocks not read yet, in the order of their first log time.
    waiting: VecDeque<Waiting>,
    active: Vec<Active>,
}

impl Cursor {
    /// `channels` are those wanted of each file, `None` for all; messages
    /// logged before `from` \[ns\] are passed over.
    pub(crate) fn new(
        files: &[Arc<SharedFile>],
        channels: Option<Vec<BTreeSet<u16>>>,
        from: u64,
    ) -> Cursor {
        let mut cursor = Cursor {
            files: files.to_vec(),
            channels,
            from,
            waiting: VecDeque::new(),
            active: Vec::new(),
        };
        let mut waiting = Vec::new();
        for (file, shared) in files.iter().enumerate() {
            for (index, block) in shared.layout.blocks.iter().enumerate() {
                let wanted = |channels: &BTreeSet<u16>| {
                    channels.iter().any(|&channel| cursor.wants(file, channel))
                };
                if block.end >= from && block.channels.as_ref().is_none_or(wanted) {
                    let start = block.start;
                    waiting.push(Waiting { start, file, index });
                }
            }
        }
        waiting.sort_by_key(|block| (block.start, block.file, block.index));
        cursor.waiting = waiting.into();
        cursor
    }

    fn wants(&self, file: usize, channel: u16) -> bool {
        self.channels.as_ref().is_none_or(|files| {
            files
                .get(file)
                .is_some_and(|wanted| wanted.contains(&channel))
        })
    }

    /// Log time of the next message \[ns\]; `None` at the end.
    pub(crate) fn peek(&mut self) -> Result<Option<u64>, ReadMessageError> {
        Ok(self.first()?.map(|(log_time, _)| log_time))
    }

    /// Takes the next message; `None` at the end. After an error reading goes
    /// on behind the fault.
    pub(crate) fn take(&mut self) -> Result<Option<Found>, ReadMessageError> {
        let Some((_, place)) = self.first()? else {
            return Ok(None);
        };
        let Some(active) = self.active.get_mut(place) else {
            return Ok(None);
        };
        let found = active.entry().map(|entry| Found {
            file: active.file,
            block: active.block.clone(),
            entry,
        });
        active.position += 1;
        self.settle(place);
        Ok(found)
    }

    /// Log time and place among the active blocks of the next message. Blocks
    /// that may hold an earlier one are read first.
    fn first(&mut self) -> Result<Option<(u64, usize)>, ReadMessageError> {
        loop {
            let next = |(place, active): (usize, &Active)| {
                let log_time = active.entry()?.header.log_time;
                Some((log_time, active.file, active.index, place))
            };
            let first = self.active.iter().enumerate().filter_map(next).min();
            let found = first.map(|(log_time, .., place)| (log_time, place));
            match (found, self.waiting.front()) {
                (Some((log_time, _)), Some(waiting)) if waiting.start > log_time => {
                    return Ok(found);
                }
                (_, None) => return Ok(found),
                _ => self.activate()?,
            }
        }
    }

    fn activate(&mut self) -> Result<(), ReadMessageError> {
        let Some(Waiting { file, index, .. }) = self.waiting.pop_front() else {
            return Ok(());
        };
        let Some(shared) = self.files.get(file) else {
            return Ok(());
        };
        let block = shared.load(index)?;
        let memory: usize = self.active.iter().map(|active| active.block.size()).sum();
        if memory > MAX_OVERLAP {
            let blocks = &shared.layout.blocks;
            return Err(shared.error(BlockError::Fault(Fault {
                offset: blocks.get(index).map_or(0, |block| block.offset),
                reason: "too many chunks claim the same time".to_owned(),
            })));
        }
        self.active.push(Active {
            file,
            index,
            block,
            position: 0,
        });
        self.settle(self.active.len() - 1);
        Ok(())
    }

    /// Moves an active block on to its next message that is wanted, and drops
    /// it when there is none.
    fn settle(&mut self, place: usize) {
        let Some(active) = self.active.get(place) else {
            return;
        };
        let wanted = |entry: &Entry| {
            entry.header.log_time >= self.from && self.wants(active.file, entry.header.channel_id)
        };
        let mut rest = active.block.entries.iter().skip(active.position);
        match rest.position(wanted) {
            Some(skipped) => self.active[place].position += skipped,
            None => {
                self.active.swap_remove(place);
            }
        }
    }
}

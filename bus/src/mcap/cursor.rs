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
const MOST_OVERLAP: usize = 1 << 30;

/// One file, shared by all that read it.
#[derive(Debug)]
pub(super) struct SharedFile {
    pub(super) layout: Layout,
    cache: Mutex<VecDeque<(usize, Arc<DecodedBlock>)>>,
}

impl SharedFile {
    pub(super) fn new(layout: Layout) -> SharedFile {
        SharedFile {
            layout,
            cache: Mutex::new(VecDeque::with_capacity(CACHED_BLOCKS)),
        }
    }

    /// The block of that index, unpacked.
    pub(super) fn load(&self, index: usize) -> Result<Arc<DecodedBlock>, ReadMessageError> {
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
pub(super) struct Found {
    /// Which of the files.
    pub(super) file: usize,
    pub(super) block: Arc<DecodedBlock>,
    pub(super) entry: Entry,
}

/// A block that is being read.
#[derive(Debug)]
struct Active {
    index: usize,
    block: Arc<DecodedBlock>,
    position: usize,
}

/// Goes through one file.
#[derive(Debug)]
struct FileCursor {
    file: Arc<SharedFile>,
    /// The channels wanted; `None` for all.
    channels: Option<BTreeSet<u16>>,
    /// Messages logged before are passed over \[ns\].
    from: u64,
    /// Blocks not read yet, in the order of their first log time.
    waiting: VecDeque<usize>,
    active: Vec<Active>,
}

impl FileCursor {
    fn new(file: Arc<SharedFile>, channels: Option<BTreeSet<u16>>, from: u64) -> FileCursor {
        let blocks = &file.layout.blocks;
        let wanted = |index: &usize| {
            let block = &blocks[*index];
            let holds = match (&block.channels, &channels) {
                (Some(there), Some(wanted)) => !there.is_disjoint(wanted),
                _ => true,
            };
            holds && block.end >= from
        };
        let mut waiting: Vec<usize> = (0..blocks.len()).filter(wanted).collect();
        waiting.sort_by_key(|&index| (blocks[index].start, index));
        FileCursor {
            file,
            channels,
            from,
            waiting: waiting.into(),
            active: Vec::new(),
        }
    }

    /// Log time of the next message \[ns\].
    fn peek(&mut self) -> Result<Option<u64>, ReadMessageError> {
        Ok(self.first()?.map(|(log_time, _)| log_time))
    }

    /// Takes the next message.
    fn take(&mut self) -> Result<Option<(Arc<DecodedBlock>, Entry)>, ReadMessageError> {
        let Some((_, place)) = self.first()? else {
            return Ok(None);
        };
        let Some(active) = self.active.get_mut(place) else {
            return Ok(None);
        };
        let taken = active.block.entries.get(active.position).copied();
        let block = active.block.clone();
        active.position += 1;
        self.settle(place);
        Ok(taken.map(|entry| (block, entry)))
    }

    /// Log time and place among the active blocks of the next message. Blocks
    /// that may hold an earlier one are read first.
    fn first(&mut self) -> Result<Option<(u64, usize)>, ReadMessageError> {
        loop {
            let first = self
                .active
                .iter()
                .enumerate()
                .filter_map(|(place, active)| {
                    let entry = active.block.entries.get(active.position)?;
                    Some((entry.header.log_time, active.index, place))
                })
                .min();
            let next_start = self.waiting.front().map(|&index| self.start(index));
            match (first, next_start) {
                (Some((log_time, _, place)), Some(start)) if log_time < start => {
                    return Ok(Some((log_time, place)));
                }
                (_, Some(_)) => self.activate()?,
                (first, None) => return Ok(first.map(|(log_time, _, place)| (log_time, place))),
            }
        }
    }

    fn start(&self, index: usize) -> u64 {
        self.file
            .layout
            .blocks
            .get(index)
            .map_or(0, |block| block.start)
    }

    fn activate(&mut self) -> Result<(), ReadMessageError> {
        let Some(index) = self.waiting.pop_front() else {
            return Ok(());
        };
        let block = self.file.load(index)?;
        let memory: usize = self.active.iter().map(|active| active.block.size()).sum();
        if memory > MOST_OVERLAP {
            return Err(self.file.error(BlockError::Fault(Fault {
                offset: self
                    .file
                    .layout
                    .blocks
                    .get(index)
                    .map_or(0, |block| block.offset),
                reason: "too many chunks claim the same time".to_owned(),
            })));
        }
        self.active.push(Active {
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
        let Some(active) = self.active.get_mut(place) else {
            return;
        };
        let rest = active
            .block
            .entries
            .get(active.position..)
            .unwrap_or_default();
        let wanted = |entry: &Entry| {
            entry.header.log_time >= self.from
                && self
                    .channels
                    .as_ref()
                    .is_none_or(|channels| channels.contains(&entry.header.channel))
        };
        match rest.iter().position(wanted) {
            Some(skipped) => active.position += skipped,
            None => {
                self.active.swap_remove(place);
            }
        }
    }
}

/// Goes through several files at once.
#[derive(Debug)]
pub(super) struct Cursor {
    files: Vec<FileCursor>,
}

impl Cursor {
    /// `channels` are those wanted of each file, `None` for all; messages
    /// logged before `from` \[ns\] are passed over.
    pub(super) fn new(
        files: &[Arc<SharedFile>],
        channels: Option<Vec<BTreeSet<u16>>>,
        from: u64,
    ) -> Cursor {
        let mut channels = channels.map(Vec::into_iter);
        Cursor {
            files: files
                .iter()
                .map(|file| {
                    let channels = channels
                        .as_mut()
                        .map(|each| each.next().unwrap_or_default());
                    FileCursor::new(file.clone(), channels, from)
                })
                .collect(),
        }
    }

    /// Log time of the next message \[ns\]; `None` at the end.
    pub(super) fn peek(&mut self) -> Result<Option<u64>, ReadMessageError> {
        Ok(self.first()?.map(|(log_time, _)| log_time))
    }

    /// Takes the next message; `None` at the end. After an error reading goes
    /// on behind the fault.
    pub(super) fn take(&mut self) -> Result<Option<Found>, ReadMessageError> {
        let Some((_, file)) = self.first()? else {
            return Ok(None);
        };
        let Some(cursor) = self.files.get_mut(file) else {
            return Ok(None);
        };
        Ok(cursor
            .take()?
            .map(|(block, entry)| Found { file, block, entry }))
    }

    fn first(&mut self) -> Result<Option<(u64, usize)>, ReadMessageError> {
        let mut first: Option<(u64, usize)> = None;
        for (file, cursor) in self.files.iter_mut().enumerate() {
            if let Some(log_time) = cursor.peek()?
                && first.is_none_or(|(earliest, _)| log_time < earliest)
            {
                first = Some((log_time, file));
            }
        }
        Ok(first)
    }
}

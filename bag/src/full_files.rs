//! Files of a recording that are full. Each is closed by a thread of its own: until
//! its bytes are on the disk the recorder has better things to do than to wait.

use std::{collections::BTreeMap, mem, thread::JoinHandle};

use super::{
    error::{FinishBagError, WriteBagError},
    file_writer::FileWriter,
    metadata::{BagMetadata, FileEntry},
    rosbag2_record::finish_file,
};

/// Files that are full: closed, but for the last one perhaps.
#[derive(Default)]
pub(crate) struct FullFiles {
    files: Vec<FileEntry>,
    /// Messages by topic.
    counts: BTreeMap<String, u64>,
    closing: Option<JoinHandle<Result<u64, FinishBagError>>>,
    bytes: u64,
    /// Why the first one that was not closed was not.
    failed: Option<FinishBagError>,
}

impl FullFiles {
    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.files.len()
    }

    /// Closes `file`, of which `metadata` tells.
    pub(crate) fn close(&mut self, mut file: FileWriter, metadata: BagMetadata) {
        // The one before has had the time of a whole file.
        self.join();
        self.files.extend(metadata.files.iter().cloned());
        for topic in &metadata.topics {
            *self.counts.entry(topic.name.clone()).or_insert(0) += topic.messages;
        }
        let path = file.path().to_owned();
        let closing = std::thread::Builder::new().name("recording".to_owned());
        match closing.spawn(move || finish_file(&mut file, &metadata)) {
            Ok(closing) => self.closing = Some(closing),
            // Dropped, it is closed as well as that can be done.
            Err(error) => {
                let source = WriteBagError::Io {
                    path: path.clone(),
                    reason: error.to_string(),
                };
                self.failed
                    .get_or_insert(FinishBagError::File { path, source });
            }
        }
    }

    fn join(&mut self) {
        match self.closing.take().map(JoinHandle::join) {
            None => {}
            Some(Ok(Ok(bytes))) => self.bytes += bytes,
            Some(Ok(Err(error))) => {
                self.failed.get_or_insert(error);
            }
            Some(Err(panic)) => std::panic::resume_unwind(panic),
        }
    }

    /// Waits for the last one. Gives the files, messages by topic, and their bytes.
    pub(crate) fn end(
        &mut self,
    ) -> (
        Vec<FileEntry>,
        BTreeMap<String, u64>,
        Result<u64, FinishBagError>,
    ) {
        self.join();
        let closed = match self.failed.take() {
            Some(error) => Err(error),
            None => Ok(self.bytes),
        };
        (
            mem::take(&mut self.files),
            mem::take(&mut self.counts),
            closed,
        )
    }
}

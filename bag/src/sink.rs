//! Where the MCAP writer's bytes go: whole chunks, or nothing.

use std::{
    fs::File,
    io::{self, Seek, SeekFrom, Write},
    mem,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use mcap::records::op;

use super::{
    block::{FRAME, frame},
    definitions::Definitions,
    write_behind::WriteBehind,
};

/// A file, as far as a recording needs one.
pub(crate) trait Storage: Write + Send + 'static {
    /// Cuts the store to `length` bytes; the next write goes to its end.
    fn cut(&mut self, length: u64) -> io::Result<()>;
    /// Brings what was written to the disk.
    fn sync(&mut self) -> io::Result<()>;
}

impl Storage for File {
    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::Start(length)).map(|_| ())
    }

    fn sync(&mut self) -> io::Result<()> {
        self.sync_all()
    }
}

/// How many bytes a store holds, or will hold soon, for whoever gave the store away.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stored(Arc<AtomicU64>);

impl Stored {
    /// \[bytes\]
    pub(crate) fn bytes(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// Gathers bytes in memory and hands them to the store at [`Write::flush`],
/// all of them or, when the store refuses, none: then they wait for the next
/// flush, and the store ends behind the last chunk that is whole. What a disk
/// refuses is known at the flush after it, since it is written behind. Behind a
/// flush, where no chunk is open, copies of the definitions are put in; so the
/// checksum of all data is counted here.
pub(crate) struct Sink<S: Storage> {
    store: Arc<WriteBehind<S>>,
    stored: Stored,
    staged: Vec<u8>,
    /// Of what is stored.
    checksum: crc32fast::Hasher,
    definitions: Definitions,
}

impl<S: Storage> Sink<S> {
    pub(crate) fn new(store: Arc<WriteBehind<S>>, definitions: Definitions) -> Sink<S> {
        Sink {
            store,
            stored: Stored::default(),
            staged: Vec::new(),
            checksum: crc32fast::Hasher::new(),
            definitions,
        }
    }

    /// Notes the checksum of all data in the record that ends the data, where
    /// that comes first of what is staged.
    fn seal(&mut self) {
        if let Some((op::DATA_END, 4)) = frame(&self.staged)
            && let Some(place) = self.staged.get_mut(FRAME..FRAME + 4)
        {
            let checksum = self.checksum.clone().finalize();
            place.copy_from_slice(&checksum.to_le_bytes());
        }
    }

    /// Bytes that the store holds, or will hold soon.
    pub(crate) fn stored(&self) -> Stored {
        self.stored.clone()
    }
}

impl<S: Storage> Write for Sink<S> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.staged.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.staged.is_empty() {
            return Ok(());
        }
        self.seal();
        let mut checksum = self.checksum.clone();
        checksum.update(&self.staged);
        let length = self.staged.len() as u64;
        if let Err((chunk, error)) = self.store.put(mem::take(&mut self.staged)) {
            self.staged = chunk;
            return Err(error);
        }
        self.checksum = checksum;
        let stored = self.stored.bytes() + length;
        self.stored.0.store(stored, Ordering::Relaxed);
        if let Some(copy) = self.definitions.copy_due(stored) {
            self.staged = copy;
        }
        Ok(())
    }
}

/// The MCAP writer only asks where it is.
impl<S: Storage> Seek for Sink<S> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) | SeekFrom::End(0) => {
                Ok(self.stored.bytes() + self.staged.len() as u64)
            }
            _ => Err(io::Error::from(io::ErrorKind::Unsupported)),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;

    /// A disk of limited size, held in memory.
    #[derive(Clone)]
    pub(crate) struct SmallDisk {
        pub(crate) content: Arc<Mutex<Vec<u8>>>,
        pub(crate) size: Arc<Mutex<usize>>,
    }

    impl SmallDisk {
        pub(crate) fn new(size: usize) -> SmallDisk {
            SmallDisk {
                content: Arc::default(),
                size: Arc::new(Mutex::new(size)),
            }
        }
    }

    impl Write for SmallDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let mut content = self.content.lock().unwrap();
            let room = self.size.lock().unwrap().saturating_sub(content.len());
            if room == 0 {
                return Err(io::Error::from(io::ErrorKind::StorageFull));
            }
            let taken = bytes.len().min(room);
            content.extend_from_slice(&bytes[..taken]);
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Storage for SmallDisk {
        fn cut(&mut self, length: u64) -> io::Result<()> {
            self.content.lock().unwrap().truncate(length as usize);
            Ok(())
        }

        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_refused_chunk_leaves_no_trace_and_waits() {
        let disk = SmallDisk::new(10);
        let store = Arc::new(WriteBehind::begin(disk.clone()).unwrap());
        let mut sink = Sink::new(store.clone(), Definitions::default());
        sink.write_all(b"12345678").unwrap();
        sink.flush().unwrap();
        sink.write_all(b"abcdef").unwrap();
        sink.flush().unwrap();
        assert_eq!(store.sync().unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert_eq!(*disk.content.lock().unwrap(), b"12345678");
        sink.write_all(b"gh").unwrap();
        assert_eq!(sink.flush().unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert_eq!(sink.stored().bytes(), 14);

        *disk.size.lock().unwrap() = 100;
        sink.flush().unwrap();
        store.sync().unwrap();
        assert_eq!(*disk.content.lock().unwrap(), b"12345678abcdefgh");
        assert_eq!(sink.stored().bytes(), 16);
    }
}

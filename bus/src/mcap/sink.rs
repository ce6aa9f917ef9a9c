//! Where the MCAP writer's bytes go: whole chunks, or nothing.

use std::{
    fs::File,
    io::{self, Seek, SeekFrom, Write},
};

/// A file, as far as a recording needs one.
pub(super) trait Storage: Write + Send {
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

/// Gathers bytes in memory and hands them to the store at [`Write::flush`],
/// all of them or, when the store refuses, none: then they wait for the next
/// flush, and the store ends behind the last chunk that is whole.
pub(super) struct Sink<S: Storage> {
    store: S,
    stored: u64,
    staged: Vec<u8>,
    torn: bool,
}

impl<S: Storage> Sink<S> {
    pub(super) fn new(store: S) -> Sink<S> {
        Sink {
            store,
            stored: 0,
            staged: Vec::new(),
            torn: false,
        }
    }

    /// Bytes that the store holds.
    pub(super) fn stored(&self) -> u64 {
        self.stored
    }

    /// See [`Storage::sync`].
    pub(super) fn sync(&mut self) -> io::Result<()> {
        self.store.sync()
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
        if self.torn {
            self.store.cut(self.stored)?;
            self.torn = false;
        }
        let written = self
            .store
            .write_all(&self.staged)
            .and_then(|()| self.store.flush());
        if let Err(error) = written {
            // What the store took of the chunk would be a broken end. Should
            // the cut fail too, it is tried again before the next write.
            self.torn = self.store.cut(self.stored).is_err();
            return Err(error);
        }
        self.stored += self.staged.len() as u64;
        self.staged.clear();
        Ok(())
    }
}

/// The MCAP writer only asks where it is.
impl<S: Storage> Seek for Sink<S> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) | SeekFrom::End(0) => Ok(self.stored + self.staged.len() as u64),
            _ => Err(io::Error::from(io::ErrorKind::Unsupported)),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;

    /// A disk of limited size, held in memory.
    #[derive(Clone)]
    pub(in crate::mcap) struct SmallDisk {
        pub(in crate::mcap) content: Arc<Mutex<Vec<u8>>>,
        pub(in crate::mcap) size: Arc<Mutex<usize>>,
    }

    impl SmallDisk {
        pub(in crate::mcap) fn new(size: usize) -> SmallDisk {
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
        let mut sink = Sink::new(disk.clone());
        sink.write_all(b"12345678").unwrap();
        sink.flush().unwrap();
        sink.write_all(b"abcdef").unwrap();
        assert_eq!(sink.flush().unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert_eq!(*disk.content.lock().unwrap(), b"12345678");

        *disk.size.lock().unwrap() = 100;
        sink.flush().unwrap();
        assert_eq!(*disk.content.lock().unwrap(), b"12345678abcdef");
        assert_eq!(sink.stored(), 14);
    }
}

//! A store that is written by a thread of its own: a disk that stands still for some seconds keeps
//! nobody from recording.

use std::{
    collections::VecDeque,
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
};

use super::sink::Storage;

/// So much waits for the store at most; then whoever writes waits, too \[bytes\].
const ROOM: usize = 32 << 20;

/// What is on its way into the store.
#[derive(Default)]
struct Queue {
    /// Chunks that are not stored, the oldest first; that one stays until it is.
    waiting: VecDeque<Arc<Vec<u8>>>,
    /// What these hold \[bytes\].
    bytes: usize,
    /// Why the oldest could not be stored. It is tried again when somebody asks.
    refused: Option<io::Error>,
    /// Nothing more comes.
    ended: bool,
}

impl Queue {
    /// Nothing happens until somebody asks.
    fn rests(&self) -> bool {
        self.waiting.is_empty() || self.refused.is_some()
    }
}

/// What writer and thread share.
struct Shared<S> {
    queue: Mutex<Queue>,
    changed: Condvar,
    /// Held by the thread while it writes.
    store: Mutex<S>,
}

impl<S> Shared<S> {
    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn store(&self) -> MutexGuard<'_, S> {
        self.store.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits as long as `goes_on` says of what is under way.
    fn wait<'a>(
        &self,
        queue: MutexGuard<'a, Queue>,
        goes_on: impl Fn(&Queue) -> bool,
    ) -> MutexGuard<'a, Queue> {
        self.changed
            .wait_while(queue, |queue| goes_on(queue))
            .unwrap_or_else(PoisonError::into_inner)
    }
}

impl<S: Storage> Shared<S> {
    /// Stores chunk after chunk, each of them whole or not at all, until nothing more comes.
    fn work(&self) {
        // Bytes that are stored, and whether something that is none of them stands behind.
        let (mut stored, mut torn) = (0, false);
        loop {
            let queue = self.wait(self.queue(), |queue| queue.rests() && !queue.ended);
            let next = match queue.refused {
                None => queue.waiting.front().cloned(),
                Some(_) => None,
            };
            drop(queue);
            let Some(chunk) = next else {
                return;
            };
            let written = {
                let mut store = self.store();
                let cut = match torn {
                    true => store.cut(stored),
                    false => Ok(()),
                };
                torn = cut.is_err();
                cut.and_then(|()| {
                    let written = store.write_all(&chunk).and_then(|()| store.flush());
                    // What the store took of the chunk would be a broken end. Should the cut
                    // fail too, it is tried again before the next write.
                    torn = written.is_err() && store.cut(stored).is_err();
                    written
                })
            };
            let mut queue = self.queue();
            match written {
                Ok(()) => {
                    stored += chunk.len() as u64;
                    queue.bytes -= chunk.len();
                    queue.waiting.pop_front();
                }
                Err(error) => queue.refused = Some(error),
            }
            drop(queue);
            self.changed.notify_all();
        }
    }
}

/// A store, and the thread that writes into it. Dropped, it stores what can be stored.
pub(crate) struct WriteBehind<S: Storage> {
    shared: Arc<Shared<S>>,
    thread: Option<JoinHandle<()>>,
}

impl<S: Storage> WriteBehind<S> {
    /// Begins a thread.
    ///
    /// # Errors
    ///
    /// There is none to be had.
    pub(crate) fn begin(store: S) -> io::Result<WriteBehind<S>> {
        let shared = Arc::new(Shared {
            queue: Mutex::default(),
            changed: Condvar::new(),
            store: Mutex::new(store),
        });
        let own = shared.clone();
        let thread = thread::Builder::new()
            .name("recording".to_owned())
            .spawn(move || own.work())?;
        Ok(WriteBehind {
            shared,
            thread: Some(thread),
        })
    }

    /// Has a chunk stored behind those before, whole.
    ///
    /// # Errors
    ///
    /// One before it could not be stored, and still cannot: then this one is given back.
    pub(crate) fn put(&self, chunk: Vec<u8>) -> Result<(), (Vec<u8>, io::Error)> {
        let mut queue = match self.tried_again() {
            Ok(queue) => queue,
            Err(error) => return Err((chunk, error)),
        };
        queue = self.shared.wait(queue, |queue| {
            queue.bytes > 0 && queue.bytes + chunk.len() > ROOM && queue.refused.is_none()
        });
        if let Some(error) = &queue.refused {
            return Err((chunk, again(error)));
        }
        queue.bytes += chunk.len();
        queue.waiting.push_back(Arc::new(chunk));
        drop(queue);
        self.shared.changed.notify_all();
        Ok(())
    }

    /// Waits until all is stored, and on the disk.
    ///
    /// # Errors
    ///
    /// Something could not be stored.
    pub(crate) fn sync(&self) -> io::Result<()> {
        let queue = self.tried_again()?;
        let queue = self.shared.wait(queue, |queue| !queue.rests());
        if let Some(error) = &queue.refused {
            return Err(again(error));
        }
        drop(queue);
        self.shared.store().sync()
    }

    /// The queue, once what was refused has been tried again.
    fn tried_again(&self) -> io::Result<MutexGuard<'_, Queue>> {
        let mut queue = self.shared.queue();
        if queue.refused.take().is_some() {
            self.shared.changed.notify_all();
            let before = queue.waiting.len();
            queue = self.shared.wait(queue, |queue| {
                queue.refused.is_none() && queue.waiting.len() == before
            });
        }
        match &queue.refused {
            Some(error) => Err(again(error)),
            None => Ok(queue),
        }
    }

    /// Waits until nothing happens by itself any more.
    #[cfg(test)]
    pub(crate) fn settle(&self) {
        drop(
            self.shared
                .wait(self.shared.queue(), |queue| !queue.rests()),
        );
    }
}

impl<S: Storage> Drop for WriteBehind<S> {
    fn drop(&mut self) {
        self.shared.queue().ended = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // A panic of its own was told.
            let _ = thread.join();
        }
    }
}

/// An error that was told already.
fn again(error: &io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(code) => io::Error::from_raw_os_error(code),
        None => io::Error::new(error.kind(), error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::{io::Write, sync::mpsc};

    use super::*;
    use crate::sink::tests::SmallDisk;

    /// A disk that stands still until it is told to go on.
    struct Standing {
        disk: SmallDisk,
        go_on: mpsc::Receiver<()>,
    }

    impl Write for Standing {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            // Whoever ended it lets everything pass.
            let _ = self.go_on.recv();
            self.disk.write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Storage for Standing {
        fn cut(&mut self, length: u64) -> io::Result<()> {
            self.disk.cut(length)
        }

        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_disk_that_stands_still_keeps_nobody_waiting_and_loses_nothing() {
        let disk = SmallDisk::new(1000);
        let (goes_on, go_on) = mpsc::channel();
        let standing = Standing {
            disk: disk.clone(),
            go_on,
        };
        let store = WriteBehind::begin(standing).unwrap();
        for chunk in [b"one ", b"two "] {
            store.put(chunk.to_vec()).unwrap();
        }
        assert!(disk.content.lock().unwrap().is_empty());
        drop(goes_on);
        store.put(b"three".to_vec()).unwrap();
        store.sync().unwrap();
        assert_eq!(*disk.content.lock().unwrap(), b"one two three");
    }

    #[test]
    fn what_is_refused_waits_and_comes_first() {
        let disk = SmallDisk::new(6);
        let store = WriteBehind::begin(disk.clone()).unwrap();
        store.put(b"one ".to_vec()).unwrap();
        store.put(b"two ".to_vec()).unwrap();
        store.settle();
        assert_eq!(*disk.content.lock().unwrap(), b"one ");
        let (chunk, error) = store.put(b"three".to_vec()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(store.sync().is_err());
        *disk.size.lock().unwrap() = 1000;
        store.put(chunk).unwrap();
        store.sync().unwrap();
        assert_eq!(*disk.content.lock().unwrap(), b"one two three");
    }

    #[test]
    fn dropped_it_stores_what_waits() {
        let disk = SmallDisk::new(1000);
        let store = WriteBehind::begin(disk.clone()).unwrap();
        for _ in 0..100 {
            store.put(b"0123456789"[..5].to_vec()).unwrap();
        }
        drop(store);
        assert_eq!(disk.content.lock().unwrap().len(), 500);
    }
}

//! What pages and the session's loop share: the operator, wishes, snapshots.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use axum::extract::ws::Utf8Bytes;
use ferntast_msgs::Time;
use tokio::sync::{Notify, watch};

use super::{
    message::{Request, StateRequest},
    operator_lock::{OperatorLock, Taken},
};

/// Pages that are open at once at most. One more is always let in: the one that
/// has watched for the longest goes.
const MAX_PAGES: usize = 32;

/// Wishes that wait at most; a page cannot fill the memory.
const MAX_WISHES: usize = 64;

/// Gives the time, as the session's clock has it.
pub type Now = Box<dyn Fn() -> Time + Send + Sync>;

/// Why a request of a page is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RequestRefusal {
    /// Another page operates.
    #[error(transparent)]
    Taken(#[from] Taken),
    /// This page only watches.
    #[error("this page watches; take the controls first")]
    Watcher,
    /// One recording at a time.
    #[error("the session is being recorded already")]
    Recording,
    /// Somebody else's recording.
    #[error("who began this recording ends it, or the page that has the controls")]
    NotYours,
    /// Too much is asked at once.
    #[error("too many requests wait: try again")]
    Full,
}

/// What pages and the session's loop share.
pub struct SharedSession {
    now: Now,
    operator: Mutex<OperatorLock>,
    wishes: Mutex<VecDeque<Request>>,
    snapshot: watch::Sender<Utf8Bytes>,
    /// The pages that are open, and how each is told that it has to go.
    pages: Mutex<BTreeMap<u64, Arc<Notify>>>,
    /// The page that asked for the recording.
    recording_of: AtomicU64,
    /// The session is being recorded.
    recording: AtomicBool,
    next_page: AtomicU64,
    /// What the session is made of, for the page.
    pub about: serde_json::Value,
}

impl SharedSession {
    /// With nobody who operates.
    pub fn new(about: serde_json::Value, now: Now) -> SharedSession {
        SharedSession {
            now,
            operator: Mutex::default(),
            wishes: Mutex::default(),
            snapshot: watch::Sender::new(Utf8Bytes::default()),
            pages: Mutex::default(),
            recording_of: AtomicU64::new(0),
            recording: AtomicBool::new(false),
            next_page: AtomicU64::new(1),
            about,
        }
    }

    fn lock(&self) -> MutexGuard<'_, OperatorLock> {
        self.operator.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn open_pages(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<Notify>>> {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A page that came; its number, and what tells it that it has to go. Where
    /// there are too many the one that has watched for the longest is told.
    pub fn enter(&self) -> (u64, Arc<Notify>) {
        let operator = self.look().operator();
        let page = self.next_page.fetch_add(1, Ordering::Relaxed);
        let put_out = Arc::new(Notify::new());
        let mut pages = self.open_pages();
        if pages.len() >= MAX_PAGES
            && let Some(oldest) = pages.keys().copied().find(|own| operator != Some(*own))
            && let Some(told) = pages.remove(&oldest)
        {
            told.notify_one();
        }
        pages.insert(page, put_out.clone());
        (page, put_out)
    }

    /// A page that went.
    pub fn leave(&self, page: u64) {
        self.lock().leave(page);
        self.open_pages().remove(&page);
    }

    /// Pages that are open.
    pub fn pages(&self) -> usize {
        self.open_pages().len()
    }

    /// Snapshots as they come; the newest wins.
    pub fn snapshots(&self) -> watch::Receiver<Utf8Bytes> {
        self.snapshot.subscribe()
    }

    /// Whether the session is being recorded, as the recorder tells.
    pub fn note_recording(&self, on: bool) {
        self.recording.store(on, Ordering::Relaxed);
    }

    /// Shows a snapshot to all pages.
    pub fn show(&self, snapshot: String) {
        self.snapshot.send_replace(snapshot.into());
    }

    /// Who operates now.
    pub fn look(&self) -> OperatorLock {
        let mut lock = self.lock();
        lock.age((self.now)());
        *lock
    }

    /// Wishes since the last call, in their order.
    pub fn wishes(&self) -> VecDeque<Request> {
        let mut wishes = self.wishes.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut *wishes)
    }

    /// Page `page` asks for something.
    ///
    /// # Errors
    ///
    /// [`RequestRefusal`].
    pub fn ask(&self, page: u64, request: Request) -> Result<(), RequestRefusal> {
        let now = (self.now)();
        let mut lock = self.lock();
        match request {
            Request::Operate => return Ok(lock.take(page, now)?),
            Request::Watch => lock.leave(page),
            Request::Beat => lock.beat(page, now),
            Request::Hand { x, y, z } => lock.hold(page, now, [x, y, z]),
            Request::LetGo => lock.let_go(page),
            wish => {
                let stop = wish
                    == Request::State {
                        word: StateRequest::Stop,
                    };
                self.may(page, lock.is(page), &wish)?;
                if stop {
                    if let Some(page) = lock.operator() {
                        lock.let_go(page);
                    }
                } else {
                    lock.touched(page, now);
                }
                let mut wishes = self.wishes.lock().unwrap_or_else(PoisonError::into_inner);
                if wishes.len() >= MAX_WISHES && !stop {
                    return Err(RequestRefusal::Full);
                }
                wishes.push_back(wish);
            }
        }
        Ok(())
    }

    /// Whether page `page`, which `operates` or not, may have that wish. Whoever sees
    /// danger may stop, and whoever watches may record what is seen and note it.
    fn may(&self, page: u64, operates: bool, wish: &Request) -> Result<(), RequestRefusal> {
        match wish {
            Request::State {
                word: StateRequest::Stop,
            }
            | Request::Mark { .. } => Ok(()),
            Request::Record { .. } if self.recording.load(Ordering::Relaxed) => {
                Err(RequestRefusal::Recording)
            }
            Request::Record { .. } => {
                self.recording_of.store(page, Ordering::Relaxed);
                Ok(())
            }
            _ if operates => Ok(()),
            Request::EndRecord if self.recording_of.load(Ordering::Relaxed) == page => Ok(()),
            Request::EndRecord => Err(RequestRefusal::NotYours),
            _ => Err(RequestRefusal::Watcher),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shared() -> SharedSession {
        SharedSession::new(
            serde_json::Value::Null,
            Box::new(|| Time::from_nanos(1_000_000_000)),
        )
    }

    #[test]
    fn watchers_may_stop_and_record_and_nothing_else() {
        let shared = shared();
        let (operator, watcher) = (shared.enter().0, shared.enter().0);
        shared.ask(operator, Request::Operate).unwrap();
        assert_eq!(shared.ask(watcher, Request::Operate), Err(Taken.into()));
        for word in [StateRequest::Arm, StateRequest::Hold, StateRequest::Rearm] {
            let refused = shared.ask(watcher, Request::State { word });
            assert_eq!(refused, Err(RequestRefusal::Watcher));
        }
        let link = Request::Link {
            round_trip: 0.1,
            jitter: 0.0,
            loss: 0.0,
        };
        assert_eq!(shared.ask(watcher, link), Err(RequestRefusal::Watcher));
        // A recording is ended by who began it, or by who operates.
        let end = || Request::EndRecord;
        assert_eq!(shared.ask(watcher, end()), Err(RequestRefusal::NotYours));
        let record = Request::Record {
            folder: String::new(),
        };
        shared.ask(watcher, record.clone()).unwrap();
        shared.note_recording(true);
        assert_eq!(
            shared.ask(operator, record.clone()),
            Err(RequestRefusal::Recording)
        );
        let mark = Request::Mark { label: "x".into() };
        shared.ask(watcher, mark.clone()).unwrap();
        shared.ask(watcher, end()).unwrap();
        shared.ask(operator, end()).unwrap();
        let wishes = [record, mark, Request::EndRecord, Request::EndRecord];
        assert_eq!(shared.wishes(), wishes);
        shared
            .ask(
                operator,
                Request::Hand {
                    x: 0.01,
                    y: 0.0,
                    z: 0.0,
                },
            )
            .unwrap();
        assert!(shared.look().target().is_some());
        shared
            .ask(
                watcher,
                Request::State {
                    word: StateRequest::Stop,
                },
            )
            .unwrap();
        assert_eq!(shared.look().target(), None, "a stop takes the hand off");
        assert_eq!(
            shared.wishes(),
            [Request::State {
                word: StateRequest::Stop
            }]
        );
    }

    #[test]
    fn the_oldest_watcher_goes_and_never_the_operator() {
        let shared = shared();
        let (operator, told) = shared.enter();
        shared.ask(operator, Request::Operate).unwrap();
        let others: Vec<_> = (0..MAX_PAGES + 4).map(|_| shared.enter()).collect();
        assert_eq!(shared.pages(), MAX_PAGES);
        assert!(shared.open_pages().contains_key(&operator));
        // The operator is told nothing; the first five watchers hold the last
        // handle to what told them.
        assert_eq!(Arc::strong_count(&told), 2);
        let gone = others
            .iter()
            .filter(|(_, told)| Arc::strong_count(told) == 1);
        assert_eq!(gone.count(), 5);
        assert_eq!(Arc::strong_count(&others[4].1), 1);
    }

    #[test]
    fn a_page_cannot_fill_the_memory_and_a_stop_always_gets_through() {
        let shared = shared();
        let page = shared.enter().0;
        shared.ask(page, Request::Operate).unwrap();
        let mark = || Request::Mark { label: "x".into() };
        let taken = (0..1000)
            .filter(|_| shared.ask(page, mark()).is_ok())
            .count();
        assert_eq!(taken, MAX_WISHES);
        shared
            .ask(
                page,
                Request::State {
                    word: StateRequest::Stop,
                },
            )
            .unwrap();
        assert_eq!(shared.wishes().len(), MAX_WISHES + 1);
    }
}

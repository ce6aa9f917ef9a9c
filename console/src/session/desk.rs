//! What pages and the session's loop share: the seat, wishes, snapshots.

use std::{
    collections::VecDeque,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
};

use axum::extract::ws::Utf8Bytes;
use ferntast_msgs::Time;
use tokio::sync::watch;

use super::{
    message::{Request, Word},
    seat::{Seat, Taken},
};

/// Wishes that wait at most; a page cannot fill the memory.
const MOST_WISHES: usize = 64;

/// Gives the time, as the session's clock has it.
pub type Now = Box<dyn Fn() -> Time + Send + Sync>;

/// Why a request of a page is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeskRefusal {
    /// Another page operates.
    #[error(transparent)]
    Taken(#[from] Taken),
    /// This page only watches.
    #[error("this page watches; take the controls first")]
    Watcher,
    /// Too much is asked at once.
    #[error("too many requests wait: try again")]
    Full,
}

/// What pages and the session's loop share.
pub struct Desk {
    now: Now,
    seat: Mutex<Seat>,
    wishes: Mutex<VecDeque<Request>>,
    snapshot: watch::Sender<Utf8Bytes>,
    pages: AtomicUsize,
    next_page: AtomicU64,
    /// What the session is made of, for the page.
    pub about: serde_json::Value,
}

impl Desk {
    /// A desk at which nobody sits.
    pub fn new(about: serde_json::Value, now: Now) -> Desk {
        Desk {
            now,
            seat: Mutex::default(),
            wishes: Mutex::default(),
            snapshot: watch::Sender::new(Utf8Bytes::default()),
            pages: AtomicUsize::new(0),
            next_page: AtomicU64::new(1),
            about,
        }
    }

    fn seat(&self) -> MutexGuard<'_, Seat> {
        self.seat.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A page that came; its number.
    pub fn enter(&self) -> u64 {
        self.pages.fetch_add(1, Ordering::Relaxed);
        self.next_page.fetch_add(1, Ordering::Relaxed)
    }

    /// A page that went.
    pub fn leave(&self, page: u64) {
        self.seat().leave(page);
        self.pages.fetch_sub(1, Ordering::Relaxed);
    }

    /// Pages that are open.
    pub fn pages(&self) -> usize {
        self.pages.load(Ordering::Relaxed)
    }

    /// Snapshots as they come; the newest wins.
    pub fn snapshots(&self) -> watch::Receiver<Utf8Bytes> {
        self.snapshot.subscribe()
    }

    /// Shows a snapshot to all pages.
    pub fn show(&self, snapshot: String) {
        self.snapshot.send_replace(snapshot.into());
    }

    /// The seat as it is now.
    pub fn look(&self) -> Seat {
        let mut seat = self.seat();
        seat.age((self.now)());
        *seat
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
    /// [`DeskRefusal`].
    pub fn ask(&self, page: u64, request: Request) -> Result<(), DeskRefusal> {
        let now = (self.now)();
        let mut seat = self.seat();
        match request {
            Request::Operate => return Ok(seat.sit(page, now)?),
            Request::Watch => seat.leave(page),
            Request::Beat => seat.beat(page, now),
            Request::Hand { x, y } => seat.hold(page, now, [x, y]),
            Request::LetGo => seat.let_go(page),
            wish => {
                // Whoever sees danger may stop.
                let stop = wish == Request::State { word: Word::Stop };
                if !stop && !seat.is(page) {
                    return Err(DeskRefusal::Watcher);
                }
                if stop {
                    if let Some(operator) = seat.operator() {
                        seat.let_go(operator);
                    }
                } else {
                    seat.touched(page, now);
                }
                let mut wishes = self.wishes.lock().unwrap_or_else(PoisonError::into_inner);
                if wishes.len() >= MOST_WISHES && !stop {
                    return Err(DeskRefusal::Full);
                }
                wishes.push_back(wish);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn desk() -> Desk {
        Desk::new(
            serde_json::Value::Null,
            Box::new(|| Time::from_nanos(1_000_000_000)),
        )
    }

    #[test]
    fn watchers_may_stop_and_nothing_else() {
        let desk = desk();
        let (operator, watcher) = (desk.enter(), desk.enter());
        desk.ask(operator, Request::Operate).unwrap();
        assert_eq!(desk.ask(watcher, Request::Operate), Err(Taken.into()));
        for word in [Word::Arm, Word::Hold, Word::Rearm] {
            let refused = desk.ask(watcher, Request::State { word });
            assert_eq!(refused, Err(DeskRefusal::Watcher));
        }
        let mark = Request::Mark { label: "x".into() };
        assert_eq!(desk.ask(watcher, mark), Err(DeskRefusal::Watcher));
        desk.ask(operator, Request::Hand { x: 0.01, y: 0.0 })
            .unwrap();
        assert!(desk.look().target().is_some());
        desk.ask(watcher, Request::State { word: Word::Stop })
            .unwrap();
        assert_eq!(desk.look().target(), None, "a stop takes the hand off");
        assert_eq!(desk.wishes(), [Request::State { word: Word::Stop }]);
    }

    #[test]
    fn a_page_cannot_fill_the_memory_and_a_stop_always_gets_through() {
        let desk = desk();
        let page = desk.enter();
        desk.ask(page, Request::Operate).unwrap();
        let mark = || Request::Mark { label: "x".into() };
        let taken = (0..1000).filter(|_| desk.ask(page, mark()).is_ok()).count();
        assert_eq!(taken, MOST_WISHES);
        desk.ask(page, Request::State { word: Word::Stop }).unwrap();
        assert_eq!(desk.wishes().len(), MOST_WISHES + 1);
    }
}

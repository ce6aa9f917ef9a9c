//! Which tests run beside each other on this machine.
//!
//! A session takes half of a processor and more, a page that shows it as much again, and so does
//! a peer in Python that has to be in time. Two of these together leave the real time of neither
//! whole where there are two processors. So a test of this kind runs beside none that has a
//! session, and of others two run at a time, however many threads there are: who waits to be alone
//! is no reason for the others to run one by one. What computes goes on behind them, in a process of
//! its own, whose sessions run nothing in real time and do not count here (so no lock file, as
//! `Machine` has).

use std::{
    collections::HashMap,
    sync::{Condvar, LazyLock, Mutex, PoisonError},
    thread::{self, ThreadId},
};

/// Tests with sessions that run beside each other.
const BESIDE: usize = 2;

#[derive(Default)]
struct Occupancy {
    /// Tests that share it, and how many sessions each has.
    sharing: HashMap<ThreadId, usize>,
    /// The one that has it to itself.
    alone: Option<ThreadId>,
}

static OCCUPANCY: LazyLock<Mutex<Occupancy>> = LazyLock::new(Mutex::default);
static CHANGED: Condvar = Condvar::new();

/// Room for a session; given back when it is dropped.
#[derive(Debug)]
pub(crate) struct Room {
    /// Whose it is: a session may go to another thread.
    owner: ThreadId,
    alone: bool,
}

impl Room {
    /// Waits while another thread's session has it alone, and while there is none: a test that has a
    /// session may have more.
    pub(crate) fn shared() -> Room {
        let owner = thread::current().id();
        take(
            |room| match room.alone {
                Some(other) => other == owner,
                None => room.sharing.contains_key(&owner) || room.sharing.len() < BESIDE,
            },
            |room| *room.sharing.entry(owner).or_default() += 1,
        );
        Room {
            owner,
            alone: false,
        }
    }

    /// Waits until there is no other.
    pub(crate) fn alone() -> Room {
        let owner = thread::current().id();
        take(
            |room| room.alone.is_none() && room.sharing.is_empty(),
            |room| room.alone = Some(owner),
        );
        Room { owner, alone: true }
    }
}

fn take(is_free: impl Fn(&Occupancy) -> bool, enter: impl FnOnce(&mut Occupancy)) {
    let room = OCCUPANCY.lock().unwrap_or_else(PoisonError::into_inner);
    let mut room = CHANGED
        .wait_while(room, |room| !is_free(room))
        .unwrap_or_else(PoisonError::into_inner);
    enter(&mut room);
}

impl Drop for Room {
    fn drop(&mut self) {
        let mut room = OCCUPANCY.lock().unwrap_or_else(PoisonError::into_inner);
        if self.alone {
            room.alone = None;
        } else if let Some(sessions) = room.sharing.get_mut(&self.owner) {
            *sessions -= 1;
            if *sessions == 0 {
                room.sharing.remove(&self.owner);
            }
        }
        CHANGED.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::{
        sync::atomic::{AtomicUsize, Ordering},
        time::Duration,
    };

    use super::*;

    #[test]
    fn who_is_alone_has_nobody_beside_and_others_have_one() {
        static INSIDE: AtomicUsize = AtomicUsize::new(0);
        let visit = |alone: bool| {
            let _room = if alone { Room::alone() } else { Room::shared() };
            let _second = (!alone).then(Room::shared);
            let others = INSIDE.fetch_add(1, Ordering::SeqCst);
            thread::sleep(Duration::from_millis(2));
            let at_the_end = INSIDE.fetch_sub(1, Ordering::SeqCst);
            (others, at_the_end)
        };
        let seen: Vec<_> = thread::scope(|scope| {
            let threads: Vec<_> = (0..12)
                .map(|number| scope.spawn(move || (number % 3 == 0, visit(number % 3 == 0))))
                .collect();
            threads.into_iter().map(|own| own.join().unwrap()).collect()
        });
        for (alone, (others, at_the_end)) in seen {
            assert!(!alone || (others, at_the_end) == (0, 1));
            assert!(others < BESIDE && at_the_end <= BESIDE);
        }
    }
}

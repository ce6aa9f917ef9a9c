//! Which tests run beside each other on this machine.
//!
//! A session takes half of a processor and more, a page that shows it as much again, and so does
//! a peer in Python that has to be in time. Two of these together leave the real time of neither
//! whole where there are two processors. So a test of this kind runs beside none that has a
//! session; what computes goes on behind it, in a process of its own, whose sessions run nothing in
//! real time and do not count here (so no lock file, as `Machine` has).

use std::{
    sync::{Condvar, Mutex, PoisonError},
    thread::{self, ThreadId},
};

struct Occupancy {
    /// Tests that share it.
    sharing: usize,
    /// The one that has it to itself.
    alone: Option<ThreadId>,
}

static OCCUPANCY: Mutex<Occupancy> = Mutex::new(Occupancy {
    sharing: 0,
    alone: None,
});
static CHANGED: Condvar = Condvar::new();

/// Room for a session; given back when it is dropped.
#[derive(Debug)]
pub(crate) struct Room {
    alone: bool,
}

impl Room {
    /// Waits while another thread's session has it alone.
    pub(crate) fn shared() -> Room {
        let own = thread::current().id();
        take(
            |room| room.alone.is_none_or(|other| other == own),
            |room| room.sharing += 1,
        );
        Room { alone: false }
    }

    /// Waits until there is no other.
    pub(crate) fn alone() -> Room {
        let own = thread::current().id();
        take(
            |room| room.alone.is_none() && room.sharing == 0,
            |room| room.alone = Some(own),
        );
        Room { alone: true }
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
        match self.alone {
            true => room.alone = None,
            false => room.sharing -= 1,
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
    fn who_is_alone_has_nobody_beside() {
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
        }
    }
}

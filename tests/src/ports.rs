//! TCP ports, below those that Linux hands out by itself.
//!
//! One from the ephemeral range (32768 and up) may be gone before it is used: any connection
//! that a process of this machine opens takes one from there.

use std::{
    fs::File,
    net::{TcpListener, UdpSocket},
    sync::{Mutex, PoisonError},
};

use crate::lock_file::try_lock;

/// Below the ports of DDS in the domains of tests (7650 and up) and of Zenoh (7446 and 7447).
const FIRST: u16 = 1400;
const BLOCKS: u16 = 30;
const BLOCK: u16 = 200;

/// The ports of this process: a block of them that no other test holds.
struct Ports {
    first: u16,
    handed_out: u16,
    _lock: File,
}

impl Ports {
    fn take() -> Ports {
        for block in 0..BLOCKS {
            if let Some(lock) = try_lock(&format!("ferntast-tests-ports-{block}.lock")) {
                return Ports {
                    first: FIRST + block * BLOCK,
                    handed_out: 0,
                    _lock: lock,
                };
            }
        }
        panic!("all {BLOCKS} blocks of TCP ports are taken by other tests");
    }

    /// The next one that nobody listens at; long after the last come those from the beginning.
    fn next(&mut self) -> u16 {
        for _ in 0..BLOCK {
            let port = self.first + self.handed_out;
            self.handed_out = (self.handed_out + 1) % BLOCK;
            let is_free = TcpListener::bind(("127.0.0.1", port)).is_ok()
                && UdpSocket::bind(("127.0.0.1", port)).is_ok();
            if is_free {
                return port;
            }
        }
        panic!("no free TCP port from {} on", self.first);
    }
}

/// A TCP port on the loopback interface that is free, and that no other test gets.
///
/// # Panics
///
/// None is free.
pub fn free_tcp_port() -> u16 {
    static PORTS: Mutex<Option<Ports>> = Mutex::new(None);
    let mut ports = PORTS.lock().unwrap_or_else(PoisonError::into_inner);
    ports.get_or_insert_with(Ports::take).next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn none_is_given_twice_and_none_that_is_taken() {
        let (mut one, mut other) = (Ports::take(), Ports::take());
        assert_ne!(one.first, other.first);
        let ports: Vec<u16> = (0..20).map(|_| one.next()).collect();
        let range = one.first..one.first + BLOCK;
        assert!(
            ports.is_sorted_by(|one, two| one < two) && ports.iter().all(|own| range.contains(own))
        );
        let port = other.next();
        let _held = TcpListener::bind(("127.0.0.1", port)).unwrap();
        other.handed_out -= 1;
        assert_ne!(other.next(), port);
    }
}

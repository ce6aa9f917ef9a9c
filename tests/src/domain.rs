//! ROS domains, one a test.

use std::{fs::File, process};

use crate::lock_file::try_lock;

/// Above domain 100 the ports of DDS (7400 + 250 a domain) reach the range from
/// which Linux hands out ephemeral ports (32768 and up). Zero is everybody's.
const FIRST: u32 = 1;
const COUNT: u32 = 100;

/// A ROS domain that no other test holds.
#[derive(Debug)]
pub struct Domain {
    number: u32,
    _lock: File,
}

impl Domain {
    /// Takes one.
    ///
    /// # Panics
    ///
    /// All are taken, or the lock files cannot be written.
    pub fn take() -> Domain {
        for offset in 0..COUNT {
            let number = FIRST + (process::id() + offset) % COUNT;
            if let Some(lock) = try_lock(&format!("ferntast-tests-domain-{number}.lock")) {
                return Domain {
                    number,
                    _lock: lock,
                };
            }
        }
        panic!("all {COUNT} ROS domains are taken by other tests");
    }

    /// 1 to 100.
    pub fn number(&self) -> u32 {
        self.number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_tests_never_share_a_domain() {
        let one = Domain::take();
        let other = Domain::take();
        assert_ne!(one.number(), other.number());
        for domain in [&one, &other] {
            assert!((FIRST..FIRST + COUNT).contains(&domain.number()));
        }
    }
}

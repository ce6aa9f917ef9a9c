//! ROS domains, one a test.

use std::{
    env,
    fs::{File, TryLockError},
    process,
};

/// Above domain 100 the ports of DDS (7400 + 250 a domain) reach the range from
/// which Linux hands out ephemeral ports (32768 and up). Zero is everybody's.
const FIRST: u32 = 1;
const COUNT: u32 = 100;

/// A ROS domain that no other test holds.
///
/// A lock on a file keeps it, which the system drops if the process dies. The
/// Python tests lock the same files.
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
            let path = env::temp_dir().join(format!("ferntast-tests-domain-{number}.lock"));
            let lock = File::create(&path)
                .unwrap_or_else(|error| panic!("cannot write {}: {error}", path.display()));
            match lock.try_lock() {
                Ok(()) => {
                    return Domain {
                        number,
                        _lock: lock,
                    };
                }
                Err(TryLockError::WouldBlock) => {}
                Err(TryLockError::Error(error)) => {
                    panic!("cannot lock {}: {error}", path.display())
                }
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

//! Files whose locks say what is taken on this machine.

use std::{
    env,
    fs::{File, TryLockError},
};

/// The file of that name, locked until it is dropped or the process dies; `None` where another
/// test holds it. The Python tests lock the same files.
///
/// # Panics
///
/// It cannot be written or locked.
pub(crate) fn try_lock(name: &str) -> Option<File> {
    let path = env::temp_dir().join(name);
    let lock = File::create(&path)
        .unwrap_or_else(|error| panic!("cannot write {}: {error}", path.display()));
    match lock.try_lock() {
        Ok(()) => Some(lock),
        Err(TryLockError::WouldBlock) => None,
        Err(TryLockError::Error(error)) => panic!("cannot lock {}: {error}", path.display()),
    }
}

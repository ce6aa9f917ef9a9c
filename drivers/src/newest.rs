//! The newest values, from one thread to another, without locks.

use std::sync::atomic::{AtomicU64, Ordering, fence};

/// `N` numbers that belong together. One thread writes; none waits for another (a seqlock).
pub struct Newest<const N: usize> {
    /// Odd while they are being written.
    version: AtomicU64,
    values: [AtomicU64; N],
}

impl<const N: usize> Newest<N> {
    /// Zeros, of version zero.
    pub fn new() -> Newest<N> {
        Newest {
            version: AtomicU64::new(0),
            values: [const { AtomicU64::new(0) }; N],
        }
    }

    /// Puts `values` there. Only one thread may.
    pub fn write(&self, values: &[f64; N]) {
        let version = self.version.load(Ordering::Relaxed);
        self.version.store(version + 1, Ordering::Relaxed);
        fence(Ordering::Release);
        for (place, value) in self.values.iter().zip(values) {
            place.store(value.to_bits(), Ordering::Relaxed);
        }
        self.version.store(version + 2, Ordering::Release);
    }

    /// What is there, with a version that every writing makes another one; nothing where it is
    /// written just now, again and again.
    pub fn read(&self) -> Option<(u64, [f64; N])> {
        const ATTEMPTS: usize = 16;
        for _ in 0..ATTEMPTS {
            let before = self.version.load(Ordering::Acquire);
            let mut values = [0.0; N];
            for (place, value) in self.values.iter().zip(&mut values) {
                *value = f64::from_bits(place.load(Ordering::Relaxed));
            }
            fence(Ordering::Acquire);
            let after = self.version.load(Ordering::Relaxed);
            if before == after && before.is_multiple_of(2) {
                return Some((before, values));
            }
            std::hint::spin_loop();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn what_is_read_was_written_together() {
        let (newest, enough) = (Newest::<20>::new(), AtomicBool::new(false));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let mut number = 0.0;
                while !enough.load(Ordering::Relaxed) {
                    number += 1.0;
                    newest.write(&[number; 20]);
                }
            });
            let (mut seen, mut different, mut whole) = (0.0, 0, true);
            while different < 10 && whole {
                let Some((version, values)) = newest.read() else {
                    continue;
                };
                whole = values.iter().all(|value| *value == values[0])
                    && values[0] >= seen
                    && version == 2 * values[0] as u64;
                different += u32::from(values[0] > seen);
                seen = values[0];
            }
            enough.store(true, Ordering::Relaxed);
            assert!(whole, "something of {seen} and something of another");
        });
    }
}

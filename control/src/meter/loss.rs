//! Loss over a sliding second, by sequence number.

use super::behind;
use crate::nanoseconds;

/// Sequence numbers remembered: a second at 4 kHz. Power of two.
const REMEMBERED: usize = 4096;
/// Length of the window [s].
const WINDOW: f64 = 1.0;

/// What an arrival is, by its sequence number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// Newer than all before.
    Newest,
    /// Older than the newest, and not seen before as far as is remembered.
    Late,
    /// Seen before.
    Replayed,
}

#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    /// When its fate became known: its arrival, or that of a newer one [ns].
    known_ns: i64,
    arrived: bool,
}

/// Which sequence numbers arrived. The fate of a frame is known once it or a
/// newer one arrived; a late frame is not a lost one.
#[derive(Clone, Debug)]
pub struct LossWindow {
    slots: Box<[Slot; REMEMBERED]>,
    newest: Option<u32>,
    /// When the newest arrived [ns].
    newest_ns: i64,
    /// How many numbers, counting back from the newest, are remembered.
    remembered: u32,
    /// How many of them are within the window.
    inside: u32,
    /// How many of those did not arrive.
    missing: u32,
    lost: u64,
}

impl Default for LossWindow {
    fn default() -> Self {
        LossWindow::new()
    }
}

impl LossWindow {
    /// A window that has seen nothing.
    pub fn new() -> Self {
        LossWindow {
            slots: Box::new([Slot::default(); REMEMBERED]),
            newest: None,
            newest_ns: 0,
            remembered: 0,
            inside: 0,
            missing: 0,
            lost: 0,
        }
    }

    /// The sender counts from zero again; what was counted as lost stays so.
    pub fn restart(&mut self) {
        self.newest = None;
        self.remembered = 0;
        self.inside = 0;
        self.missing = 0;
    }

    /// LinkFrame `sequence` arrived at `now_ns`.
    pub fn arrived(&mut self, sequence: u32, now_ns: i64) -> Fate {
        match self.newest {
            None => self.append(sequence, true, now_ns),
            Some(newest) if behind(newest, sequence) => {
                let gap = sequence.wrapping_sub(newest) - 1;
                // Of a gap longer than the memory only the end is remembered.
                let kept = gap.min(REMEMBERED as u32 - 1);
                self.lost += u64::from(gap - kept);
                if kept < gap {
                    // What is remembered from before does not join on to it.
                    (self.remembered, self.inside, self.missing) = (0, 0, 0);
                }
                for missing in (1..=kept).rev() {
                    self.append(sequence.wrapping_sub(missing), false, now_ns);
                }
                self.append(sequence, true, now_ns);
            }
            Some(newest) => return self.arrived_behind(newest.wrapping_sub(sequence)),
        }
        self.newest_ns = now_ns;
        self.forget(now_ns);
        Fate::Newest
    }

    fn append(&mut self, sequence: u32, arrived: bool, known_ns: i64) {
        if self.remembered == REMEMBERED as u32 {
            // The slot is reused: it leaves the window now, if it was in it.
            if self.inside == self.remembered {
                self.leave(sequence);
            }
            self.remembered -= 1;
        }
        self.slots[index(sequence)] = Slot { known_ns, arrived };
        self.newest = Some(sequence);
        self.remembered += 1;
        self.inside += 1;
        if !arrived {
            self.missing += 1;
            self.lost += 1;
        }
    }

    fn arrived_behind(&mut self, back: u32) -> Fate {
        let Some(newest) = self.newest.filter(|_| back < self.remembered) else {
            return Fate::Late;
        };
        let slot = &mut self.slots[index(newest.wrapping_sub(back))];
        if slot.arrived {
            return Fate::Replayed;
        }
        slot.arrived = true;
        self.lost -= 1;
        if back < self.inside {
            self.missing -= 1;
        }
        Fate::Late
    }

    fn leave(&mut self, sequence: u32) {
        self.inside -= 1;
        if !self.slots[index(sequence)].arrived {
            self.missing -= 1;
        }
    }

    fn forget(&mut self, now_ns: i64) {
        let limit = now_ns.saturating_sub(nanoseconds(WINDOW));
        while let Some(newest) = self.newest
            && self.inside > 0
        {
            let oldest = newest.wrapping_sub(self.inside - 1);
            if self.slots[index(oldest)].known_ns > limit {
                break;
            }
            self.leave(oldest);
        }
    }

    /// Share that was lost in the second before `now_ns`, 0 … 1; 1 when
    /// nothing arrived in it; NaN before the first arrival.
    pub fn loss(&mut self, now_ns: i64) -> f64 {
        if self.newest.is_none() {
            return f64::NAN;
        }
        self.forget(now_ns);
        if self.inside == 0 {
            return 1.0;
        }
        f64::from(self.missing) / f64::from(self.inside)
    }

    /// Lost since the start.
    pub fn lost(&self) -> u64 {
        self.lost
    }
}

fn index(sequence: u32) -> usize {
    sequence as usize % REMEMBERED
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_longer_than_the_memory_is_all_that_was_lost() {
        const MS: i64 = 1_000_000;
        for before in [1, 700, 5000] {
            for gap in [4094_u32, 4095, 4096, 5000, 100_000] {
                let mut window = LossWindow::new();
                for sequence in 0..before {
                    window.arrived(sequence, i64::from(sequence) * MS);
                }
                // Of the second before, and of the number after the gap.
                let held_up = i64::from(before) * MS + 10_000 * MS;
                window.arrived(before + gap, held_up);
                assert_eq!(window.lost(), u64::from(gap), "{before}, {gap}");
                let kept = f64::from(gap.min(4095));
                let loss = window.loss(held_up);
                assert!((loss - kept / (kept + 1.0)).abs() < 1e-3, "{loss}");
                // A second of frames without loss later nothing is missing.
                for after in 1..=1100 {
                    let at = held_up + i64::from(after) * MS;
                    window.arrived(before + gap + after, at);
                }
                let end = held_up + 1100 * MS;
                assert_eq!(window.loss(end), 0.0, "{before}, {gap}");
            }
        }
    }
}

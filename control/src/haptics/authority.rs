//! Who drives: one source at a time.

use crate::nanoseconds;
use crate::planted::{Planted, Rule};

/// Another source holds the authority.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "source {source_id:#x} is refused: {holder:#x} holds the authority; it is free once that falls silent or is disabled"
)]
pub struct NotAuthorised {
    /// Who was refused.
    pub source_id: u64,
    /// Who holds it.
    pub holder: u64,
}

/// Which source drives. The first valid one takes the authority; it loses it
/// by silence or when it is released.
#[derive(Clone, Copy, Debug)]
pub struct Authority {
    release_after_ns: i64,
    holder: Option<(u64, i64)>,
    refused: Option<u64>,
    refused_count: u64,
    pub(super) planted: Planted,
}

impl Authority {
    /// Nobody holds it; released after `release_after` \[s\] of silence.
    pub fn new(release_after: f64) -> Self {
        Authority {
            release_after_ns: nanoseconds(release_after),
            holder: None,
            refused: None,
            refused_count: 0,
            planted: Planted::NONE,
        }
    }

    /// Who holds it.
    pub fn holder(&self) -> Option<u64> {
        self.holder.map(|(source, _)| source)
    }

    /// Who was refused last.
    pub fn refused(&self) -> Option<u64> {
        self.refused
    }

    /// Commands refused so far.
    pub fn refused_count(&self) -> u64 {
        self.refused_count
    }

    /// Takes it from a holder that has been silent for too long. Returns
    /// whether it did.
    pub fn age(&mut self, now_ns: i64) -> bool {
        let silent = self
            .holder
            .is_some_and(|(_, last_ns)| now_ns.saturating_sub(last_ns) > self.release_after_ns);
        if silent {
            self.holder = None;
        }
        silent
    }

    /// Whether `source` may drive at `now_ns`.
    ///
    /// # Errors
    ///
    /// [`NotAuthorised`] while another one holds it; counted.
    pub fn may(&mut self, now_ns: i64, source: u64) -> Result<(), NotAuthorised> {
        self.age(now_ns);
        match self.holder {
            Some((holder, _)) if holder != source && !self.planted.lacks(Rule::OneHand) => {
                self.refused = Some(source);
                self.refused_count += 1;
                Err(NotAuthorised {
                    source_id: source,
                    holder,
                })
            }
            _ => Ok(()),
        }
    }

    /// A valid command of `source` came at `now_ns`: it holds the authority.
    pub(super) fn take(&mut self, now_ns: i64, source: u64) {
        self.holder = Some((source, now_ns));
    }

    /// Nobody holds it from now on.
    pub fn release(&mut self) {
        self.holder = None;
    }
}

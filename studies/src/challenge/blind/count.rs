//! How often something was so.

use serde::Serialize;

/// A share, as found out of tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Count {
    /// How often it was so.
    pub found: usize,
    /// How often it was tried.
    pub tried: usize,
}

impl Count {
    pub(in crate::challenge) fn note(&mut self, found: bool) {
        self.found += usize::from(found);
        self.tried += 1;
    }

    /// found over tried; 0 where nothing was tried.
    pub fn share(self) -> f64 {
        match self.tried {
            0 => 0.0,
            tried => self.found as f64 / tried as f64,
        }
    }
}

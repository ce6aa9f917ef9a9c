//! Names of what a recording can hide.

use std::fmt::Display;

/// An effect that is in the truth of a recording and not in the model that the
/// experimenter believes in.
pub trait Hideable: Copy + Ord + Display + Send + Sync + 'static {
    /// All of them, the catalogue's first.
    const ALL: &'static [Self];

    /// Their ids in the same order.
    const IDS: &'static [&'static str];

    /// The id in files, on the command line and in JSON.
    fn id(self) -> &'static str;

    /// Its place among [`ALL`](Self::ALL).
    fn index(self) -> usize {
        Self::ALL.iter().take_while(|own| **own != self).count()
    }

    /// Ids that count as the right answer; empty outside the catalogue.
    fn accepted(self) -> &'static [&'static str] {
        self.own_id()
    }

    /// Its id as a list of one; empty outside the catalogue.
    fn own_id(self) -> &'static [&'static str] {
        let index = self.index();
        match self.in_catalogue() {
            true => Self::IDS.get(index..=index).unwrap_or_default(),
            false => &[],
        }
    }

    /// What both effects change, where they cannot act side by side.
    fn overlap(self, _other: Self) -> Option<&'static str> {
        None
    }

    /// True for an effect that the catalogue has.
    fn in_catalogue(self) -> bool {
        !self.id().starts_with("unknown_")
    }
}

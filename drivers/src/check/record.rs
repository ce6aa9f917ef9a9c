//! What was seen of an arm while it was looked at.

use std::collections::BTreeMap;

use ferntast_model::Joints;

use crate::driver::Reading;

/// A reading with its times.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// When it came, since the beginning \[s\]; time in which the looking itself was held up
    /// is left out.
    pub at: f64,
    /// When it was measured, by the arm's own clock, where that is told \[s\].
    pub stamp: Option<f64>,
    /// How much later than that it came by our clock, what the clocks are apart in it \[s\].
    pub delay: Option<f64>,
    /// What was measured.
    pub reading: Reading,
}

/// All that was seen.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The readings in the order in which they came.
    pub seen: Vec<Seen>,
    /// How long it was looked \[s\].
    pub seconds: f64,
    /// What the driver had to say, and for how long \[s\].
    pub words: BTreeMap<String, f64>,
}

impl Record {
    /// The driver had that to say for `seconds` \[s\]. What differs in its numbers only is one word.
    pub fn say(&mut self, words: &str, seconds: f64) {
        let letters = |words: &str| words.replace(|own: char| own.is_ascii_digit(), "");
        let same = |known: &str| letters(known) == letters(words);
        match self.words.iter_mut().find(|(known, _)| same(known)) {
            Some((_, told)) => *told += seconds,
            None => {
                self.words.insert(words.to_owned(), seconds);
            }
        }
    }

    /// Values of a joint, those that were not measured left out.
    pub fn of<'a>(
        &'a self,
        joint: usize,
        value: impl Fn(&Reading) -> Option<Joints<f64>> + 'a,
    ) -> impl Iterator<Item = f64> + 'a {
        let values = self.seen.iter().filter_map(move |own| value(&own.reading));
        values.map(move |own| own[joint])
    }
}

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

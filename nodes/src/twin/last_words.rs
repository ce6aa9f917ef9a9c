//! What each joint's twin said last.

use std::collections::BTreeMap;

use ferntast_bus::{Bus, CreateError, Depth, Subscriber};
use ferntast_msgs::{Time, sample::TwinParametersSample, topics};

use super::TwinSummary;

/// Listens to `/twin/parameters`, on which the twins speak in turn.
pub struct LastWords {
    said: Subscriber<TwinParametersSample>,
    by_joint: BTreeMap<String, TwinParametersSample>,
}

impl LastWords {
    /// Of the twins on `bus`.
    ///
    /// # Errors
    ///
    /// The topic cannot be opened.
    pub fn new(bus: &Bus) -> Result<LastWords, CreateError> {
        Ok(LastWords {
            said: bus.subscriber(topics::TWIN_PARAMETERS, Depth::Queue(16))?,
            by_joint: BTreeMap::new(),
        })
    }

    /// Takes in what was said until `now`.
    pub fn update(&mut self, now: Time) {
        while let Some(own) = self.said.next(now) {
            self.by_joint
                .insert(own.message.joint.to_string(), own.message);
        }
    }

    /// The last word of each twin, by joint.
    pub fn summaries(&self) -> Vec<TwinSummary> {
        self.by_joint.values().map(TwinSummary::of).collect()
    }
}

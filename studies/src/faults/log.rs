//! What was said and done in a schedule so far, as invariants have to know it.

use super::fault::{Device, Word};

/// A word of the operator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Said {
    /// When \[step\].
    pub tick: i64,
    /// To whom.
    pub device: Device,
    /// What.
    pub word: Word,
}

impl Said {
    /// Whether it is for `device`.
    pub fn is_for(&self, device: Device) -> bool {
        self.device == device || self.device == Device::Both
    }

    /// Whether it lets a device go.
    pub fn arms(&self) -> bool {
        matches!(self.word, Word::Enable | Word::Resume)
    }
}

/// What was said and done so far.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// The operator's words, oldest first.
    pub words: Vec<Said>,
    /// What the page's sliders add to the way of a frame at most \[steps\].
    pub channel_delay: i64,
    /// Whether frames are lost by the page's sliders.
    pub channel_loses: bool,
    /// When the law was last asked to change, a node last started or stopped, or
    /// a frame last lost or held back beyond what the channel does \[step\].
    pub disturbed: i64,
    /// When the arm's sensors last began or ceased to be wrong \[step\]; `i64::MAX`
    /// while they are.
    pub sensor_wrong: i64,
    /// Whether another law was asked for.
    pub law_switched: bool,
    /// When the master was last not run \[step\].
    pub master_stalled: i64,
    /// When the operator's host was last not run \[step\].
    pub operator_side_stalled: i64,
    /// What must have been refused by the gateways since they were started.
    pub gateway_refusable: [(u64, i64); 2],
}

//! What does not hold.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

/// What does not hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// The invariant.
    pub invariant: Cow<'static, str>,
    /// When \[ms after the start\].
    pub at_ms: i64,
    /// How.
    pub told: String,
}

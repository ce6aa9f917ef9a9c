//! Whether an arm can be what its file says, from what it measures: `ferntast arm check`.
//!
//! [`look`] reads an arm for some seconds and moves nothing, [`drive`] moves its joints one after
//! the other while a key is held; [`judge`] says what of it is implausible. Judging, moving and the
//! key are pure; [`looking`] has the loops.

mod expected;
mod finding;
mod held_key;
mod joint;
mod judge;
mod looking;
mod mover;
mod record;
#[cfg(test)]
mod tests;
mod timing;

pub use expected::{Expected, ExpectedJoint, Torque};
pub use finding::{Finding, Severity};
pub use held_key::{HeldKey, RELEASED};
pub use joint::JointReport;
pub use judge::{Report, judge};
pub use looking::{drive, look};
pub use mover::{Drive, Moved, Mover, Progress};
pub use record::{Record, Seen};
pub use timing::Timing;

//! Many arms' twins: what they say day by day, and which joint ages differently from its
//! siblings.
//!
//! [`ageing`] is the pure part: days in, findings out. [`DaySummary`] is a day of a joint,
//! [`Aggregate`] makes it of what a twin says, live ([`Listener`], over Zenoh) or
//! in a recording ([`days_of`]); [`Fleet`] brings days in their order before [`ageing::Watch`].

pub mod ageing;
mod aggregate;
mod fleet;
mod listener;
mod recording;
mod summary;

pub use aggregate::Aggregate;
pub use fleet::{Fleet, Named, Told};
pub use listener::{ListenError, Listener};
pub use recording::{RecordedError, days_of};
pub use summary::{DaySummary, ParameterOfDay, SummaryError, days, read};

//! Recordings for other programs: CSV and Parquet, one table a topic or all at one rate,
//! and datasets of LeRobot.
//!
//! * [`tables`]: what is written where,
//! * [`lerobot`]: a dataset, one episode a recording.
//!
//! Columns are the numbers of messages, with their units as far as the types say them:
//! `position[0]_rad`. Texts are left out, of arrays all but the first eight elements.

mod csv;
mod error;
mod joined;
pub mod lerobot;
mod parquet;
mod table;
mod tables;
mod topic;
mod unit;

pub use error::ExportError;
pub use tables::{Format, Request, Written, tables};

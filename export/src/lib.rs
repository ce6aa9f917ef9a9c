//! Recordings for other programs: CSV and Parquet, one table a topic or all at one rate,
//! and datasets of LeRobot; and what the lab identified, as models for simulators and drivers.
//!
//! * [`tables`]: what is written where,
//! * [`lerobot`]: a dataset, one episode a recording,
//! * [`identified`]: URDF, SDF, MuJoCo, Universal Robots, an arm's file.
//!
//! Columns are the numbers of messages, with their units as far as the types say them:
//! `position[0]_rad`. Texts are left out, of arrays all but the first eight elements.

mod csv;
mod error;
pub mod identified;
mod joined;
pub mod lerobot;
mod parquet;
mod table;
mod tables;
mod topic;
mod unit;

pub use error::ExportError;
pub use tables::{Format, Request, Written, tables};

//! `builtin_interfaces`.

mod time;

pub use time::Time;

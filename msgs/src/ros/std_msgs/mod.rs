//! `std_msgs`.

mod header;

pub use header::Header;

//! `std_msgs`.

mod header;
mod string;

pub use header::Header;
pub use string::String;

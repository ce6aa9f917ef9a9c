//! `std_msgs`.

mod float64_multi_array;
mod header;
mod string;

pub use float64_multi_array::{Float64MultiArray, MultiArrayDimension, MultiArrayLayout};
pub use header::Header;
pub use string::String;

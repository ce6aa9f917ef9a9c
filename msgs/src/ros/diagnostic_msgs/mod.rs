//! `diagnostic_msgs`.

mod diagnostic_array;
mod diagnostic_status;
mod key_value;

pub use diagnostic_array::DiagnosticArray;
pub use diagnostic_status::DiagnosticStatus;
pub use key_value::KeyValue;

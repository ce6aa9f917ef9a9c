//! Reads numbers out of messages of any type: the schema that the recording
//! carries (`ros2msg`) says how their CDR is laid out.
//!
//! A schema becomes a [`Layout`], a message path becomes a [`Selection`] of
//! it, and a [`Reader`] then takes the number out of every message, passing
//! over what lies before it. Whatever comes in is bounded: no memory is set
//! aside by what a length field says, and types may not contain themselves.

mod cursor;
mod error;
mod layout;
mod list;
mod read;
mod select;
#[cfg(test)]
mod tests;

pub use error::{DecodeError, SchemaError, SelectError};
pub use layout::Layout;
pub use list::numeric_paths;
pub use read::{Found, Reader};
pub use select::Selection;

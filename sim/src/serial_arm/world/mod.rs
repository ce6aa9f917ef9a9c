//! What the tip of a serial arm can touch.

mod object;
mod shape;

pub(super) use object::Object;
pub use object::{Motion, ObjectParameters};
pub use shape::{Near, Shape};

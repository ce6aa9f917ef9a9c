//! What the tip of a serial arm can touch.

mod object;
mod surface;

pub(super) use object::Object;
pub use object::{Motion, ObjectParameters};
pub use surface::Near;

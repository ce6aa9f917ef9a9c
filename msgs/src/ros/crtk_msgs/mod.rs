//! `crtk_msgs`: the collaborative robotics toolkit.

mod operating_state;
mod string_stamped;

pub use operating_state::OperatingState;
pub use string_stamped::StringStamped;

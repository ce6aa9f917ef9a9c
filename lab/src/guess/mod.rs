//! What names and numbers say of a signal and its unit. Pure: what was seen of a
//! file is an argument.

mod joints;
mod names;
mod roles;
mod values;

pub use joints::{array_by_name, by_joint};
pub use names::unit_in_name;
pub use roles::{Role, by_name, opposes};
pub use values::{angle_unit, time_unit};

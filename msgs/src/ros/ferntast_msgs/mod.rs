//! `ferntast_msgs`: ferntast's own.

mod authority;
mod contact_state;
mod friction_status;
mod link_command;
mod link_status;
mod recorder_command;
mod recorder_status;
mod twin_parameters;

pub use authority::Authority;
pub use contact_state::ContactState;
pub use friction_status::FrictionStatus;
pub use link_command::LinkCommand;
pub use link_status::LinkStatus;
pub use recorder_command::RecorderCommand;
pub use recorder_status::RecorderStatus;
pub use twin_parameters::TwinParameters;

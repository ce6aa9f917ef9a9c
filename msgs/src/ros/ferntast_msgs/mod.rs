//! `ferntast_msgs`: ferntast's own.

mod authority;
mod contact_state;
mod link_status;
mod twin_parameters;

pub use authority::Authority;
pub use contact_state::ContactState;
pub use link_status::LinkStatus;
pub use twin_parameters::TwinParameters;

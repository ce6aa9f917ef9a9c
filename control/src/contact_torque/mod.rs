//! The torque of what an arm touches, Jᵀ F, from joint torques and motion: equation (5).
//!
//! The estimator makes forces of it, quietly and late; the servo stops at what the arm runs
//! into, with filters that are quick.

mod filter;
mod filtered_motion;
mod form;
mod links;
mod observer;

pub use filter::DerivativeFilter;
pub(crate) use filtered_motion::FilteredMotion;
pub use form::Form;
pub(crate) use form::{TorqueOfContact, half_as_late};
pub(crate) use links::Links;

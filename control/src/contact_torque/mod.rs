//! The torque of what an arm touches, Jᵀ F, from joint torques and motion: equation (5).
//!
//! The estimator makes forces of it, quietly and late; the servo stops at what the arm runs
//! into, with filters that are quick.

mod filter;
mod filtered_motion;
mod form;
mod links;
mod measured;
mod observer;

pub use filter::DerivativeFilter;
pub(crate) use filtered_motion::FilteredMotion;
pub use form::Form;
use form::TorqueOfContact;
pub(crate) use form::half_as_late;
pub(crate) use links::Links;
pub(crate) use measured::MeasuredContact;

//! What a session is made of: scenarios, and the files that they name.

mod arm;
mod error;
mod file;
mod laws;
mod load;
mod scenario;
mod shipped;

#[cfg(test)]
pub use arm::load_model_only;
pub use arm::{ArmFile, LoadArm};
pub use error::ConfigError;
pub use file::{ARM, FileKind, load};
pub use laws::UnknownLaw;
pub use load::{Loaded, load_scenario, read_hand_recording};
pub use scenario::*;

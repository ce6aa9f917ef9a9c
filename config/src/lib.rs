//! What a session is made of: scenarios, and the files that they name, those that ship (beside this
//! folder) and those on disk.
//!
//! Apart from the nodes, which run in a control cycle: what reads files is most of the code and
//! need not be fast.

mod arm;
mod axes;
mod changes;
mod error;
mod file;
mod haply;
pub mod json;
mod laws;
mod leader;
mod load;
mod scenario;
pub mod serial;
pub mod shipped;

use ferntast_model::ArmModel;
use ferntast_msgs::sample::{JointNames, MAX_JOINTS};

pub use arm::{ArmFile, Believed, LoadArm, load_model_only};
pub use axes::Axes;
pub use changes::{ChangeError, Changes};
pub use error::ConfigError;
pub use file::{ARM, FileKind, load};
pub use haply::HaplyConfig;
pub use laws::{UnknownLaw, stiff_enough};
pub use leader::LeaderConfig;
pub use load::{LINK, Loaded, SCENARIO, known_links, load_scenario, read_hand_recording};
pub use scenario::*;

// What a law has room for fits a message, and the other way round.
const _: () = assert!(MAX_JOINTS == ferntast_model::MAX_JOINTS);

/// The planar arm's joints, in the order of its parameters.
pub fn joint_names(model: &ArmModel) -> JointNames {
    JointNames::numbered(model.joint.len())
}

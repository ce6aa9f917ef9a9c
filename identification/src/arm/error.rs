//! What an arm's recordings or model lack.

use crate::data::error::PrepareError;

/// Why an arm's model cannot be bound to recordings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ArmError {
    /// It is so with one joint.
    #[error("{joint}: {source}")]
    Joint {
        /// Its name.
        joint: String,
        /// What is wrong.
        source: Box<PrepareError>,
    },
    /// Recordings or model have not one of each for each joint.
    #[error("{what}: {found} where the arm has {joints} joints; give one for each")]
    Count {
        /// Of what.
        what: String,
        /// So many.
        found: usize,
        /// As many as are needed.
        joints: usize,
    },
    /// An effect of a joint that is not there.
    #[error("{effect}@{joint}: the arm has no such joint; its joints are {known}")]
    UnknownJoint {
        /// The effect.
        effect: String,
        /// The joint that is named.
        joint: String,
        /// Joints that there are.
        known: String,
    },
    /// An effect of the arm with a joint, or one of a link without.
    #[error("{effect}: {reason}")]
    Place {
        /// The effect.
        effect: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The same effect is there already.
    #[error("{0} is in the model already")]
    Twice(String),
}

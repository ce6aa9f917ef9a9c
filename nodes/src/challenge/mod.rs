//! Recordings with a hidden effect: one to learn on, many as a blind test.

mod bench;
mod blind;
mod folder;

pub use bench::{dataset, hidden_by, model};
pub use blind::{BlindTest, Count, FollowedUp, Miss, Plan, run as blind_test};
pub use folder::{Answer, ChallengeError, create, reveal};

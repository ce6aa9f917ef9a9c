//! Recordings with a hidden effect, of a joint or of a contact: one to learn on,
//! many as a blind test.

mod asked;
mod bench;
mod blind;
mod discovery;
mod folder;

pub use asked::{Asked, make};
pub use bench::{TestBench, WriteError, hidden_by};
pub use blind::{BlindTest, Count, Coverage, FollowedUp, Miss, Outside, Plan, run as blind_test};
pub use discovery::{Answered, DiscoveryTest, LawPlan, run as discovery_test};
pub use folder::{Answer, ChallengeError, create, reveal};

//! Recordings with a hidden effect, of a joint or of a contact: one to learn on,
//! many as a blind test.

mod asked;
mod bench;
mod blind;
mod discovery;
mod folder;

pub use asked::{Asked, make};
pub use bench::{TestBench, WriteError, hidden_by};
pub use blind::{
    Answer as BlindAnswer, BlindTest, Count, Coverage, FollowedUp, Miss, Outside, Plan, RealAnswer,
    RealLikeRow,
};
pub use discovery::{Answered, DiscoveryTest, LawPlan};
pub use folder::{Answer, ChallengeError, create, reveal};

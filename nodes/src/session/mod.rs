//! A session: processes, their supervision, the live line, the summary.

mod error;
mod host_resources;
mod live;
mod monitor;
mod play;
mod preflight;
mod recording;
mod run;
mod summary;
mod supervisor;

pub use error::SessionError;
pub use host_resources::runtime_folder;
pub use monitor::Monitor;
pub use play::{Played, play, recorded_joints};
pub use run::{SessionOptions, run};
pub use summary::{ContactSummary, LeaderSummary, LinkSummary, StateSummary, Summary};
pub use supervisor::{EXIT_REFUSED, Supervisor, SupervisorError};

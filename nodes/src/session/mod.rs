//! A session: processes, their supervision, the live line, the summary.

mod live;
mod monitor;
mod place;
mod play;
mod run;
mod summary;
mod supervisor;

pub use monitor::Monitor;
pub use place::runtime_folder;
pub use play::{Played, play};
pub use run::{SessionError, SessionOptions, run};
pub use summary::{ContactSummary, LeaderSummary, LinkSummary, StateSummary, Summary};
pub use supervisor::{EXIT_REFUSED, Supervisor, SupervisorError};

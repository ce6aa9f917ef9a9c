//! A session: processes, their supervision, the live line, the summary.

mod error;
mod felt_stiffness;
mod host_resources;
mod live;
mod monitor;
mod node_view;
mod play;
mod preflight;
mod private_folder;
mod recording;
mod run;
mod scripted_operator;
mod state_times;
mod summary;
mod supervisor;
mod thinned;
mod touch;

pub use error::SessionError;
pub use host_resources::{Visit, runtime_folder};
pub use monitor::Monitor;
pub use play::{Played, play, recorded_joints};
pub use private_folder::PrivateFolderError;
pub(crate) use run::ROUND_NANOS;
pub use run::{SessionOptions, run};
pub use summary::{
    ArmSummary, ContactSummary, LeaderSummary, LinkSummary, StateSummary, Summary, TipSummary,
};
pub use supervisor::{EXIT_REFUSED, RESTART_LIMIT, RESTART_PAUSE, Supervisor, SupervisorError};

//! What every process of a session has: its clock, the loop that it runs, the
//! signals that end it, and what it knows of the session.

mod clock;
mod context;
mod end;
mod error;
pub mod link_end;
pub mod link_keys;
pub mod periodic;
mod priority;
mod session_context;
mod signals;

pub use clock::Clock;
pub use context::ProcessContext;
pub use end::End;
pub use error::NodeError;
pub use priority::{Priority, Scheduling};
pub use session_context::{ConsoleOptions, ContextError, PlayOptions, SessionContext};
pub use signals::{SUPERVISOR_DIED, end_after_a_stop, stop_on_signals};

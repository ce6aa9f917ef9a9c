//! One page in the browser: the console of a session, and the lab.
//!
//! ```text
//! browser ── HTTP, WebSocket ── server ┬ session: shared_session ── the bus
//!                                      └ lab: work of `ferntast-lab`
//! ```
//!
//! * [`server`]: listens, and asks [`guard`] about every request; `connections`
//!   and `bodies` say how many there may be, how long and how slow,
//! * [`assets`]: the page itself; nothing comes from a network,
//! * [`session`]: who operates a session, what is shown there, and
//!   the hand that the mouse moves,
//! * [`lab`]: recordings and experiments of a folder.

pub mod assets;
mod bodies;
mod connections;
mod error;
pub mod guard;
pub mod lab;
pub mod server;
pub mod session;

pub use error::ServerError;
pub use server::{Listen, Server};

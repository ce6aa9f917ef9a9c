//! Harness of the whole-system tests: finds the program and its peers, starts
//! them apart from whatever else runs on this machine, and leaves nothing behind.
//!
//! A test opens a [`Session`], starts [`Process`]es in it, and drops both.
//! What is missing (program, data, Python environment) panics with a text that
//! says how to mend it: a test that cannot run has failed.

mod browser;
mod deadline;
mod domain;
mod hosts;
mod places;
mod process;
mod session;

pub use browser::Browser;
pub use deadline::{wait_for, wait_until};
pub use domain::Domain;
pub use hosts::{Host, TwoHosts};
pub use places::{data, ferntast, peer, python, root};
pub use process::{Ended, Process};
pub use session::{Session, free_tcp_port};

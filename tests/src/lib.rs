//! Harness of the whole-system tests: finds the program and its peers, starts
//! them apart from whatever else runs on this machine, and leaves nothing behind.
//!
//! A test opens a [`Session`], starts [`Process`]es in it, and drops both.
//! What is missing (program, data, Python environment) panics with a text that
//! says how to correct it: a test that cannot run has failed. Tests of bounds in
//! milliseconds hold the [`Machine`], which measures when it stalled.

mod browser;
mod busy;
mod command;
mod deadline;
mod deputy;
mod domain;
mod hosts;
mod laws;
mod live;
mod lock_file;
mod machine;
mod memory;
mod pair;
mod places;
mod ports;
mod process;
mod python;
mod room;
mod session;
mod stranger;
#[path = "../shared/thorough.rs"]
mod thorough;

pub use browser::Browser;
pub use busy::BusyLoops;
pub use command::{JOINT_2, PATIENCE, experiment_on_joint_2, messages, number, refused, run};
pub use deadline::{wait_for, wait_until};
pub use deputy::{Deputy, Sight};
pub use domain::Domain;
pub use hosts::{Host, LINK_KEYS, TwoHosts};
pub use laws::{force_steps, laws, switches};
pub use live::{
    arm_state, await_armed, await_enabled, hand_of_strokes, hand_through, human_hand, keep_enabled,
    node, operated, rearm, rearmed, recording, set_parameter, signal, start, state,
    state_of_follower,
};
pub use machine::{Machine, Window, now};
pub use memory::{MemoryLog, own_memory};
pub use pair::{Member, Pair, PairOptions, Word};
pub use places::{data, ferntast, peer, python, root};
pub use ports::free_tcp_port;
pub use process::{Ended, Process, limit_files};
pub use python::{ask_python, process_driver};
pub use session::Session;
pub use stranger::{Stranger, certificate_of};
pub use thorough::is_thorough;

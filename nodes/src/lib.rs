//! The nodes, their configuration, and what runs them: supervisor, lockstep, replay.

pub mod arm;
pub mod carry;
mod choice_parameter;
pub mod clock;
pub mod config;
mod console;
pub mod estimator;
mod foxglove;
pub mod gateway;
pub mod link;
pub mod lockstep;
pub mod master;
pub mod node;
pub mod node_name;
mod pace;
mod player;
pub mod process;
mod recorder;
mod relay;
pub mod replay;
mod say;
pub mod servo;
pub mod session;
pub mod stop;
pub mod twin;

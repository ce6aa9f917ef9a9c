//! The nodes, their supervisor and the ferntast command.

pub mod arm;
pub mod carry;
pub mod challenge;
pub mod clock;
pub mod command;
pub mod config;
pub mod doctor;
pub mod estimator;
mod gateway;
mod law_parameter;
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
mod stop;
pub mod sweep;
pub mod twin;

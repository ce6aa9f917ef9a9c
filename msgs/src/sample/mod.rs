//! The messages as nodes read and write them: fixed size, `repr(C)`.

mod authority;
mod checks;
mod contact_state;
mod fault;
mod frame;
mod health;
mod joint;
mod law_command;
mod link_command;
mod link_status;
mod operating_state;
mod pose;
mod recorder_command;
mod recorder_status;
mod state_command;
mod temperature;
mod twin_parameters;
mod wrench;

pub use authority::AuthoritySample;
pub use contact_state::{ContactStateSample, Edge};
pub use fault::{Fault, Faults};
pub use frame::Frame;
pub use health::{HealthSample, Level};
pub use joint::{JOINT_NAMES, JOINTS, JointFields, JointSample};
pub use law_command::LawCommandSample;
pub use link_command::LinkCommandSample;
pub use link_status::{LinkEnd, LinkStatusSample, RefusedFrames};
pub use operating_state::{OperatingState, OperatingStateSample};
pub use pose::PoseSample;
pub use recorder_command::{RecorderAction, RecorderCommandSample};
pub use recorder_status::RecorderStatusSample;
pub use state_command::{StateCommand, StateCommandSample};
pub use temperature::TemperatureSample;
pub use twin_parameters::{MOST_PARAMETERS, TwinParametersSample, TwinVerdict};
pub use wrench::WrenchSample;

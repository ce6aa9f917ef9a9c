//! `sensor_msgs`.

mod joint_state;
mod temperature;

pub use joint_state::JointState;
pub use temperature::Temperature;

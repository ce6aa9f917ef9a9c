//! What takes longer than the rest together.

mod deadband;
mod true_ports;
mod whole_arm;

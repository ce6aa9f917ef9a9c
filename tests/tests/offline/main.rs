//! The program in virtual time and on recordings: no real time, and no peers but in `independent`.

mod delay;
mod estimator;
mod experiments;
mod faults;
mod felt_stiffness;
mod fleet;
mod independent;
mod installed;
mod lab;
mod lab_contact;
mod lab_large;
mod lab_new;
mod lab_trend;
mod laws;
mod lockstep;
mod long;
mod outside_recordings;
mod own_tools;
mod playback;
mod refusals;
mod serial_arm;
mod shards;
mod sweep;
mod twin;

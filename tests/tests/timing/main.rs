//! Sessions in real time whose bounds are milliseconds or rates.
//!
//! One at a time: each holds the [`ferntast_tests::Machine`], and its bounds
//! allow for what the machine itself stalled in the same window.

mod delay;
mod intruder;
mod laws;
mod overload;
mod playback;
mod rates;
mod session;
mod two_hosts;
mod watchdog;

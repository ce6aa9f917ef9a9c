//! The whole system: sessions with all their processes, against real peers.

mod crashes;
mod delay;
mod dynamics;
mod estimator;
mod lab;
mod lockstep;
mod masters;
mod paper;
mod playback;
mod refusals;
mod ros;
mod session;
mod support;
mod watchdog;
mod zenoh;

//! The whole system: sessions with all their processes, against real peers.

mod console;
mod crashes;
mod delay;
mod lab;
mod lab_page;
mod lockstep;
mod masters;
mod playback;
mod refusals;
mod ros;
mod session;
mod support;
mod watchdog;
mod zenoh;

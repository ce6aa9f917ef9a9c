//! The whole system: sessions with all their processes, against real peers.

mod bad_frames;
mod console;
mod crashes;
mod delay;
mod dynamics;
mod estimator;
mod lab;
mod lab_contact;
mod lab_page;
mod laws;
mod lockstep;
mod masters;
mod own_tools;
mod paper;
mod playback;
mod refusals;
mod ros;
mod session;
mod support;
mod sweep;
mod twin;
mod two_hosts;
mod watchdog;
mod zenoh;

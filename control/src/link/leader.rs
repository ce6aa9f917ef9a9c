//! The operator's end of the link.

use super::end::End;
use super::velocity::VelocityFilter;
use super::{LinkState, StampedPosition};
use crate::arming::ArmingCount;
use crate::frame::FRAME_LENGTH;
use crate::operating::OperatingState;
use crate::switching::{Laws, LeaderSwitch};

/// A hand older than this \[s\] is not sent on: it would only be repeated, and
/// the arm's watchdog has to see at once that the hand is silent.
pub const HAND_LIFE: f64 = 0.004;

/// What a step of the operator's end takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeaderReadings {
    /// The hand, newest measurement.
    pub hand: Option<StampedPosition>,
    /// Operating state of the master.
    pub state: OperatingState,
}

/// What a step of the operator's end gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeaderStep {
    /// Force on the hand \[N\].
    pub force: [f64; 3],
    /// To send, when a frame is due.
    pub frame: Option<[u8; FRAME_LENGTH]>,
}

/// The operator's end of the link.
#[derive(Clone, Debug)]
pub struct LeaderLink {
    end: End,
    law: LeaderSwitch,
    velocity: VelocityFilter,
    arming: ArmingCount,
}

impl LeaderLink {
    /// An end that starts with the first of `laws` and may switch to the others.
    /// Frames wait for up to `buffer` \[s\] to be played out evenly.
    pub fn new(laws: Laws, session: u16, buffer: f64) -> LeaderLink {
        LeaderLink {
            end: End::new(session, buffer),
            law: LeaderSwitch::new(laws),
            velocity: VelocityFilter::default(),
            arming: ArmingCount::default(),
        }
    }

    /// The operator wishes to re-arm: says so in every frame from now on.
    pub fn rearm(&mut self) {
        self.arming.add();
    }

    /// Asks for the law of that code; `false` if there is none.
    pub fn switch_to(&mut self, code: u8) -> bool {
        self.law.switch_to(code)
    }

    /// Bytes arrived at `arrived_ns`, to be acted on in the next step at the earliest.
    pub fn arrived(&mut self, bytes: &[u8], arrived_ns: i64) {
        self.end.arrived(bytes, arrived_ns);
    }

    /// One step at `now_ns`.
    pub fn step(&mut self, now_ns: i64, readings: &LeaderReadings) -> LeaderStep {
        self.end.take(now_ns);
        let hand = self.velocity.fresh(readings.hand, HAND_LIFE);
        let dt = self.end.elapsed(now_ns);
        let connected = self.end.connected(now_ns);
        let step = self.law.step(dt, hand, self.end.newest(now_ns), connected);
        LeaderStep {
            force: step.force,
            frame: self
                .end
                .send(now_ns, readings.state, self.arming.get(), step.outgoing),
        }
    }

    /// What is known at `now_ns`.
    pub fn state(&mut self, now_ns: i64) -> LinkState {
        LinkState {
            connected: self.end.connected(now_ns),
            measured: self.end.measure(now_ns),
            law: self.law.name(),
            energy: self.law.energy(),
            dissipated: self.law.dissipated(),
        }
    }
}

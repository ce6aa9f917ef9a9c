//! The arm's end of the link.

use super::end::End;
use super::velocity::VelocityFilter;
use super::{LinkState, StampedPosition};
use crate::arming::ArmingWatch;
use crate::delay::Motion;
use crate::frame::FRAME_LENGTH;
use crate::operating::OperatingState;
use crate::switching::{FollowerSwitch, Laws};

/// A tip or contact force that was estimated longer ago than this \[s\] is not sent.
pub const ESTIMATE_LIFE: f64 = 0.010;

/// What a step of the arm's end takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowerReadings {
    /// The tip, newest estimate.
    pub tip: Option<StampedPosition>,
    /// Force of the contact on the tip \[N\], zero while it is free; `None`
    /// while it cannot be told.
    pub contact_force: Option<[f64; 3]>,
    /// Operating state of the arm.
    pub state: OperatingState,
}

/// What a step of the arm's end gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowerStep {
    /// A new tip command; `None` when there is nothing new.
    pub command: Option<Motion>,
    /// The operator wished to re-arm since the last step.
    pub rearm: bool,
    /// To send, when a frame is due.
    pub frame: Option<[u8; FRAME_LENGTH]>,
}

/// The arm's end of the link.
#[derive(Clone, Debug)]
pub struct FollowerLink {
    end: End,
    law: FollowerSwitch,
    velocity: VelocityFilter,
    arming: ArmingWatch,
}

impl FollowerLink {
    /// An end that starts with the first of `laws` and follows the leader's end to the others.
    /// Frames wait for up to `buffer` \[s\] to be played out evenly.
    pub fn new(laws: Laws, session: u16, buffer: f64) -> FollowerLink {
        FollowerLink {
            end: End::new(session, buffer),
            law: FollowerSwitch::new(laws),
            velocity: VelocityFilter::default(),
            arming: ArmingWatch::default(),
        }
    }

    /// Bytes arrived at `arrived_ns`, to be acted on in the next step at the earliest.
    pub fn arrived(&mut self, bytes: &[u8], arrived_ns: i64) {
        self.end.arrived(bytes, arrived_ns);
    }

    /// One step at `now_ns`.
    pub fn step(&mut self, now_ns: i64, readings: &FollowerReadings) -> FollowerStep {
        let taken = self.end.take(now_ns);
        let rearm = taken.is_some_and(|frame| self.arming.observe(frame.arming));
        let tip = self.velocity.fresh(readings.tip, ESTIMATE_LIFE);
        let dt = self.end.elapsed(now_ns);
        let connected = self.end.connected(now_ns);
        let newest = self.end.newest(now_ns);
        let step = self
            .law
            .step(dt, tip, readings.contact_force, newest, connected);
        FollowerStep {
            command: step.command,
            rearm,
            frame: self.end.send(now_ns, readings.state, 0, step.outgoing),
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

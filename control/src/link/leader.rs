//! The operator's end of the link.

use super::end::End;
use super::velocity::VelocityFilter;
use super::{LinkState, StampedPosition};
use crate::arming::ArmingCount;
use crate::codec::Deadband;
use crate::frame::FrameBytes;
use crate::operating::OperatingState;
use crate::orientation::Orientation;
use crate::switching::{Laws, LeaderSwitch};
use crate::view::{SentView, ViewError, ViewReceiver};

/// What a step of the operator's end takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeaderReadings {
    /// The hand, newest measurement.
    pub hand: Option<StampedPosition>,
    /// How it is turned, where it says so and the arm can follow.
    pub orientation: Option<Orientation>,
    /// Operating state of the master.
    pub state: OperatingState,
}

/// What a step of the operator's end gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeaderStep {
    /// Force on the hand \[N\].
    pub force: [f64; 3],
    /// To send, when a frame is due.
    pub frame: Option<FrameBytes>,
}

/// The operator's end of the link.
#[derive(Clone, Debug)]
pub struct LeaderLink {
    end: End,
    law: LeaderSwitch,
    velocity: VelocityFilter,
    arming: ArmingCount,
    /// How often the arm has stopped, as its end counts.
    stops: Option<u8>,
    views: ViewReceiver,
}

impl LeaderLink {
    /// An end that starts with the first of `laws` and may switch to the others.
    /// Frames wait for up to `buffer` \[s\] to be played out evenly.
    pub fn new(laws: Laws, buffer: f64) -> LeaderLink {
        LeaderLink {
            end: End::new(&laws, true, buffer),
            law: LeaderSwitch::new(laws),
            velocity: VelocityFilter::default(),
            arming: ArmingCount::default(),
            stops: None,
            views: ViewReceiver::default(),
        }
    }

    /// The same, which leaves out frames that say nothing beyond `deadband`; without one, none.
    pub fn coded(self, deadband: Option<Deadband>) -> LeaderLink {
        LeaderLink {
            end: self.end.coded(deadband),
            ..self
        }
    }

    /// From `now_ns` on another process is at the other end, whose clock is
    /// `clock_ahead_ns` ahead.
    pub fn peer_changed(&mut self, now_ns: i64, clock_ahead_ns: i64) {
        self.end.restart(now_ns, clock_ahead_ns);
        self.stops = None;
        self.views.restart();
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

    /// A view of the arm's end arrived at `arrived_ns`; `None` where a newer one was there before.
    ///
    /// # Errors
    ///
    /// [`ViewError`].
    pub fn view_arrived(
        &mut self,
        bytes: &[u8],
        arrived_ns: i64,
    ) -> Result<Option<SentView>, ViewError> {
        let ahead_ns = self.end.clock_ahead_ns(arrived_ns);
        self.views.arrived(bytes, arrived_ns, ahead_ns)
    }

    /// One step at `now_ns`.
    pub fn step(&mut self, now_ns: i64, readings: &LeaderReadings) -> LeaderStep {
        self.end.take(now_ns);
        let stops = self.end.heard_arming();
        if self.stops.is_some() && stops != self.stops {
            // What was said before is no answer to this stop.
            self.arming = ArmingCount::default();
        }
        self.stops = stops;
        let hand = self.velocity.fresh_by_its_rate(readings.hand);
        let dt = self.end.elapsed(now_ns);
        let connected = self.end.connected(now_ns) && !self.end.is_held();
        let orientation = readings.orientation.filter(|_| hand.is_some());
        let step = self.law.step(dt, hand, self.end.newest(now_ns), connected);
        LeaderStep {
            force: step.force,
            frame: self.end.send(
                now_ns,
                readings.state,
                self.arming.get(),
                step.outgoing,
                orientation,
            ),
        }
    }

    /// `force` \[N\] is on the hand until the next step, after every limit of the master:
    /// law and meter count its energy, in place of that of the force asked for.
    pub fn rendered(&mut self, force: [f64; 3]) {
        self.law.rendered(force);
    }

    /// Age at `now_ns` of what this end acts on \[s\]; `None` before the first frame.
    pub fn age(&self, now_ns: i64) -> Option<f64> {
        self.end.age(now_ns)
    }

    /// What is known at `now_ns`.
    pub fn state(&mut self, now_ns: i64) -> LinkState {
        LinkState {
            connected: self.end.connected(now_ns),
            held: self.end.is_held(),
            peer: self.end.peer_state(),
            measured: self.end.measure(now_ns),
            law: self.law.name(),
            energy: self.law.energy(),
            dissipated: self.law.dissipated(),
            traffic: self.end.traffic(),
        }
    }
}

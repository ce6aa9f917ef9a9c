//! The arm's end of the link.

use super::end::End;
use super::gap::{Flow, GapWatch};
use super::velocity::VelocityFilter;
use super::word::{Word, WordWatch};
use super::{FRESH, LinkState, StampedPosition, WORD_LIFE};
use crate::codec::Deadband;
use crate::delay::Motion;
use crate::frame::FrameBytes;
use crate::nanoseconds;
use crate::operating::OperatingState;
use crate::orientation::Orientation;
use crate::planted::{Planted, Rule};
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
    /// Somebody told the arm to stop since the last step.
    pub told_to_stop: bool,
}

impl FollowerReadings {
    /// The contact's force as laws take it, of what the estimator tells, `force` in N: zero
    /// while the tip touches nothing, as the estimate is noise then; `None` where it is not
    /// valid.
    pub fn force_of(valid: bool, touches: bool, force: [f64; 3]) -> Option<[f64; 3]> {
        valid.then_some(if touches { force } else { [0.0; 3] })
    }
}

/// What a step of the arm's end gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowerStep {
    /// A new tip command; `None` when there is nothing new.
    pub command: Option<Motion>,
    /// How the hand is turned that commands it, where it says so.
    pub orientation: Option<Orientation>,
    /// When it counts as made: never the same twice, [`FRESH`] after the newest frame at
    /// most \[ns since the UNIX epoch\].
    pub command_ns: i64,
    /// What the operator says of arming.
    pub word: Option<Word>,
    /// A gap in the link was short enough to go on after it.
    pub resume_after_gap: bool,
    /// To send, when a frame is due.
    pub frame: Option<FrameBytes>,
}

/// The arm's end of the link.
#[derive(Clone, Debug)]
pub struct FollowerLink {
    end: End,
    law: FollowerSwitch,
    velocity: VelocityFilter,
    words: WordWatch,
    gap: GapWatch,
    planted: Planted,
}

impl FollowerLink {
    /// An end that starts with the first of `laws` and follows the leader's end to the others.
    /// Frames wait for up to `buffer` \[s\] to be played out evenly.
    pub fn new(laws: Laws, buffer: f64) -> FollowerLink {
        FollowerLink {
            end: End::new(&laws, false, buffer),
            law: FollowerSwitch::new(laws),
            velocity: VelocityFilter::default(),
            words: WordWatch::default(),
            gap: GapWatch::default(),
            planted: Planted::NONE,
        }
    }

    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> FollowerLink {
        FollowerLink {
            words: self.words.planted(planted),
            planted,
            ..self
        }
    }

    /// The same, which asks to arm again by itself after gaps of up to `gap` \[s\].
    pub fn bridging(self, gap: f64) -> FollowerLink {
        FollowerLink {
            gap: GapWatch::new(gap),
            ..self
        }
    }

    /// The same, which leaves out frames that say nothing beyond `deadband`; without one, none.
    pub fn coded(self, deadband: Option<Deadband>) -> FollowerLink {
        FollowerLink {
            end: self.end.coded(deadband),
            ..self
        }
    }

    /// From `now_ns` on another process is at the other end, whose clock is
    /// `clock_ahead_ns` ahead.
    pub fn peer_changed(&mut self, now_ns: i64, clock_ahead_ns: i64) {
        self.end.restart(now_ns, clock_ahead_ns);
        self.words.restart();
        self.gap.restart();
    }

    /// Bytes arrived at `arrived_ns`, to be acted on in the next step at the earliest.
    pub fn arrived(&mut self, bytes: &[u8], arrived_ns: i64) {
        self.end.arrived(bytes, arrived_ns);
    }

    /// One step at `now_ns`.
    pub fn step(&mut self, now_ns: i64, readings: &FollowerReadings) -> FollowerStep {
        if self.end.silence(now_ns) > WORD_LIFE {
            self.words.restart();
        }
        let taken = self.end.take(now_ns);
        let word = self.words.step(
            now_ns,
            readings.state,
            readings.told_to_stop,
            taken.as_ref(),
        );
        let tip = self.velocity.fresh(readings.tip, ESTIMATE_LIFE);
        let dt = self.end.elapsed(now_ns);
        let silence = self.end.silence(now_ns);
        let hold = self.end.is_held() && !self.planted.lacks(Rule::HoldObeyed);
        let connected = self.end.connected(now_ns) && !hold;
        let newest = self.end.newest(now_ns);
        let step = self
            .law
            .step(dt, tip, readings.contact_force, newest, connected);
        let flow = Flow {
            silence,
            hold,
            operator: self.end.peer_state(),
            arm: readings.state,
        };
        let age = match self.planted.lacks(Rule::CommandsAge) {
            true => 0.0,
            false => stale(silence),
        };
        FollowerStep {
            command: step.command.filter(|_| !hold),
            orientation: self.end.orientation(),
            command_ns: now_ns.saturating_sub(nanoseconds(age)),
            word,
            resume_after_gap: self.gap.step(now_ns, &flow),
            frame: self.end.send(
                now_ns,
                readings.state,
                self.words.stops(),
                step.outgoing,
                None,
            ),
        }
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

/// How long ago a command counts as made, `silence` \[s\] after a frame was taken \[s\].
fn stale(silence: f64) -> f64 {
    // After a frame f: made at f + FRESH s / (FRESH + s), which grows and stays below f + FRESH.
    let silence = silence.max(0.0);
    match silence.is_finite() {
        true => silence - FRESH * silence / (FRESH + silence),
        false => 0.0,
    }
}

//! What an end says of the link, as a message.

use ferntast_control::{link::LinkState, operating::OperatingState};
use ferntast_msgs::{
    Text, Time,
    sample::{Fault, Level, LinkEnd, LinkPeerSample, LinkStatusSample},
};
use ferntast_seal::Established;

use super::transport::{FrameInput, Peer};
use crate::node::NodeHealth;

/// How often the status is published \[ns\].
const PERIOD_NANOS: i64 = 10_000_000;
/// How often it is told whom an end talks to \[ns\].
const PEER_PERIOD_NANOS: i64 = 100_000_000;

/// For how many steps what happened once is told: for longer than the time between two
/// messages of a node's health.
pub const TOLD_STEPS: u32 = 250;

/// Publishes the status of an end, in its time.
pub struct Status {
    which: LinkEnd,
    session: u16,
    due: Time,
    peer_due: Time,
}

impl Status {
    pub fn new(which: LinkEnd, session: u16) -> Status {
        Status {
            which,
            session,
            due: Time::INVALID,
            peer_due: Time::INVALID,
        }
    }

    /// The status, when one is due.
    pub fn step(
        &mut self,
        now: Time,
        state: &LinkState,
        frames: &FrameInput,
    ) -> Option<LinkStatusSample> {
        if now < self.due {
            return None;
        }
        self.due = now.plus_nanos(PERIOD_NANOS);
        let measured = &state.measured;
        let (refused, sealed) = (measured.refused, frames.peer.refused);
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        Some(LinkStatusSample {
            round_trip: measured.round_trip,
            delay: measured.delay,
            jitter: finite(measured.jitter),
            loss: finite(measured.loss),
            age: finite(measured.age),
            channel_delay: frames.channel.delay,
            channel_jitter: frames.channel.jitter,
            channel_loss: frames.channel.loss,
            energy_in: state.energy.entered,
            energy_out: state.energy.left,
            energy_dissipated: state.dissipated,
            sent: measured.sent,
            received: measured.received,
            lost: measured.lost,
            refused_length: refused.length + sealed.length,
            refused_version: sealed.version,
            refused_session: sealed.unknown_key + sealed.handshake,
            refused_checksum: sealed.forged,
            refused_time: refused.time,
            refused_value: refused.value,
            refused_replayed: refused.replayed + sealed.replayed,
            refused_late: refused.late,
            law: Text::new(state.law),
            session: self.session,
            connected: u8::from(state.connected),
            end: self.which,
            ..LinkStatusSample::initial(now)
        })
    }

    /// Whom the end talks to, when it is time to tell.
    pub fn peer(&mut self, now: Time, state: &LinkState, peer: &Peer) -> Option<LinkPeerSample> {
        if now < self.peer_due {
            return None;
        }
        self.peer_due = now.plus_nanos(PEER_PERIOD_NANOS);
        let clock = &state.measured.clock;
        let established = peer.established;
        Some(LinkPeerSample {
            end: self.which,
            key: established.map_or(Text::EMPTY, |own| Text::display(own.peer)),
            handshakes: established.map_or(0, |own| own.incarnation),
            holds: u8::from(state.held),
            clock_offset: clock.offset,
            clock_drift: clock.drift,
            clock_error: clock.error,
            clock_jumps: clock.jumps,
            ..LinkPeerSample::initial(now)
        })
    }
}

/// Follows who is at the other end, and tells of it on `/diagnostics`.
#[derive(Debug, Default)]
pub struct PeerWatch {
    incarnation: u64,
    refused: u64,
    turned_away: u64,
    /// Steps in which it is still told of whom TLS turned away.
    telling: u32,
    jumps: u64,
}

impl PeerWatch {
    /// Another process is at the other end than when last asked.
    pub fn changed(&mut self, peer: &Peer) -> Option<Established> {
        let established = peer.established?;
        let changed = established.incarnation != self.incarnation;
        self.incarnation = established.incarnation;
        changed.then_some(established)
    }

    /// What an end tells of the link; `other` is the other end, in words.
    pub fn report(&mut self, state: &LinkState, peer: &Peer, other: &str, health: &mut NodeHealth) {
        let silence = state.measured.silence;
        health.input_age = if silence.is_finite() {
            silence
        } else {
            f64::NAN
        };
        let refused = peer.refused.total();
        health.refused = state.measured.refused.total() + refused;
        if !state.connected {
            health.raise(Fault::LinkDown, Level::WARN);
            health.message = match peer.established {
                None => match &peer.at_the_door {
                    None => Text::display(format_args!(
                        "no handshake with {other} yet; is it there, by the same --session name?"
                    )),
                    Some(reason) => Text::display(format_args!("no way to {other}: {reason}")),
                },
                Some(_) => Text::display(format_args!("no frames from {other}")),
            };
        }
        let deaf = state.held && state.peer == OperatingState::Enabled;
        if state.connected && deaf {
            health.raise(Fault::LinkDown, Level::WARN);
            health.message = Text::display(format_args!("{other} hears nothing from here: held"));
        }
        let jumps = state.measured.clock.jumps;
        if jumps > self.jumps {
            health.raise(Fault::LinkDown, Level::WARN);
            health.message =
                Text::display(format_args!("the clock of {other}, or this one, jumped"));
        }
        self.jumps = jumps;
        if refused > self.refused {
            health.raise(Fault::StrangerOnLink, Level::WARN);
            if let Some(refusal) = &peer.last_refusal {
                health.message = Text::display(refusal);
            }
        }
        self.refused = refused;
        if peer.turned_away > self.turned_away {
            self.telling = TOLD_STEPS;
        }
        self.turned_away = peer.turned_away;
        if self.telling > 0 {
            self.telling -= 1;
            health.raise(Fault::StrangerOnLink, Level::WARN);
            if let Some(reason) = &peer.at_the_door {
                health.message = Text::display(format_args!("a stranger was not let in: {reason}"));
            }
        }
    }
}

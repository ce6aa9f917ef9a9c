//! Which frames are sent.

use super::predictor::Predictor;
use super::{Deadband, Traffic};
use crate::delay::{Packet, Sample, Samples};
use crate::frame::{FrameBytes, LARGEST_PACE, LinkFrame, SEAL_LENGTH, SEND_PERIOD_NS};
use crate::nanoseconds;
use crate::operating::OperatingState;
use crate::orientation::{Orientation, PackedOrientation};

/// So many frames in a row tell that the sender asks to hold, that a state changed, or of a word, as
/// one may be lost: 12 ms.
const URGENT: u8 = 6;

/// A hand that turned by less says nothing new [rad].
const TURN: f64 = 5e-4;

/// What a frame says beside its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Header {
    valid: bool,
    hold: bool,
    state: OperatingState,
    arming: u8,
    law: u8,
}

/// What is to be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Due {
    Content,
    KeepAlive,
    Nothing,
}

#[derive(Clone, Copy, Debug)]
struct Sent {
    header: Header,
    /// How many of the next frames are sent whatever they say.
    urgent: u8,
    at_ns: i64,
    content_ns: i64,
    /// The hand's, which the other end takes to stay.
    orientation: Option<PackedOrientation>,
    since_content: u8,
}

/// Leaves out frames that say nothing new; without a deadband, none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Encoder {
    deadband: Option<Deadband>,
    predictor: Predictor,
    sent: Option<Sent>,
    traffic: Traffic,
}

impl Encoder {
    pub fn new(deadband: Option<Deadband>) -> Encoder {
        Encoder {
            deadband,
            ..Encoder::default()
        }
    }

    /// Another process is at the other end, which knows nothing.
    pub fn restart(&mut self) {
        self.sent = None;
    }

    pub fn traffic(&self) -> Traffic {
        self.traffic
    }

    /// How the frame `whole`, which is due, is to be sent, if at all.
    pub fn pass(&mut self, whole: LinkFrame, samples: &Samples) -> Option<LinkFrame> {
        self.traffic.due += 1;
        let Some(deadband) = self.deadband else {
            return Some(whole);
        };
        let now_ns = whole.stamp_ns;
        let header = Header {
            valid: whole.packet.valid,
            hold: whole.hold,
            state: whole.state,
            arming: whole.arming,
            law: whole.law,
        };
        let due = self.due(&deadband, header, &whole, samples);
        let pace = pace(deadband.keep_alive);
        let (frame, content_ns, orientation) = match (due, self.sent) {
            (Due::Nothing, _) => return None,
            (Due::KeepAlive, Some(sent)) => {
                let frame = LinkFrame {
                    pace,
                    since_content: sent.since_content.saturating_add(1),
                    packet: Packet {
                        valid: whole.packet.valid,
                        ..Packet::default()
                    },
                    orientation: None,
                    ..whole
                };
                (frame, sent.content_ns, sent.orientation)
            }
            (Due::Content | Due::KeepAlive, _) => {
                let frame = LinkFrame { pace, ..whole };
                self.predictor.learn(&frame, samples);
                (frame, now_ns, whole.orientation)
            }
        };
        let urgent = match self.sent {
            Some(sent) if sent.header == header => sent.urgent.saturating_sub(1),
            _ => URGENT,
        };
        self.sent = Some(Sent {
            header,
            urgent,
            at_ns: now_ns,
            content_ns,
            orientation,
            since_content: frame.since_content,
        });
        Some(frame)
    }

    fn due(
        &self,
        deadband: &Deadband,
        header: Header,
        whole: &LinkFrame,
        samples: &Samples,
    ) -> Due {
        let now_ns = whole.stamp_ns;
        let Some(sent) = self.sent else {
            return Due::Content;
        };
        // A clock that jumped back is late as well.
        let late = |since_ns: i64, after: f64| {
            let passed_ns = now_ns.saturating_sub(since_ns);
            passed_ns < 0 || passed_ns.saturating_add(SEND_PERIOD_NS / 2) >= nanoseconds(after)
        };
        let Some((law, predicted)) = self.predictor.at(now_ns) else {
            return Due::Content;
        };
        let news = law != header.law
            || sent.since_content == u8::MAX
            || late(sent.content_ns, deadband.refresh)
            || has_turned(sent.orientation, whole.orientation)
            || is_news(deadband, samples, &predicted, &whole.packet);
        if news {
            Due::Content
        } else if sent.header != header || sent.urgent > 0 || late(sent.at_ns, deadband.keep_alive)
        {
            Due::KeepAlive
        } else {
            Due::Nothing
        }
    }

    /// `frame` was sent as `bytes`.
    pub fn sent(&mut self, frame: &LinkFrame, bytes: &FrameBytes) {
        self.traffic.frames += 1;
        self.traffic.contents += u64::from(frame.since_content == 0);
        self.traffic.bytes += (bytes.len() + SEAL_LENGTH) as u64;
    }
}

/// The announcement of `keep_alive` \[s\].
fn pace(keep_alive: f64) -> u8 {
    let periods = (nanoseconds(keep_alive) + SEND_PERIOD_NS - 1) / SEND_PERIOD_NS;
    periods.clamp(1, i64::from(LARGEST_PACE)) as u8
}

/// Whether a hand has turned since it was sent how it is turned.
fn has_turned(sent: Option<PackedOrientation>, now: Option<PackedOrientation>) -> bool {
    match (sent, now) {
        (Some(sent), Some(now)) if sent != now => {
            Orientation::from(now).angle_to(&Orientation::from(sent)) > TURN
        }
        (sent, now) => sent.is_some() != now.is_some(),
    }
}

/// Whether `packet` is further off `predicted` than the other end may believe.
fn is_news(deadband: &Deadband, samples: &Samples, predicted: &Packet, packet: &Packet) -> bool {
    let energy = samples.energy
        && (f64::from(packet.energy[0]) - f64::from(predicted.energy[0])).abs()
            > deadband.energy_floor;
    packet.valid != predicted.valid
        || energy
        || (packet.valid
            && (differs(
                deadband,
                samples.position,
                &predicted.position,
                &packet.position,
            ) || differs(deadband, samples.vector, &predicted.vector, &packet.vector)))
}

fn differs(deadband: &Deadband, sample: Sample, predicted: &[f32; 3], own: &[f32; 3]) -> bool {
    let norm = |values: [f64; 3]| values.iter().map(|own| own * own).sum::<f64>().sqrt();
    let size = norm(predicted.map(f64::from));
    let off = norm(std::array::from_fn(|axis| {
        f64::from(own[axis]) - f64::from(predicted[axis])
    }));
    match sample {
        Sample::Unused => false,
        Sample::Position => off > deadband.position_floor,
        Sample::Velocity => off > (deadband.velocity_share * size).max(deadband.velocity_floor),
        Sample::Force { at_hand } => {
            at_hand * off > (deadband.force_share * at_hand * size).max(deadband.force_floor)
        }
        Sample::Place => {
            let [place, friction] = [0, 1].map(|of| f64::from(own[of]) - f64::from(predicted[of]));
            place.abs() > deadband.place_floor || friction.abs() > deadband.surface_share
        }
        Sample::Stiffness => off > deadband.surface_share * size,
        Sample::Integral => off > 0.0,
    }
}

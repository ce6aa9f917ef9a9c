//! What both ends do with frames.

use super::{CONNECTED, RETURN_SILENCE, SEND_PERIOD_NS};
use crate::codec::{Deadband, Decoder, Encoder, Traffic};
use crate::delay::{Received, Samples};
use crate::frame::{self, FrameBytes, LAST_LAW_CODE, LinkFrame};
use crate::meter::{Arrival, LinkMeasurement, LinkMeter, passed};
use crate::operating::OperatingState;
use crate::orientation::{Orientation, PackedOrientation};
use crate::playout::{LONGEST_BUFFER, Offered, PlayOut};
use crate::switching::{Laws, MarkedPacket, Outgoing};
use crate::{LONGEST_STEP, seconds};

/// Codes of laws.
const LAWS: usize = LAST_LAW_CODE as usize + 1;
/// What a handshake tells of a clock may be wrong by the longest way \[ns\].
const HANDSHAKE_ERROR_NS: i64 = 2_000_000_000;

/// Frames in, frames out, and what they measure.
#[derive(Clone, Debug)]
pub(super) struct End {
    meter: LinkMeter,
    sequence: u32,
    /// When the next frame is due [ns].
    send_due_ns: i64,
    play_out: PlayOut,
    /// So long frames may wait; where they do, those that were overtaken may still fall into
    /// place \[s\].
    buffer: f64,
    /// Frames that came after their time, which the meter took for good.
    late: u64,
    /// What the frame that arrived last says of arming, of whatever age: as with what is
    /// echoed, the other end takes it for known.
    heard_arming: Option<u8>,
    /// The frame that is acted on.
    newest: Option<LinkFrame>,
    /// When it arrived, or, where frames wait to be played out, was taken from there \[ns\].
    taken_ns: i64,
    fresh: bool,
    /// How the hand at the other end is turned, as the newest content says.
    orientation: Option<Orientation>,
    /// Time of the last step [ns].
    last_ns: Option<i64>,
    encoder: Encoder,
    decoder: Decoder,
    /// What packets of each law say, by its code: those of this end, those of the other.
    samples: [[Samples; 2]; LAWS],
}

impl End {
    /// An end whose frames wait for up to `buffer` \[s\] to be played out evenly; with `laws`,
    /// of whose packets those of the leader's end are sent here where `leads`.
    pub fn new(laws: &Laws, leads: bool, buffer: f64) -> End {
        let samples = |law: usize| {
            let [forth, back] = laws.samples(law as u8);
            match leads {
                true => [forth, back],
                false => [back, forth],
            }
        };
        End {
            encoder: Encoder::default(),
            decoder: Decoder::default(),
            samples: std::array::from_fn(samples),
            meter: LinkMeter::new(),
            sequence: 0,
            send_due_ns: 0,
            play_out: PlayOut::new(buffer),
            buffer: buffer.clamp(0.0, LONGEST_BUFFER),
            late: 0,
            heard_arming: None,
            newest: None,
            taken_ns: 0,
            fresh: false,
            orientation: None,
            last_ns: None,
        }
    }

    /// The same, which leaves out what is within `deadband`.
    pub fn coded(self, deadband: Option<Deadband>) -> End {
        End {
            encoder: Encoder::new(deadband),
            ..self
        }
    }

    /// What this end sent.
    pub fn traffic(&self) -> Traffic {
        self.encoder.traffic()
    }

    /// From `now_ns` on another process is at the other end, whose clock is
    /// `clock_ahead_ns` ahead as far as a handshake can tell: what came from the one
    /// before is over.
    pub fn restart(&mut self, now_ns: i64, clock_ahead_ns: i64) {
        self.meter
            .restart(now_ns, clock_ahead_ns, HANDSHAKE_ERROR_NS);
        self.play_out.restart();
        self.encoder.restart();
        self.decoder.restart();
        self.heard_arming = None;
        self.newest = None;
        self.fresh = false;
        self.orientation = None;
    }

    /// Bytes arrived at `arrived_ns`.
    pub fn arrived(&mut self, bytes: &[u8], arrived_ns: i64) {
        let ahead_ns = self.meter.clock_ahead_ns(arrived_ns);
        let decoded = frame::decode(bytes, arrived_ns, ahead_ns).and_then(|mut frame| {
            self.meter.synchronise(&mut frame, arrived_ns);
            self.heard_arming = Some(frame.arming);
            frame.check_age(arrived_ns)?;
            Ok(frame)
        });
        match decoded {
            Ok(frame) => self.decoded(&frame, arrived_ns),
            Err(error) => self.meter.refused(&error),
        }
    }

    fn decoded(&mut self, frame: &LinkFrame, arrived_ns: i64) {
        match self.meter.received(frame, arrived_ns) {
            Arrival::Newest => {
                if self.play_out.offer(frame, arrived_ns) != Offered::Waiting {
                    self.late += 1;
                }
            }
            Arrival::Late if self.is_buffered() => {
                self.play_out.offer(frame, arrived_ns);
            }
            Arrival::Late if frame.pace > 0 => {
                let theirs = |law| said(&self.samples, law)[1];
                self.decoder.overtaken(frame, theirs);
            }
            Arrival::Late | Arrival::Replayed => {}
        }
    }

    /// The frame to act on from `now_ns` on, if there is a new one.
    pub fn take(&mut self, now_ns: i64) -> Option<LinkFrame> {
        let taken = self.play_out.take(now_ns);
        self.fresh = taken.is_some();
        if let Some(frame) = &taken {
            self.newest = taken;
            // One that waited for this end, which was held up, is as old as it is.
            self.taken_ns = match self.is_buffered() {
                true => now_ns,
                false => self
                    .meter
                    .arrived_ns()
                    .map_or(now_ns, |own| own.min(now_ns)),
            };
            let theirs = |law| said(&self.samples, law)[1];
            let content = self.play_out.content();
            if let Some(content) = content {
                self.orientation = content.orientation.map(Orientation::from);
            }
            self.decoder.heard(frame, content, self.taken_ns, theirs);
        }
        self.decoder.step(now_ns);
        taken
    }

    /// How far the other end's clock is ahead at `now_ns`, as far as it is known \[ns\].
    pub fn clock_ahead_ns(&self, now_ns: i64) -> i64 {
        self.meter.clock_ahead_ns(now_ns)
    }

    /// What the other end said last of arming.
    pub fn heard_arming(&self) -> Option<u8> {
        self.heard_arming
    }

    fn is_buffered(&self) -> bool {
        self.buffer > 0.0
    }

    /// Forth and back \[s\]: as the echoes tell, and what waits at both ends, which have buffers
    /// of the same length.
    fn round_trip(&self) -> f64 {
        let way = self.meter.round_trip().unwrap_or(0.0);
        way + 2.0 * self.buffer
    }

    /// Time since something was heard that counts \[s\]: with a buffer since a frame was played
    /// out, as those that wait bridge a gap in what arrives, else since one arrived.
    fn heard(&self, now_ns: i64) -> f64 {
        match self.is_buffered() {
            true => self.silence(now_ns),
            false => self.meter.silence(now_ns),
        }
    }

    /// Age at `now_ns` of what is acted on \[s\]; `None` before the first frame.
    pub fn age(&self, now_ns: i64) -> Option<f64> {
        self.newest(now_ns).map(|own| own.received.age)
    }

    /// Time since the frame that is acted on \[s\]; infinite before the first.
    pub fn silence(&self, now_ns: i64) -> f64 {
        self.newest
            .map_or(f64::INFINITY, |_| passed(self.taken_ns, now_ns))
    }

    /// How the hand at the other end is turned, where it says so.
    pub fn orientation(&self) -> Option<Orientation> {
        self.orientation
    }

    /// Whether the other end asks to hold, in what it said last.
    pub fn is_held(&self) -> bool {
        self.newest.is_none_or(|frame| frame.hold)
    }

    /// State of the other end's device, in what it said last.
    pub fn peer_state(&self) -> OperatingState {
        self.newest
            .map_or(OperatingState::Disabled, |frame| frame.state)
    }

    /// The packet to act on as the laws want it, and which law made it.
    pub fn newest(&self, now_ns: i64) -> Option<MarkedPacket> {
        if self.decoder.is_on() {
            return self.decoder.decoded().map(|own| MarkedPacket {
                law: own.law,
                received: Received {
                    packet: own.packet,
                    fresh: own.fresh,
                    silence: self.decoder.silence(now_ns, self.heard(now_ns)),
                    age: seconds(now_ns.saturating_sub(own.sent_ns)),
                    round_trip: self.round_trip(),
                },
            });
        }
        self.newest.map(|frame| MarkedPacket {
            law: frame.law,
            received: Received {
                packet: frame.packet,
                fresh: self.fresh,
                silence: self.heard(now_ns),
                age: seconds(now_ns.saturating_sub(frame.sent_ns)),
                round_trip: self.round_trip(),
            },
        })
    }

    pub fn connected(&self, now_ns: i64) -> bool {
        self.heard(now_ns) <= CONNECTED
    }

    /// Time since the last step \[s\].
    pub fn elapsed(&mut self, now_ns: i64) -> f64 {
        let elapsed = self.last_ns.map_or(0.0, |last_ns| {
            seconds_between(last_ns, now_ns).clamp(0.0, LONGEST_STEP)
        });
        self.last_ns = Some(now_ns);
        elapsed
    }

    /// The frame with `outgoing`, and the hand's `orientation`, when it is time to send one and it says something.
    pub fn send(
        &mut self,
        now_ns: i64,
        state: OperatingState,
        arming: u8,
        outgoing: Outgoing,
        orientation: Option<Orientation>,
    ) -> Option<FrameBytes> {
        // Further ahead than a period: a clock jumped back.
        let due_ns = self.send_due_ns;
        if now_ns < due_ns && due_ns.saturating_sub(now_ns) <= SEND_PERIOD_NS {
            return None;
        }
        let next_ns = self.send_due_ns.saturating_add(SEND_PERIOD_NS);
        let kept = next_ns > now_ns && next_ns.saturating_sub(now_ns) <= SEND_PERIOD_NS;
        self.send_due_ns = if kept {
            next_ns
        } else {
            now_ns.saturating_add(SEND_PERIOD_NS)
        };
        let deaf = self.heard(now_ns) > RETURN_SILENCE;
        let frame = LinkFrame {
            sequence: self.sequence,
            stamp_ns: now_ns,
            sent_ns: now_ns,
            echo: self.meter.echo(now_ns),
            hold: state != OperatingState::Enabled || deaf,
            state,
            arming,
            law: outgoing.law,
            pace: 0,
            since_content: 0,
            packet: outgoing.packet,
            orientation: orientation.map(PackedOrientation::from),
        };
        let ours = said(&self.samples, frame.law)[0];
        let frame = self.encoder.pass(frame, &ours)?;
        let bytes = frame::encode(&frame);
        self.encoder.sent(&frame, &bytes);
        self.sequence = self.sequence.wrapping_add(1);
        self.meter.sent();
        Some(bytes)
    }

    /// What is known of the link at `now_ns`.
    pub fn measure(&mut self, now_ns: i64) -> LinkMeasurement {
        let mut measured = self.meter.measure(now_ns);
        measured.received = measured.received.saturating_sub(self.late);
        measured.refused.late += self.late;
        measured
    }
}

/// What packets of the law of that code say.
fn said(samples: &[[Samples; 2]; LAWS], law: u8) -> [Samples; 2] {
    samples.get(usize::from(law)).copied().unwrap_or_default()
}

/// \[s\] As stamps of messages are subtracted: a product, which differs from
/// [`seconds`] in the last digit.
pub(super) fn seconds_between(earlier_ns: i64, later_ns: i64) -> f64 {
    later_ns.saturating_sub(earlier_ns) as f64 * 1e-9
}

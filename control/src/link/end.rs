//! What both ends do with frames.

use super::{CONNECTED, SEND_PERIOD_NS};
use crate::delay::Received;
use crate::frame::{self, FRAME_LENGTH, LinkFrame};
use crate::meter::{Arrival, LinkMeasurement, LinkMeter, behind};
use crate::operating::OperatingState;
use crate::playout::{Offered, PlayOut};
use crate::seconds;
use crate::switching::{MarkedPacket, Outgoing};

/// A step that comes later than this after the one before counts as this long \[s\].
const LONGEST_STEP: f64 = 0.02;

/// Frames in, frames out, and what they measure.
#[derive(Clone, Debug)]
pub(super) struct End {
    session: u16,
    meter: LinkMeter,
    sequence: u32,
    /// When the next frame is due [ns].
    send_due_ns: i64,
    play_out: PlayOut,
    /// Whether frames that were overtaken may still fall into place.
    buffered: bool,
    /// Sequence number of the newest frame that arrived.
    highest: u32,
    /// Frames that came after their time, which the meter took for good.
    late: u64,
    /// The frame that is acted on.
    newest: Option<LinkFrame>,
    fresh: bool,
    /// Time of the last step [ns].
    last_ns: Option<i64>,
}

impl End {
    /// An end whose frames wait for up to `buffer` \[s\] to be played out evenly.
    pub fn new(session: u16, buffer: f64) -> End {
        End {
            session,
            meter: LinkMeter::new(),
            sequence: 0,
            send_due_ns: 0,
            play_out: PlayOut::new(buffer),
            buffered: buffer > 0.0,
            highest: 0,
            late: 0,
            newest: None,
            fresh: false,
            last_ns: None,
        }
    }

    /// Bytes arrived at `arrived_ns`.
    pub fn arrived(&mut self, bytes: &[u8], arrived_ns: i64) {
        match frame::decode(bytes, self.session, arrived_ns) {
            Ok(frame) => self.decoded(&frame, arrived_ns),
            Err(error) => self.meter.refused(&error),
        }
    }

    fn decoded(&mut self, frame: &LinkFrame, arrived_ns: i64) {
        match self.meter.received(frame, arrived_ns) {
            Arrival::Newest => {
                self.highest = frame.sequence;
                if self.play_out.offer(frame, arrived_ns) != Offered::Waiting {
                    self.late += 1;
                }
            }
            // With a higher number it would be left from before a restart.
            Arrival::Late if self.buffered && behind(frame.sequence, self.highest) => {
                self.play_out.offer(frame, arrived_ns);
            }
            Arrival::Late | Arrival::Replayed => {}
        }
    }

    /// The frame to act on from `now_ns` on, if there is a new one.
    pub fn take(&mut self, now_ns: i64) -> Option<LinkFrame> {
        let taken = self.play_out.take(now_ns);
        self.fresh = taken.is_some();
        self.newest = taken.or(self.newest);
        taken
    }

    /// The packet to act on as the laws want it, and which law made it.
    pub fn newest(&self, now_ns: i64) -> Option<MarkedPacket> {
        self.newest.map(|frame| MarkedPacket {
            law: frame.law,
            received: Received {
                packet: frame.packet,
                fresh: self.fresh,
                silence: self.meter.silence(now_ns),
                age: seconds(now_ns.saturating_sub(frame.sent_ns)),
            },
        })
    }

    pub fn connected(&self, now_ns: i64) -> bool {
        self.meter.silence(now_ns) <= CONNECTED
    }

    /// Time since the last step \[s\].
    pub fn elapsed(&mut self, now_ns: i64) -> f64 {
        let elapsed = self.last_ns.map_or(0.0, |last_ns| {
            seconds_between(last_ns, now_ns).clamp(0.0, LONGEST_STEP)
        });
        self.last_ns = Some(now_ns);
        elapsed
    }

    /// The frame with `outgoing`, when it is time to send one.
    pub fn send(
        &mut self,
        now_ns: i64,
        state: OperatingState,
        arming: u8,
        outgoing: Outgoing,
    ) -> Option<[u8; FRAME_LENGTH]> {
        if now_ns < self.send_due_ns {
            return None;
        }
        let next_ns = self.send_due_ns.saturating_add(SEND_PERIOD_NS);
        self.send_due_ns = if next_ns > now_ns {
            next_ns
        } else {
            now_ns.saturating_add(SEND_PERIOD_NS)
        };
        let frame = LinkFrame {
            session: self.session,
            sequence: self.sequence,
            sent_ns: now_ns,
            echo: self.meter.echo(now_ns),
            hold: state != OperatingState::Enabled,
            state,
            arming,
            law: outgoing.law,
            packet: outgoing.packet,
        };
        let mut bytes = [0; FRAME_LENGTH];
        frame::encode(&frame, &mut bytes);
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

/// \[s\] As stamps of messages are subtracted: a product, which differs from
/// [`seconds`] in the last digit.
pub(super) fn seconds_between(earlier_ns: i64, later_ns: i64) -> f64 {
    later_ns.saturating_sub(earlier_ns) as f64 * 1e-9
}

//! What both ends do with frames.

use ferntast_control::{
    delay::{Energy, Received},
    frame::{self, FRAME_LENGTH, Frame},
    meter::{Arrival, Meter},
    operating::OperatingState,
    playout::{Offered, PlayOut},
    switching::{MarkedPacket, Outgoing},
};
use ferntast_msgs::{
    Text, Time,
    sample::{LinkEnd, LinkStatusSample},
};

use super::{FrameInput, FrameOutput};

/// Frames are sent in every second step: 500 Hz.
const SEND_PERIOD_NANOS: i64 = 2_000_000;
/// How often the status is published \[ns\].
const STATUS_PERIOD_NANOS: i64 = 10_000_000;
/// The other end counts as connected while its newest frame is younger than this \[s\].
const CONNECTED: f64 = 0.100;

/// Frames in, frames out, and what they measure.
pub struct End {
    which: LinkEnd,
    session: u16,
    meter: Meter,
    sequence: u32,
    send_due: Time,
    status_due: Time,
    play_out: PlayOut,
    /// Whether frames that were overtaken may still fall into place.
    buffered: bool,
    /// Sequence number of the newest frame that arrived.
    highest: u32,
    /// Frames that came after their time, which the meter took for good.
    late: u64,
    /// The frame that is acted on.
    newest: Option<Frame>,
    fresh: bool,
    last: Option<Time>,
}

impl End {
    /// An end whose frames wait for up to `buffer` \[s\] to be played out evenly.
    pub fn new(which: LinkEnd, session: u16, buffer: f64) -> End {
        End {
            which,
            session,
            meter: Meter::new(),
            sequence: 0,
            send_due: Time::INVALID,
            status_due: Time::INVALID,
            play_out: PlayOut::new(buffer),
            buffered: buffer > 0.0,
            highest: 0,
            late: 0,
            newest: None,
            fresh: false,
            last: None,
        }
    }

    /// Takes what arrived; gives the frame to act on from `now` on if there is a new one.
    pub fn receive(&mut self, now: Time, frames: &FrameInput) -> Option<Frame> {
        for (bytes, arrived) in frames.iter() {
            match frame::decode(bytes, self.session, arrived.nanos()) {
                Ok(frame) => self.decoded(&frame, arrived.nanos()),
                Err(error) => self.meter.refused(&error),
            }
        }
        let taken = self.play_out.take(now.nanos());
        self.fresh = taken.is_some();
        self.newest = taken.or(self.newest);
        taken
    }

    fn decoded(&mut self, frame: &Frame, arrived_nanos: i64) {
        match self.meter.received(frame, arrived_nanos) {
            Arrival::Newest => {
                self.highest = frame.sequence;
                if self.play_out.offer(frame, arrived_nanos) != Offered::Waiting {
                    self.late += 1;
                }
            }
            // With a higher number it would be left from before a restart.
            Arrival::Late if self.buffered && self.is_overtaken(frame) => {
                self.play_out.offer(frame, arrived_nanos);
            }
            Arrival::Late | Arrival::Replayed => {}
        }
    }

    /// Whether the frame's number comes before the newest's, with wrapping.
    fn is_overtaken(&self, frame: &Frame) -> bool {
        (frame.sequence.wrapping_sub(self.highest) as i32) < 0
    }

    /// The newest packet as the laws want it, and which law made it.
    pub fn newest(&mut self, now: Time) -> Option<MarkedPacket> {
        let measured = self.meter.measure(now.nanos());
        self.newest.map(|frame| MarkedPacket {
            law: frame.law,
            received: Received {
                packet: frame.packet,
                fresh: self.fresh,
                silence: measured.silence,
                age: measured.age,
            },
        })
    }

    pub fn connected(&self, now: Time) -> bool {
        self.meter.silence(now.nanos()) <= CONNECTED
    }

    /// Seconds since the last step \[s\].
    pub fn elapsed(&mut self, now: Time) -> f64 {
        let elapsed = self
            .last
            .map_or(0.0, |last| now.seconds_since(last).clamp(0.0, 0.02));
        self.last = Some(now);
        elapsed
    }

    /// Sends `outgoing` when it is time to.
    pub fn send(
        &mut self,
        now: Time,
        state: OperatingState,
        arming: u8,
        outgoing: Outgoing,
        output: &mut FrameOutput,
    ) {
        if now < self.send_due {
            return;
        }
        let next = self.send_due.plus_nanos(SEND_PERIOD_NANOS);
        self.send_due = if next > now {
            next
        } else {
            now.plus_nanos(SEND_PERIOD_NANOS)
        };
        let frame = Frame {
            session: self.session,
            sequence: self.sequence,
            sent_ns: now.nanos(),
            echo: self.meter.echo(now.nanos()),
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
        output.frame = Some(bytes);
    }

    /// The status, when one is due.
    pub fn status(
        &mut self,
        now: Time,
        law: &str,
        energy: Energy,
        dissipated: f64,
    ) -> Option<LinkStatusSample> {
        if now < self.status_due {
            return None;
        }
        self.status_due = now.plus_nanos(STATUS_PERIOD_NANOS);
        let connected = self.connected(now);
        let measured = self.meter.measure(now.nanos());
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let refused = measured.refused;
        Some(LinkStatusSample {
            round_trip: measured.round_trip,
            delay: measured.delay,
            jitter: finite(measured.jitter),
            loss: finite(measured.loss),
            age: finite(measured.age),
            energy_in: energy.entered,
            energy_out: energy.left,
            energy_dissipated: dissipated,
            sent: measured.sent,
            received: measured.received.saturating_sub(self.late),
            lost: measured.lost,
            refused_length: refused.length,
            refused_version: refused.version,
            refused_session: refused.session,
            refused_checksum: refused.checksum,
            refused_time: refused.time,
            refused_value: refused.value,
            refused_replayed: refused.replayed,
            refused_late: refused.late + self.late,
            law: Text::new(law),
            session: self.session,
            connected: u8::from(connected),
            end: self.which,
            ..LinkStatusSample::initial(now)
        })
    }

    /// Frames refused so far.
    pub fn refused(&mut self, now: Time) -> u64 {
        self.meter.measure(now.nanos()).refused.total() + self.late
    }

    /// Time since the newest frame \[s\]; NaN before the first.
    pub fn silence(&self, now: Time) -> f64 {
        let silence = self.meter.silence(now.nanos());
        if silence.is_finite() {
            silence
        } else {
            f64::NAN
        }
    }
}

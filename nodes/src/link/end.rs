//! What both ends do with frames.

use ferntast_control::{
    delay::{Energy, Received},
    frame::{self, FRAME_LENGTH, Frame},
    meter::{Arrival, Meter},
    operating::OperatingState,
    switching::{MarkedPacket, Outgoing},
};
use ferntast_msgs::{
    Text, Time,
    sample::{LinkEnd, LinkStatusSample, RefusedFrames},
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
    newest: Option<Frame>,
    fresh: bool,
    last: Option<Time>,
}

impl End {
    pub fn new(which: LinkEnd, session: u16) -> End {
        End {
            which,
            session,
            meter: Meter::new(),
            sequence: 0,
            send_due: Time::INVALID,
            status_due: Time::INVALID,
            newest: None,
            fresh: false,
            last: None,
        }
    }

    /// Takes what arrived; gives the newest frame if there is a new one.
    pub fn receive(&mut self, frames: &FrameInput) -> Option<Frame> {
        self.fresh = false;
        for (bytes, arrived) in frames.iter() {
            match frame::decode(bytes, self.session, arrived.nanos()) {
                Ok(frame) => {
                    if self.meter.received(&frame, arrived.nanos()) == Arrival::Newest {
                        self.newest = Some(frame);
                        self.fresh = true;
                    }
                }
                Err(error) => self.meter.refused(&error),
            }
        }
        self.newest.filter(|_| self.fresh)
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
            received: measured.received,
            lost: measured.lost,
            refused: RefusedFrames {
                length: refused.length,
                version: refused.version,
                session: refused.session,
                checksum: refused.checksum,
                time: refused.time,
                value: refused.value,
                replayed: refused.replayed,
                late: refused.late,
            },
            law: Text::new(law),
            session: self.session,
            connected: u8::from(connected),
            ..LinkStatusSample::idle(now, self.which)
        })
    }

    /// Frames refused so far.
    pub fn refused(&mut self, now: Time) -> u64 {
        self.meter.measure(now.nanos()).refused.total()
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

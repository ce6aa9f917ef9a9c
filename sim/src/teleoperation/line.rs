//! One direction of the link: the frames of a session through the emulated
//! channel, and what the receiving end acts on.

use ferntast_control::delay::{Packet, Received};
use ferntast_control::frame::{FRAME_LENGTH, Frame, decode, encode};
use ferntast_control::meter::{Arrival, Meter};
use ferntast_control::operating::OperatingState;
use ferntast_control::playout::PlayOut;
use ferntast_emulation::channel::{Channel, ChannelConfig};
use ferntast_model::ParameterError;

const SESSION: u16 = 1;

/// Sender, channel and receiver.
pub(super) struct Line {
    channel: Channel,
    meter: Meter,
    playout: PlayOut,
    sequence: u32,
    newest: Option<Frame>,
}

impl Line {
    pub(super) fn new(
        config: ChannelConfig,
        buffer: f64,
        seed: u64,
    ) -> Result<Self, ParameterError> {
        Ok(Line {
            channel: Channel::new(config, seed)?,
            meter: Meter::new(),
            playout: PlayOut::new(buffer),
            sequence: 0,
            newest: None,
        })
    }

    pub(super) fn send(&mut self, now_ns: i64, packet: Packet) {
        let frame = Frame {
            session: SESSION,
            sequence: self.sequence,
            sent_ns: now_ns,
            echo: None,
            hold: false,
            state: OperatingState::Enabled,
            arming: 0,
            law: 0,
            packet,
        };
        let mut bytes = [0; FRAME_LENGTH];
        encode(&frame, &mut bytes);
        self.sequence = self.sequence.wrapping_add(1);
        self.channel.push(now_ns, &bytes);
    }

    /// The packet to act on, as the nodes of a session hand it to the laws.
    pub(super) fn receive(&mut self, now_ns: i64) -> Option<Received> {
        let mut bytes = [0; FRAME_LENGTH];
        while let Some((_, arrived_ns)) = self.channel.pop(now_ns, &mut bytes) {
            match decode(&bytes, SESSION, arrived_ns) {
                Ok(frame) => {
                    if self.meter.received(&frame, arrived_ns) != Arrival::Replayed {
                        self.playout.offer(&frame, arrived_ns);
                    }
                }
                Err(error) => self.meter.refused(&error),
            }
        }
        let taken = self.playout.take(now_ns);
        let fresh = taken.is_some();
        self.newest = taken.or(self.newest);
        let silence = self.meter.silence(now_ns);
        self.newest.map(|frame| Received {
            packet: frame.packet,
            fresh,
            silence,
            age: (now_ns - frame.sent_ns) as f64 * 1e-9,
        })
    }
}

//! One direction of the link: the frames of a session through the emulated
//! channel, and what the receiving end acts on.

use crate::channel::{Channel, ChannelConfig};
use ferntast_control::delay::{Packet, Received};
use ferntast_control::frame::{FRAME_LENGTH, Frame, decode, encode};
use ferntast_control::meter::{Arrival, Meter};
use ferntast_control::operating::OperatingState;
use ferntast_model::ParameterError;

const SESSION: u16 = 1;

/// Sender, channel and receiver.
pub(super) struct Line {
    channel: Channel,
    meter: Meter,
    sequence: u32,
    newest: Option<Packet>,
}

impl Line {
    pub(super) fn new(config: ChannelConfig, seed: u64) -> Result<Self, ParameterError> {
        Ok(Line {
            channel: Channel::new(config, seed)?,
            meter: Meter::new(),
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

    /// The newest packet, as the nodes of a session hand it to the laws.
    pub(super) fn receive(&mut self, now_ns: i64) -> Option<Received> {
        let mut fresh = false;
        let mut bytes = [0; FRAME_LENGTH];
        while let Some((_, arrived_ns)) = self.channel.pop(now_ns, &mut bytes) {
            match decode(&bytes, SESSION, arrived_ns) {
                Ok(frame) => {
                    if self.meter.received(&frame, arrived_ns) == Arrival::Newest {
                        self.newest = Some(frame.packet);
                        fresh = true;
                    }
                }
                Err(error) => self.meter.refused(&error),
            }
        }
        let measured = self.meter.measure(now_ns);
        self.newest.map(|packet| Received {
            packet,
            fresh,
            silence: measured.silence,
            age: measured.age,
        })
    }
}

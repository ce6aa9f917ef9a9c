//! What follows from what was sent, the same at both ends.

use crate::delay::{POSITION_LIMIT, Packet, Sample, Samples};
use crate::frame::LinkFrame;
use crate::seconds;

/// Nothing goes on evenly for longer [s].
const HORIZON: f64 = 0.2;
/// Faster than any hand, or arm [m/s].
const FASTEST: f64 = 2.0;

/// Leads on what a frame with content said.
#[derive(Clone, Copy, Debug, Default)]
pub struct Predictor {
    content: Option<Content>,
    /// With which a position goes on [m/s].
    slope: [f64; 3],
}

#[derive(Clone, Copy, Debug)]
struct Content {
    sequence: u32,
    stamp_ns: i64,
    law: u8,
    packet: Packet,
}

impl Predictor {
    /// A frame with content was sent, whose packet is what `samples` say.
    pub fn learn(&mut self, frame: &LinkFrame, samples: &Samples) {
        let new = Content {
            sequence: frame.sequence,
            stamp_ns: frame.stamp_ns,
            law: frame.law,
            packet: frame.packet,
        };
        self.slope = self.slope_to(&new, samples);
        self.content = Some(new);
    }

    fn slope_to(&self, new: &Content, samples: &Samples) -> [f64; 3] {
        let slope = match (samples.position, samples.vector) {
            (Sample::Position, Sample::Velocity) => new.packet.vector.map(f64::from),
            (Sample::Position, _) => self.between(new),
            _ => [0.0; 3],
        };
        let speed = slope.iter().map(|own| own * own).sum::<f64>().sqrt();
        match speed <= FASTEST {
            true => slope,
            false => [0.0; 3],
        }
    }

    /// From the content before to this one.
    fn between(&self, new: &Content) -> [f64; 3] {
        let alike = |own: &Content| own.packet.valid && own.law == new.law;
        let Some(before) = self.content.filter(alike) else {
            return [0.0; 3];
        };
        let passed = seconds(new.stamp_ns.saturating_sub(before.stamp_ns));
        if passed <= 0.0 {
            return self.slope;
        }
        let (now, then) = (new.packet.position, before.packet.position);
        std::array::from_fn(|axis| (f64::from(now[axis]) - f64::from(then[axis])) / passed)
    }

    /// Number of the frame that was led on.
    pub fn sequence(&self) -> Option<u32> {
        self.content.map(|own| own.sequence)
    }

    /// The packet at `stamp_ns` of the sender's clock, and the law that made it; `None` before
    /// the first.
    pub fn at(&self, stamp_ns: i64) -> Option<(u8, Packet)> {
        let content = self.content?;
        let passed = seconds(stamp_ns.saturating_sub(content.stamp_ns)).clamp(0.0, HORIZON);
        let mut packet = content.packet;
        for (place, slope) in packet.position.iter_mut().zip(self.slope) {
            let led = f64::from(*place) + slope * passed;
            *place = (led as f32).clamp(-POSITION_LIMIT, POSITION_LIMIT);
        }
        Some((content.law, packet))
    }

    /// Stays where it is at `stamp_ns`.
    pub fn stay(&mut self, stamp_ns: i64) {
        if let Some((_, packet)) = self.at(stamp_ns)
            && let Some(content) = &mut self.content
        {
            content.packet = packet;
            content.stamp_ns = stamp_ns;
            self.slope = [0.0; 3];
        }
    }
}

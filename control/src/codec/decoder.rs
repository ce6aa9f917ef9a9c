//! What was left out, as far as it follows from what came.

use super::LONGEST_BRIDGE;
use super::predictor::Predictor;
use crate::delay::{Packet, Sample, Samples};
use crate::frame::{LinkFrame, SEND_PERIOD_NS};
use crate::meter::behind;
use crate::{nanoseconds, seconds};

/// The newest frame, of whichever kind.
#[derive(Clone, Copy, Debug)]
struct Heard {
    stamp_ns: i64,
    sent_ns: i64,
    /// When it was taken here \[ns\].
    taken_ns: i64,
    pace: u8,
    /// The sender's packet means something, as the newest frame says.
    valid: bool,
}

/// What counts for a packet from the other end at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Decoded {
    pub law: u8,
    pub packet: Packet,
    /// Not given before.
    pub fresh: bool,
    /// When it counts as sent, by this end's clock \[ns\].
    pub sent_ns: i64,
}

/// A frame that comes this much before what was led on is of a clock that jumped [ns].
const JUMPED_NS: i64 = 100_000_000;

/// Leads on what came, as long as the other end says that it left something out.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Decoder {
    predictor: Predictor,
    heard: Option<Heard>,
    /// When the content was sent \[ns\].
    content_sent_ns: i64,
    /// What came goes on in between, as an integral does not.
    steady: bool,
    /// There is content that was not given yet.
    news: bool,
    /// When something fresh was given last, and by the sender's clock up to when \[ns\].
    given: Option<(i64, i64)>,
    decoded: Option<Decoded>,
}

impl Decoder {
    /// Another process is at the other end.
    pub fn restart(&mut self) {
        *self = Decoder::default();
    }

    /// `frame` counts from `taken_ns` on; `content` is the newest one with content, as far as
    /// it came since the last. `samples` say what packets of a law are.
    pub fn heard(
        &mut self,
        frame: &LinkFrame,
        content: Option<&LinkFrame>,
        taken_ns: i64,
        samples: impl Fn(u8) -> Samples,
    ) {
        self.heard = Some(Heard {
            stamp_ns: frame.stamp_ns,
            sent_ns: frame.sent_ns,
            taken_ns,
            pace: frame.pace,
            valid: frame.packet.valid,
        });
        if let Some(content) = content {
            self.learn(content, &samples(content.law));
        }
        let newest = frame.sequence.wrapping_sub(u32::from(frame.since_content));
        if self.predictor.sequence().is_some_and(|own| own != newest) {
            // It was lost on the way: who knows where that would lead.
            self.predictor.stay(frame.stamp_ns);
        }
    }

    fn learn(&mut self, content: &LinkFrame, samples: &Samples) {
        self.predictor.learn(content, samples);
        self.content_sent_ns = content.sent_ns;
        self.steady = samples.vector != Sample::Integral;
        self.news = true;
    }

    /// A frame that was overtaken, whose content counts where there is none newer.
    pub fn overtaken(&mut self, frame: &LinkFrame, samples: impl Fn(u8) -> Samples) {
        let newer = |own: u32| behind(own, frame.sequence);
        if frame.since_content == 0 && self.predictor.sequence().is_none_or(newer) {
            self.learn(frame, &samples(frame.law));
        }
    }

    /// Goes on to `now_ns`.
    pub fn step(&mut self, now_ns: i64) {
        let Some(heard) = self.heard else {
            return;
        };
        if let Some(decoded) = &mut self.decoded {
            decoded.fresh = false;
            decoded.packet.valid &= heard.valid;
        }
        let due = self.given.is_none_or(|(given_ns, _)| {
            let passed_ns = now_ns.saturating_sub(given_ns);
            passed_ns < 0 || passed_ns.saturating_add(SEND_PERIOD_NS / 4) >= SEND_PERIOD_NS
        });
        let goes_on = self.steady && due && heard.bridges(now_ns);
        if !self.news && !goes_on {
            return;
        }
        let at_ns = match self.steady {
            true => self.forward(heard.stamp_ns.saturating_add(heard.since_ns(now_ns))),
            false => heard.stamp_ns,
        };
        let Some((law, mut packet)) = self.predictor.at(at_ns) else {
            return;
        };
        packet.valid &= heard.valid;
        let ahead_ns = at_ns.saturating_sub(heard.stamp_ns);
        self.news = false;
        self.given = Some((now_ns, at_ns));
        self.decoded = Some(Decoded {
            law,
            packet,
            fresh: true,
            sent_ns: match self.steady {
                true => heard.sent_ns.saturating_add(ahead_ns),
                false => self.content_sent_ns,
            },
        });
    }

    /// `stamp_ns`, but not before what was given: a frame that was longer on its way than the one
    /// before leads nothing back.
    fn forward(&self, stamp_ns: i64) -> i64 {
        let given_ns = self.given.map(|(_, stamp_ns)| stamp_ns);
        given_ns
            .filter(|given_ns| given_ns.saturating_sub(stamp_ns) < JUMPED_NS)
            .map_or(stamp_ns, |given_ns| given_ns.max(stamp_ns))
    }

    /// Whether the other end leaves frames out.
    pub fn is_on(&self) -> bool {
        self.heard.is_some_and(|own| own.pace > 0)
    }

    /// What counts now.
    pub fn decoded(&self) -> Option<Decoded> {
        self.decoded
    }

    /// For how long nothing was given at `now_ns`, where the other end has been silent for
    /// `silence`, both in s: less, as long as that is led on across.
    pub fn silence(&self, now_ns: i64, silence: f64) -> f64 {
        let bridges = self.steady && self.heard.is_some_and(|own| own.bridges(now_ns));
        match (bridges, self.given) {
            (true, Some((given_ns, _))) => {
                seconds(now_ns.saturating_sub(given_ns)).clamp(0.0, silence.max(0.0))
            }
            _ => silence,
        }
    }
}

impl Heard {
    fn since_ns(&self, now_ns: i64) -> i64 {
        now_ns.saturating_sub(self.taken_ns).max(0)
    }

    /// Whether the silence since is one that was announced, or one frame longer.
    fn bridges(&self, now_ns: i64) -> bool {
        let longest_ns = (2 * i64::from(self.pace) + 1) * SEND_PERIOD_NS;
        self.since_ns(now_ns) <= longest_ns.min(nanoseconds(LONGEST_BRIDGE))
    }
}

//! The wire between the two hosts: what it does to frames, and who else is on it.
//!
//! Bytes alone pass here; what a frame says is the link's, and sealed. Only [`forged`]
//! knows where frames have their number.

use std::collections::VecDeque;

use ferntast_bus::frames::{self, FrameReceiver, FrameSender, MAX_FRAME};
use ferntast_emulation::{
    channel::{Channel, ChannelConfig},
    random::Random,
};
use ferntast_model::ParameterError;
use ferntast_msgs::Time;

use super::fault::Fault;

/// Nanoseconds of a step of virtual time.
const STEP_NANOS: i64 = 1_000_000;
/// Where a sealed frame has its number.
const NUMBER: std::ops::Range<usize> = 2..6;
/// Messages of so many bytes only ask: a hello, a challenge. Who hears one that is not the
/// peer's has nothing to refuse, and nothing to act on.
const ASKS: usize = 9;
/// Frames of the past that an eavesdropper has.
const OVERHEARD: usize = 512;

/// Whose a frame is, as only the wire knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// As the other end sent it, for the first time.
    Genuine,
    /// A genuine frame that came before.
    Repeated,
    /// A genuine frame that was damaged.
    Damaged,
    /// A genuine frame that somebody kept, and that had not come through before: the
    /// end cannot tell it from one that was held up.
    Late,
    /// Somebody else's.
    Foreign,
}

/// A frame.
#[derive(Clone, Copy)]
pub struct Frame {
    bytes: [u8; MAX_FRAME],
    length: usize,
    origin: Origin,
    /// When it was sent \[step\].
    sent: i64,
    /// Whether the arm may move by it: see [`WireWay::collect`].
    valid: bool,
    /// Whether it has come through.
    arrived: bool,
}

impl Frame {
    fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

/// What arrived, since the start, at the end that a way leads to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arrivals {
    /// Last genuine frame \[step\].
    pub genuine: Option<i64>,
    /// Last genuine frame by which the arm may move \[step\].
    pub valid: Option<i64>,
    /// Frames that must not be acted on, since the end was started.
    pub refusable: u64,
    /// When the last of them came \[step\].
    pub refusable_at: i64,
}

impl Arrivals {
    /// A genuine frame came at `tick`.
    fn came(&mut self, frame: &Frame, tick: i64) {
        self.genuine = Some(tick);
        if frame.valid {
            self.valid = Some(tick);
        }
    }
}

/// Something that is done to frames for a while.
struct Active {
    fault: Fault,
    until: i64,
}

/// One direction.
pub struct WireWay {
    from: Option<FrameReceiver>,
    to: Option<FrameSender>,
    channel: Channel,
    random: Random,
    active: Vec<Active>,
    /// What is known of the frames in the channel, oldest first.
    known: VecDeque<(u64, Origin, i64, bool)>,
    /// Frames that are held back, and until when \[step\].
    held: Vec<(i64, Frame)>,
    /// Frames of others, to be delivered next.
    foreign: Vec<Frame>,
    overheard: VecDeque<Frame>,
    arrivals: Arrivals,
}

/// A number that tells frames apart (FNV-1a, by words of eight bytes, folded).
fn mark(bytes: &[u8]) -> u64 {
    bytes
        .chunks(8)
        .fold(0xcbf2_9ce4_8422_2325, |hash, part: &[u8]| {
            let mut word = [0; 8];
            word[..part.len()].copy_from_slice(part);
            let mixed = (hash ^ u64::from_le_bytes(word)).wrapping_mul(0x100_0000_01b3);
            mixed ^ (mixed >> 32)
        })
}

impl WireWay {
    /// A way of those properties.
    ///
    /// # Errors
    ///
    /// A parameter of the channel out of its bounds.
    pub fn new(channel: ChannelConfig, seed: u64) -> Result<WireWay, ParameterError> {
        Ok(WireWay {
            from: None,
            to: None,
            channel: Channel::new(channel, seed)?,
            random: Random::new(seed ^ 0x77),
            active: Vec::new(),
            known: VecDeque::new(),
            held: Vec::new(),
            foreign: Vec::new(),
            overheard: VecDeque::with_capacity(OVERHEARD),
            arrivals: Arrivals::default(),
        })
    }

    /// The sender for an end that is started now.
    pub fn sender(&mut self) -> FrameSender {
        let (sender, receiver) = frames::memory();
        self.from = Some(receiver);
        sender
    }

    /// The receiver for an end that is started now.
    pub fn receiver(&mut self) -> FrameReceiver {
        let (sender, receiver) = frames::memory();
        self.to = Some(sender);
        self.arrivals.refusable = 0;
        receiver
    }

    /// What arrived.
    pub fn arrivals(&self) -> Arrivals {
        self.arrivals
    }

    /// Does that to frames until `until` \[step\].
    pub fn suffer(&mut self, fault: Fault, until: i64) {
        self.active.push(Active { fault, until });
    }

    /// Frames of `ago` \[steps\] ago arrive once more.
    pub fn replay(&mut self, tick: i64, ago: i64, count: u32) {
        let old = self.overheard.iter().filter(|own| tick - own.sent >= ago);
        let old = old.rev().take(count as usize);
        let again = old.map(|own| Frame {
            origin: match own.arrived {
                true => Origin::Foreign,
                false => Origin::Late,
            },
            ..*own
        });
        let again: Vec<Frame> = again.collect();
        self.foreign.extend(again.into_iter().rev());
    }

    /// Somebody who heard frames of both ways sends `count` of his own. `other`
    /// is the newest frame that was heard on the other way.
    pub fn forge(&mut self, count: u32, other: Option<&Frame>) {
        let Some(own) = self.overheard.back().copied() else {
            return;
        };
        for number in 0..count {
            let model = match (number % 4, other) {
                (3, Some(other)) => other,
                _ => &own,
            };
            let frame = forged(model, number, &mut self.random);
            self.foreign.push(frame);
        }
    }

    /// The newest frame that was heard.
    pub fn newest_heard(&self) -> Option<Frame> {
        self.overheard.back().copied()
    }

    /// A frame of another sender arrives.
    pub fn intrude(&mut self, bytes: &[u8], tick: i64) {
        self.foreign
            .push(frame(bytes, Origin::Foreign, tick, false));
    }

    /// Takes what was sent since the last step, at `tick`. `valid` says whether
    /// the arm may move by what is sent now: the hand is there, the master is
    /// enabled, frames come back.
    pub fn collect(&mut self, tick: i64, valid: bool) {
        self.active.retain(|own| tick < own.until);
        let mut buffer = [0; MAX_FRAME];
        while let Some((length, _)) = self
            .from
            .as_mut()
            .and_then(|from| from.receive(Time::from_nanos(i64::MAX), &mut buffer))
        {
            let sent = frame(&buffer[..length], Origin::Genuine, tick, valid);
            if self.overheard.len() == OVERHEARD {
                self.overheard.pop_front();
            }
            self.overheard.push_back(sent);
            self.send(sent, tick);
        }
    }

    fn send(&mut self, mut frame: Frame, tick: i64) {
        let sent = frame;
        let mut copies = 1;
        for Active { fault, .. } in &self.active {
            match fault {
                Fault::Blackout { .. } => return,
                Fault::Loss { share, .. } if self.random.chance(*share) => return,
                Fault::Duplicate { share, .. } if self.random.chance(*share) => copies = 2,
                Fault::BitFlip { share, .. } if self.random.chance(*share) => {
                    let bit = (self.random.uniform() * 8.0 * frame.length as f64) as usize;
                    frame.bytes[bit / 8] ^= 1 << (bit % 8);
                    frame.origin = Origin::Damaged;
                }
                _ => {}
            }
        }
        // The same bit twice is none.
        if frame.bytes == sent.bytes {
            frame.origin = sent.origin;
        }
        for copy in 0..copies {
            let origin = match (frame.origin, copy) {
                (Origin::Genuine, 1) => Origin::Repeated,
                (origin, _) => origin,
            };
            self.channel.push(tick * STEP_NANOS, frame.bytes());
            self.known
                .push_back((mark(frame.bytes()), origin, frame.sent, frame.valid));
        }
    }

    /// Hands what was sent since the last step to `other`, as somebody else's.
    pub fn pass_on(&mut self, other: &mut WireWay, tick: i64) {
        let mut buffer = [0; MAX_FRAME];
        while let Some((length, _)) = self
            .from
            .as_mut()
            .and_then(|from| from.receive(Time::from_nanos(i64::MAX), &mut buffer))
        {
            other.intrude(&buffer[..length], tick);
        }
    }

    /// Hands over what arrives at `tick`, when the clock of the host there shows `now`.
    pub fn deliver(&mut self, tick: i64, now: Time) {
        let mut buffer = [0; MAX_FRAME];
        while let Some((length, _)) = self.channel.pop(tick * STEP_NANOS, &mut buffer) {
            let Some(frame) = self.recognise(&buffer[..length]) else {
                continue;
            };
            match self.held_until(tick) {
                Some(until) => self.held.push((until, frame)),
                None => self.hand_over(frame, tick, now),
            }
        }
        if !self.held.is_empty() {
            let mut index = 0;
            while index < self.held.len() {
                match self.held[index].0 <= tick {
                    true => {
                        let (_, frame) = self.held.remove(index);
                        self.hand_over(frame, tick, now);
                    }
                    false => index += 1,
                }
            }
        }
        // As many as a network would bring in a millisecond, and a node takes.
        let now_come = self.foreign.len().min(8);
        for frame in self.foreign.drain(..now_come).collect::<Vec<_>>() {
            self.hand_over(frame, tick, now);
        }
    }

    /// What is known of the frame of these bytes.
    fn recognise(&mut self, bytes: &[u8]) -> Option<Frame> {
        let own = mark(bytes);
        let place = self.known.iter().position(|known| known.0 == own)?;
        let (_, origin, sent, valid) = self.known.remove(place)?;
        // What the channel lost is not asked for any more.
        if self.known.len() > 4096 {
            self.known.pop_front();
        }
        Some(Frame {
            valid,
            ..frame(bytes, origin, sent, false)
        })
    }

    fn held_until(&mut self, tick: i64) -> Option<i64> {
        let mut held = 0;
        for Active { fault, .. } in &self.active {
            match fault {
                Fault::Reorder { share, held_ms, .. } if self.random.chance(*share) => {
                    held += held_ms;
                }
                Fault::Jitter { most_ms, .. } => {
                    held += (self.random.uniform() * (*most_ms as f64 + 1.0)) as i64;
                }
                _ => {}
            }
        }
        (held > 0).then_some(tick + held)
    }

    fn hand_over(&mut self, frame: Frame, tick: i64, now: Time) {
        match frame.origin {
            // The first of a frame and its copy is the one that counts.
            Origin::Genuine | Origin::Repeated => {
                let mut heard = self.overheard.iter_mut().rev();
                let own = heard.find(|own| own.sent <= frame.sent);
                let known = own.map(|own| std::mem::replace(&mut own.arrived, true));
                if !known.unwrap_or(frame.origin == Origin::Repeated) {
                    self.arrivals.came(&frame, tick);
                }
            }
            // A genuine frame comes through, by whatever hand.
            Origin::Late => self.arrivals.came(&frame, tick),
            Origin::Damaged | Origin::Foreign if frame.length <= ASKS => {}
            Origin::Damaged | Origin::Foreign => {
                self.arrivals.refusable += 1;
                self.arrivals.refusable_at = tick;
            }
        }
        if let Some(to) = &mut self.to {
            // Just before this step, so that the step sees it. What is too long
            // was never sent.
            let _ = to.send(now.plus_nanos(-1), frame.bytes());
        }
    }
}

fn frame(bytes: &[u8], origin: Origin, sent: i64, valid: bool) -> Frame {
    let mut own = Frame {
        bytes: [0; MAX_FRAME],
        length: bytes.len().min(MAX_FRAME),
        origin,
        sent,
        valid,
        arrived: false,
    };
    own.bytes[..own.length].copy_from_slice(&bytes[..own.length]);
    own
}

/// A frame as somebody would make it who has `model` and no key: another number, yet to
/// come, and other words. Where they stand is known, what they are is not.
fn forged(model: &Frame, number: u32, random: &mut Random) -> Frame {
    let mut own = Frame {
        origin: Origin::Foreign,
        valid: false,
        ..*model
    };
    if own.length < NUMBER.end {
        return own;
    }
    let bytes = NUMBER.map(|place| own.bytes[place]).collect::<Vec<u8>>();
    let old = bytes.try_into().map_or(0, u32::from_le_bytes);
    let new = old.wrapping_add(1_000_000 + number).to_le_bytes();
    own.bytes[NUMBER].copy_from_slice(&new);
    for byte in &mut own.bytes[NUMBER.end..own.length] {
        if random.chance(0.2) {
            *byte ^= 1 << (number % 8);
        }
    }
    own
}

#[cfg(test)]
mod tests {
    use super::super::fault::Way;
    use super::*;

    const START: Time = Time::from_nanos(1_000_000_000_000);

    fn at(tick: i64) -> Time {
        START.plus_nanos(tick * STEP_NANOS)
    }

    /// Sends a frame of that length every step for `steps` over a way that suffers
    /// `fault`; gives what arrived.
    fn send(way: &mut WireWay, fault: Option<Fault>, steps: i64) -> Vec<(i64, Vec<u8>)> {
        let mut sender = way.sender();
        let mut receiver = way.receiver();
        if let Some(fault) = fault {
            way.suffer(fault, i64::MAX);
        }
        let mut arrived = Vec::new();
        let mut buffer = [0; MAX_FRAME];
        for tick in 0..steps {
            way.deliver(tick, at(tick));
            while let Some((length, _)) = receiver.receive(at(tick), &mut buffer) {
                arrived.push((tick, buffer[..length].to_vec()));
            }
            let mut frame = [7; 60];
            frame[..8].copy_from_slice(&tick.to_le_bytes());
            sender.send(at(tick), &frame).unwrap();
            way.collect(tick, tick % 2 == 0);
        }
        arrived
    }

    fn way() -> WireWay {
        let channel = ChannelConfig {
            delay: 0.005,
            ..ChannelConfig::default()
        };
        WireWay::new(channel, 3).unwrap()
    }

    #[test]
    fn frames_come_through_as_they_are_after_the_channels_delay() {
        let mut way = way();
        let arrived = send(&mut way, None, 50);
        assert_eq!(arrived.len(), 45);
        for (number, (tick, bytes)) in arrived.iter().enumerate() {
            assert_eq!(*tick, number as i64 + 5);
            assert_eq!(bytes[..8], (number as i64).to_le_bytes());
        }
        let own = way.arrivals();
        assert_eq!(
            (own.genuine, own.valid, own.refusable),
            (Some(49), Some(49), 0)
        );
    }

    #[test]
    fn what_it_suffers_it_does_and_counts() {
        let share = 1.0;
        let (forth, ms) = (Way::Forth, 1000);
        let mut dark = way();
        assert!(send(&mut dark, Some(Fault::Blackout { way: forth, ms }), 50).is_empty());
        assert_eq!(dark.arrivals().genuine, None);
        let mut double = way();
        let twice = send(
            &mut double,
            Some(Fault::Duplicate {
                way: forth,
                share,
                ms,
            }),
            50,
        );
        assert_eq!(twice.len(), 90);
        assert_eq!(double.arrivals().refusable, 0);
        let mut damaged = way();
        let flipped = send(
            &mut damaged,
            Some(Fault::BitFlip {
                way: forth,
                share,
                ms,
            }),
            50,
        );
        assert_eq!(damaged.arrivals().refusable, 45);
        for (number, (_, bytes)) in flipped.iter().enumerate() {
            let mut sent = [7; 60];
            sent[..8].copy_from_slice(&(number as i64).to_le_bytes());
            let bits = bytes.iter().zip(sent).map(|(a, b)| (a ^ b).count_ones());
            assert_eq!(bits.sum::<u32>(), 1);
        }
    }

    #[test]
    fn an_eavesdropper_repeats_and_forges() {
        let mut own = way();
        send(&mut own, None, 50);
        own.replay(50, 20, 10);
        own.forge(5, None);
        assert_eq!(own.foreign.len(), 15);
        let ages: Vec<i64> = own.foreign[..10].iter().map(|own| 50 - own.sent).collect();
        assert_eq!(ages, [29, 28, 27, 26, 25, 24, 23, 22, 21, 20]);
        own.deliver(50, at(50));
        own.deliver(51, at(51));
        assert_eq!(own.arrivals().refusable, 15);
    }
}

//! How a link node meets frames: the wire, the seal, and behind them the channel
//! emulator. What strangers send goes no further than the seal, so that it takes no
//! room from frames of the peer; the emulator delays what was opened, with the length
//! that it had on the wire.

use ferntast_bus::{
    SubscriberCounts,
    frames::{Door, FrameReceiver, FrameSender, MAX_FRAME, Reason},
};
use ferntast_control::{
    frame::{FRAME_LENGTH, FrameBytes, KEEP_ALIVE_LENGTH, POSE_LENGTH, SEAL_LENGTH, WIRE_LENGTH},
    view::{LONGEST_VIEW, ViewBytes},
};
use ferntast_emulation::channel::{Channel, ChannelConfig};
use ferntast_model::ParameterError;
use ferntast_msgs::{
    Time,
    sample::{JointNames, LinkCommandSample},
    topics::{JointNameError, TopicName},
};
use ferntast_seal::{
    Established, Kind, LONG_LENGTH, PLAIN_LENGTH, PlainFrame, Received, Refusal, RefusalCounts,
    SEALED_LENGTH, SHORT_LENGTH, SecureEnd,
};

use crate::node::{Node, Output, Ports};

/// How many frames a step takes at most: what waits for a computer that was held up for
/// half a second, so that the next step acts on the newest and not on the oldest.
const BATCH: usize = 256;

const _: () = assert!(FRAME_LENGTH == PLAIN_LENGTH && WIRE_LENGTH == SEALED_LENGTH);
const _: () = assert!(KEEP_ALIVE_LENGTH == SHORT_LENGTH && POSE_LENGTH == LONG_LENGTH);
const _: () = assert!(LONGEST_VIEW <= ferntast_seal::LONGEST_VIEW && POSE_LENGTH <= LONGEST_VIEW);

/// What the emulated channel carries at most: the longest view, as long as it was sealed \[bytes\].
const LONGEST_ON_THE_WAY: usize = LONGEST_VIEW + SEAL_LENGTH;

/// One end of the link, open.
pub struct LinkWire {
    /// Sends to the other end.
    pub sender: FrameSender,
    /// Receives from it.
    pub receiver: FrameReceiver,
    /// Keeps strangers out.
    pub secure: SecureEnd,
    /// Who did not come in, before there were frames; nobody in virtual time.
    pub door: Door,
}

/// What is known of the peer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Peer {
    /// The handshake in force.
    pub established: Option<Established>,
    /// What was not acted on since the start.
    pub refused: RefusalCounts,
    /// Why the newest of that was not.
    pub last_refusal: Option<Refusal>,
    /// Connections that TLS turned away since the start.
    pub turned_away: u64,
    /// Why it did the last of them, or, at the operator's end, why it was not let in itself.
    pub at_the_door: Option<Reason>,
}

/// What the emulated channel to this end is set to, for a frame of this length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Emulated {
    /// How long a frame is on its way \[s\].
    pub delay: f64,
    /// Largest deviation of that, or one like it \[s\].
    pub jitter: f64,
    /// Share of frames that it loses \[-\].
    pub loss: f64,
}

/// A frame or view of `MOST` bytes at most, opened, and when it arrived.
#[derive(Clone, Copy, Debug)]
struct Arrived<const MOST: usize> {
    bytes: [u8; MOST],
    length: usize,
    at: Time,
}

impl<const MOST: usize> Default for Arrived<MOST> {
    fn default() -> Self {
        Arrived {
            bytes: [0; MOST],
            length: 0,
            at: Time::INVALID,
        }
    }
}

impl<const MOST: usize> Arrived<MOST> {
    fn set(&mut self, bytes: &[u8], at: Time) {
        self.length = bytes.len().min(MOST);
        self.bytes[..self.length].copy_from_slice(&bytes[..self.length]);
        self.at = at;
    }

    /// Content and time of arrival.
    fn get(&self) -> (&[u8], Time) {
        (&self.bytes[..self.length], self.at)
    }
}

/// Frames that arrived since the last step, oldest first, and the last view.
#[derive(Debug)]
pub struct FrameInput {
    frames: [Arrived<POSE_LENGTH>; BATCH],
    count: usize,
    view: Option<Arrived<LONGEST_VIEW>>,
    /// Whom they come from.
    pub peer: Peer,
    /// What they came through.
    pub channel: Emulated,
}

impl Default for FrameInput {
    fn default() -> Self {
        FrameInput {
            frames: [Arrived::default(); BATCH],
            count: 0,
            view: None,
            peer: Peer::default(),
            channel: Emulated::default(),
        }
    }
}

impl FrameInput {
    /// These, arrived at that time; what does not fit is left out.
    #[cfg(test)]
    pub(super) fn of<'a>(frames: impl IntoIterator<Item = &'a [u8]>, arrived: Time) -> FrameInput {
        let mut input = FrameInput::default();
        for frame in frames {
            input.add(frame, arrived);
        }
        input
    }

    /// One more; there is no room for more than a batch.
    fn add(&mut self, frame: &[u8], at: Time) {
        if let Some(place) = self.frames.get_mut(self.count) {
            place.set(frame, at);
            self.count += 1;
        }
    }

    /// A view of the arm, in place of one that came before it.
    pub(super) fn see(&mut self, view: &[u8], at: Time) {
        self.view.insert(Arrived::default()).set(view, at);
    }

    fn is_full(&self) -> bool {
        self.count >= self.frames.len()
    }

    /// Content and time of arrival of each.
    pub fn iter(&self) -> impl Iterator<Item = (&[u8], Time)> {
        self.frames[..self.count].iter().map(Arrived::get)
    }

    /// The last view of the arm that arrived since the last step.
    pub fn view(&self) -> Option<(&[u8], Time)> {
        self.view.as_ref().map(Arrived::get)
    }
}

/// What is to be sent after a step.
#[derive(Debug, Default)]
pub struct FrameOutput {
    /// The frame, when one is due.
    pub frame: Option<FrameBytes>,
    /// The view of the arm, when one is due.
    pub view: Option<ViewBytes>,
}

/// A link node's input, output: topics and frames.
pub trait LinkNode: Node {
    /// The frames of an input.
    fn frames(input: &mut Self::Input) -> &mut FrameInput;
    /// The frame of an output.
    fn frame(output: &Self::Output) -> &FrameOutput;
    /// What the channel is to do, if that was said since the last step.
    fn command(input: &Self::Input) -> Option<&LinkCommandSample>;
}

/// The wire to the other end, with the channel that is emulated on what arrives.
pub struct LinkTransport {
    wire: LinkWire,
    channel: Channel,
}

impl LinkTransport {
    /// A transport whose incoming frames go through a channel of `incoming`.
    ///
    /// # Errors
    ///
    /// A parameter of the channel out of its bounds.
    pub fn new(
        wire: LinkWire,
        incoming: ChannelConfig,
        seed: u64,
    ) -> Result<LinkTransport, ParameterError> {
        Ok(LinkTransport {
            wire,
            channel: Channel::new(incoming, seed)?,
        })
    }

    /// Sets the channel again; what is out of bounds changes nothing.
    fn obey(&mut self, command: &LinkCommandSample) {
        let config = self.channel.config();
        // What sending a frame takes is part of its way.
        let sending = config.nominal_delay(WIRE_LENGTH) - config.delay;
        let way = match command.round_trip / 2.0 {
            way if way >= 0.0 => (way - sending).max(0.0),
            out_of_bounds => out_of_bounds,
        };
        let _ = self.channel.retune(way, command.jitter, command.loss);
    }

    fn emulated(&self) -> Emulated {
        let config = self.channel.config();
        Emulated {
            delay: config.nominal_delay(WIRE_LENGTH),
            jitter: config.largest_deviation(),
            loss: config.mean_loss(),
        }
    }

    /// Which handshake frames are under, as the channel carries it.
    fn mark(&self) -> u8 {
        let established = self.wire.secure.established();
        established.map_or(0, |own| own.incarnation as u8)
    }

    /// Puts what came into the channel, as long as it was when it was sealed, with the mark and the
    /// kind where the seal was.
    fn push(&mut self, arrived: Time, kind: Kind, plain: &PlainFrame) {
        let mut on_the_way = [0; LONGEST_ON_THE_WAY];
        let plain = &plain[..plain.len().min(LONGEST_VIEW)];
        on_the_way[..plain.len()].copy_from_slice(plain);
        on_the_way[plain.len()] = self.mark();
        on_the_way[plain.len() + 1] = u8::from(kind == Kind::View);
        let sealed = plain.len() + SEAL_LENGTH;
        self.channel.push(arrived.nanos(), &on_the_way[..sealed]);
    }

    fn read(&mut self, now: Time, input: &mut FrameInput) {
        let mut buffer = [0; MAX_FRAME];
        while let Some((length, arrived)) = self.wire.receiver.receive(now, &mut buffer) {
            let bytes = &buffer[..length.min(MAX_FRAME)];
            let received = self.wire.secure.received(bytes, arrived.nanos());
            if let Received::Sealed(kind, plain) = received {
                self.push(arrived, kind, &plain);
            }
        }
        let mark = self.mark();
        let mut on_the_way = [0; LONGEST_ON_THE_WAY];
        input.count = 0;
        input.view = None;
        while !input.is_full() {
            let Some((length, released)) = self.channel.pop(now.nanos(), &mut on_the_way) else {
                break;
            };
            let length = length.saturating_sub(SEAL_LENGTH);
            let (bytes, released) = (&on_the_way[..length], Time::from_nanos(released));
            match &on_the_way[length..] {
                [own, 0, ..] if *own == mark => input.add(bytes, released),
                [own, _, ..] if *own == mark => input.see(bytes, released),
                // What a process sent that is no longer there is over.
                _ => {}
            }
        }
        input.channel = self.emulated();
        let door = &self.wire.door;
        input.peer = Peer {
            turned_away: door.turned_away(),
            at_the_door: door.last_turned_away().or_else(|| door.not_let_in()),
            established: self.wire.secure.established(),
            refused: self.wire.secure.refused(),
            last_refusal: self.wire.secure.last_refusal(),
        };
    }

    fn write(&mut self, now: Time, output: &FrameOutput) -> u64 {
        let mut failed = 0;
        if let Some(message) = self.wire.secure.message(now.nanos()) {
            failed += u64::from(self.wire.sender.send(now, message.bytes()).is_err());
        }
        let secure = &mut self.wire.secure;
        let frame = output.frame.as_ref();
        let frame = frame.and_then(|own| secure.seal(Kind::Frame, own));
        let view = output.view.as_ref();
        let view = view.and_then(|own| secure.seal(Kind::View, own));
        for sealed in [frame, view].iter().flatten() {
            failed += u64::from(self.wire.sender.send(now, sealed).is_err());
        }
        failed
    }
}

/// Ports of a link node: topics of a bus, and the wire.
pub struct LinkPorts<P> {
    topics: P,
    transport: LinkTransport,
}

impl<P> LinkPorts<P> {
    /// Ports for those topics and that wire.
    pub fn new(topics: P, transport: LinkTransport) -> LinkPorts<P> {
        LinkPorts { topics, transport }
    }
}

impl<P: Ports> Ports for LinkPorts<P>
where
    P::Node: LinkNode,
    <P::Node as Node>::Output: Output,
{
    type Node = P::Node;

    fn inputs(joints: &JointNames) -> Result<Vec<TopicName>, JointNameError> {
        P::inputs(joints)
    }

    fn outputs(joints: &JointNames) -> Result<Vec<TopicName>, JointNameError> {
        P::outputs(joints)
    }

    fn read(&mut self, now: Time, input: &mut <P::Node as Node>::Input) {
        self.topics.read(now, input);
        if let Some(command) = P::Node::command(input) {
            self.transport.obey(command);
        }
        self.transport.read(now, P::Node::frames(input));
    }

    fn write(&mut self, now: Time, output: &<P::Node as Node>::Output) -> u64 {
        self.topics.write(now, output) + self.transport.write(now, P::Node::frame(output))
    }

    fn counts(&self, each: &mut dyn FnMut(&TopicName, &SubscriberCounts)) {
        self.topics.counts(each);
    }
}

//! How a link node meets frames: the wire, and the channel emulator behind it.

use ferntast_bus::{
    SubscriberCounts,
    frames::{FrameReceiver, FrameSender, MAX_FRAME},
};
use ferntast_control::frame::FRAME_LENGTH;
use ferntast_emulation::channel::{Channel, ChannelConfig};
use ferntast_model::ParameterError;
use ferntast_msgs::{
    Time,
    sample::{JointNames, LinkCommandSample},
    topics::{JointNameError, TopicName},
};

use crate::node::{Node, Output, Ports};

/// How many frames a step takes at most.
const BATCH: usize = 16;

/// Frames that arrived since the last step, oldest first.
#[derive(Debug)]
pub struct FrameInput {
    frames: [([u8; MAX_FRAME], usize, Time); BATCH],
    count: usize,
}

impl Default for FrameInput {
    fn default() -> Self {
        FrameInput {
            frames: [([0; MAX_FRAME], 0, Time::INVALID); BATCH],
            count: 0,
        }
    }
}

impl FrameInput {
    /// These, arrived at that time; what does not fit is left out.
    #[cfg(test)]
    pub(super) fn of(frames: &[&[u8]], arrived: Time) -> FrameInput {
        let mut input = FrameInput::default();
        for (place, frame) in input.frames.iter_mut().zip(frames) {
            let length = frame.len().min(MAX_FRAME);
            place.0[..length].copy_from_slice(&frame[..length]);
            place.1 = length;
            place.2 = arrived;
            input.count += 1;
        }
        input
    }

    /// Bytes and time of arrival of each.
    pub fn iter(&self) -> impl Iterator<Item = (&[u8], Time)> {
        self.frames[..self.count]
            .iter()
            .map(|(bytes, length, arrived)| (&bytes[..*length], *arrived))
    }
}

/// The frame to be sent after a step.
#[derive(Debug, Default)]
pub struct FrameOutput {
    /// The frame, when one is due.
    pub frame: Option<[u8; FRAME_LENGTH]>,
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
    sender: FrameSender,
    receiver: FrameReceiver,
    channel: Channel,
}

impl LinkTransport {
    /// A transport whose incoming frames go through a channel of `incoming`.
    ///
    /// # Errors
    ///
    /// A parameter of the channel out of its bounds.
    pub fn new(
        sender: FrameSender,
        receiver: FrameReceiver,
        incoming: ChannelConfig,
        seed: u64,
    ) -> Result<LinkTransport, ParameterError> {
        Ok(LinkTransport {
            sender,
            receiver,
            channel: Channel::new(incoming, seed)?,
        })
    }

    /// Sets the channel again; what is out of bounds changes nothing.
    fn obey(&mut self, command: &LinkCommandSample) {
        let way = command.round_trip / 2.0;
        let _ = self.channel.retune(way, command.jitter, command.loss);
    }

    fn read(&mut self, now: Time, input: &mut FrameInput) {
        let mut buffer = [0; MAX_FRAME];
        while let Some((length, arrived)) = self.receiver.receive(now, &mut buffer) {
            self.channel.push(arrived.nanos(), &buffer[..length]);
        }
        input.count = 0;
        while let Some(place) = input.frames.get_mut(input.count) {
            let Some((length, released)) = self.channel.pop(now.nanos(), &mut place.0) else {
                break;
            };
            place.1 = length.min(MAX_FRAME);
            place.2 = Time::from_nanos(released);
            input.count += 1;
        }
    }

    fn write(&mut self, now: Time, output: &FrameOutput) -> u64 {
        match &output.frame {
            Some(frame) => u64::from(self.sender.send(now, frame).is_err()),
            None => 0,
        }
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

    fn counts(&self, each: &mut dyn FnMut(&str, SubscriberCounts)) {
        self.topics.counts(each);
    }
}

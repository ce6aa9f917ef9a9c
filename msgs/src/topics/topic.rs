//! A topic of the table.

use std::marker::PhantomData;

use super::{JointNameError, TopicName};
use crate::{Message, sample::JointNames};

/// How a topic is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// A servo stream: best effort, the newest wins, nothing for late joiners.
    Stream,
    /// A state: reliable, the newest wins, a late joiner gets the last one.
    State,
    /// An event or one of several publishers: reliable, none is skipped up to a queue of [`EVENT_QUEUE`].
    Event,
}

/// How many events may wait for a reader.
pub const EVENT_QUEUE: usize = 64;

/// Who on ROS 2 may publish a topic into a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Authority {
    /// Nobody: what peers publish there is not subscribed to. The topic goes out.
    Never,
    /// Commands: every peer may stop a device ([`Message::stops`]); what else can be
    /// commanded there, where the scenario says so ([`COMMANDS_SETTING`]). The topic comes
    /// in and does not go out.
    Commands,
    /// Every peer where the scenario says so; else as with [`Authority::Never`].
    ByScenario(Switch),
}

/// The setting in the scenario that lets peers command more than a stop.
pub const COMMANDS_SETTING: &str = "[gateway] commands = true";

/// What in a scenario lets peers publish a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Switch {
    /// Joint positions may be commanded past the master and the link.
    ServoJp,
    /// The hand is a client on ROS 2.
    CrtkHand,
}

impl Switch {
    /// The setting in the scenario that turns it on.
    pub const fn setting(self) -> &'static str {
        match self {
            Switch::ServoJp => "[gateway] servo_jp = true",
            Switch::CrtkHand => "[hand] source = \"crtk\"",
        }
    }
}

/// A topic: name, sample type, delivery, who publishes it.
#[derive(Debug)]
pub struct Topic<M: Message> {
    /// Full ROS 2 name.
    pub name: TopicName,
    /// How it is sent.
    pub delivery: Delivery,
    /// Nodes of the session that publish it; `every` stands for all.
    pub publishers: &'static [&'static str],
    /// Whether peers on ROS 2 may publish it into the session.
    pub authority: Authority,
    sample: PhantomData<fn() -> M>,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// See [`Topic::name`].
    pub name: TopicName,
    /// See [`Topic::delivery`].
    pub delivery: Delivery,
    /// See [`Topic::publishers`].
    pub publishers: &'static [&'static str],
    /// See [`Topic::authority`].
    pub authority: Authority,
}

impl<M: Message> Clone for Topic<M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: Message> Copy for Topic<M> {}

impl<M: Message> Topic<M> {
    /// A topic of that name that nodes of the session publish.
    pub const fn new(name: TopicName, delivery: Delivery) -> Topic<M> {
        Topic::of(name, delivery, &[], Authority::Never)
    }

    /// A row of the table; a name that is none does not compile there.
    pub(super) const fn of_table(
        name: &str,
        delivery: Delivery,
        publishers: &'static [&'static str],
        authority: Authority,
    ) -> Topic<M> {
        Topic::of(TopicName::constant(name), delivery, publishers, authority)
    }

    pub(super) const fn of(
        name: TopicName,
        delivery: Delivery,
        publishers: &'static [&'static str],
        authority: Authority,
    ) -> Topic<M> {
        Topic {
            name,
            delivery,
            publishers,
            authority,
            sample: PhantomData,
        }
    }

    /// Its row of the table, without the type of its sample.
    pub const fn row(&self) -> Row {
        Row {
            name: self.name,
            delivery: self.delivery,
            publishers: self.publishers,
            authority: self.authority,
        }
    }

    /// Itself, whatever the joints: as [`JointTopic::of_joints`](super::JointTopic::of_joints),
    /// for those who take a row of either kind.
    ///
    /// # Errors
    ///
    /// None.
    pub fn of_joints(&self, _: &JointNames) -> Result<[Topic<M>; 1], JointNameError> {
        Ok([*self])
    }
}

//! Forwards topics from one bus to another: gateway, recorder and player are
//! made of these.

use ferntast_bus::{Bus, CreateError, Depth, Publisher, Subscriber, SubscriberCounts};
use ferntast_control::planted::{Planted, Rule};
use ferntast_msgs::{
    Message, Text, Time,
    sample::JointNames,
    topics::{self, COMMANDS_SETTING, Delivery, Row, Topic, TopicName, Visitor},
};

/// How a topic is forwarded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Forwarding {
    /// Not at all.
    Not,
    /// The newest message, at most once in this many nanoseconds.
    Newest {
        /// Least time between two messages \[ns\].
        period_nanos: i64,
    },
    /// Every message; at most this many wait.
    Every {
        /// Length of the queue.
        queue: usize,
    },
    /// Every message that stops something ([`Message::stops`]); others are refused.
    Stops {
        /// Length of the queue.
        queue: usize,
    },
}

/// One topic on its way from a bus to another.
trait Route {
    fn forward(&mut self, now: Time) -> Forwarded;
    fn topic(&self) -> &TopicName;
    /// Whether messages come all the time.
    fn is_stream(&self) -> bool;
    fn counts(&self) -> SubscriberCounts;
    fn forget_losses(&mut self);
}

/// What one round forwarded.
#[derive(Clone, Copy, Debug, Default)]
pub struct Forwarded {
    /// Messages that went over.
    pub messages: u64,
    /// Messages that could not be sent.
    pub failed: u64,
}

struct TypedRoute<M: Message> {
    topic: TopicName,
    delivery: Delivery,
    from: Subscriber<M>,
    to: Publisher<M>,
    forwarding: Forwarding,
    due: Time,
    stamp: Stamp,
    /// Messages that this route does not let through.
    refused: u64,
    /// Messages that had been dropped when forwarding began.
    lost_before: u64,
}

/// Which time a forwarded message is published with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stamp {
    /// The time of the round.
    Round,
    /// The time at which the message was received.
    Received,
}

impl<M: Message> TypedRoute<M> {
    fn send(&mut self, now: Time, received: ferntast_bus::Received<M>, forwarded: &mut Forwarded) {
        let mut message = received.message;
        if received.source != 0 {
            // Commands are distinguished by their sender.
            message.set_source(received.source);
        }
        let time = match self.stamp {
            Stamp::Round => now,
            Stamp::Received => received.received,
        };
        match self.to.publish(time, &message) {
            Ok(()) => forwarded.messages += 1,
            Err(_) => forwarded.failed += 1,
        }
    }
}

impl<M: Message> Route for TypedRoute<M> {
    fn forward(&mut self, now: Time) -> Forwarded {
        let mut forwarded = Forwarded::default();
        match self.forwarding {
            Forwarding::Not => {}
            Forwarding::Newest { period_nanos } => {
                if now >= self.due
                    && let Some(received) = self.from.newest(now)
                {
                    // A due time that keeps its phase, so that the rate is met on average.
                    let next = self.due.plus_nanos(period_nanos);
                    self.due = if next > now {
                        next
                    } else {
                        now.plus_nanos(period_nanos)
                    };
                    self.send(now, received, &mut forwarded);
                }
            }
            Forwarding::Every { .. } => {
                while let Some(received) = self.from.next(now) {
                    self.send(now, received, &mut forwarded);
                }
            }
            Forwarding::Stops { .. } => {
                while let Some(received) = self.from.next(now) {
                    match received.message.stops() {
                        true => self.send(now, received, &mut forwarded),
                        false => self.refused += 1,
                    }
                }
            }
        }
        forwarded
    }

    fn topic(&self) -> &TopicName {
        &self.topic
    }

    fn is_stream(&self) -> bool {
        self.delivery == Delivery::Stream
    }

    fn counts(&self) -> SubscriberCounts {
        let mut counts = *self.from.counts();
        if self.refused > 0 {
            counts.invalid += self.refused;
            counts.last_refusal = Text::display(format_args!(
                "from peers only a stop; all with {COMMANDS_SETTING}"
            ));
        }
        counts.overflowed = counts.overflowed.saturating_sub(self.lost_before);
        counts
    }

    fn forget_losses(&mut self) {
        self.lost_before = self.from.counts().overflowed;
    }
}

/// Topics on their way from one bus to another.
#[derive(Default)]
pub struct Forwarder {
    routes: Vec<Box<dyn Route>>,
    /// From one look at what is no stream to the next \[ns\].
    seldom_nanos: i64,
    /// The next of these.
    due: Time,
    planted: Planted,
}

impl Forwarder {
    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> Forwarder {
        Forwarder { planted, ..self }
    }

    /// The same, which looks at topics that are no streams only once in `seldom_nanos`
    /// \[ns\]: they are many, and nothing comes on them most of the time.
    pub fn looking_seldom(self, seldom_nanos: i64) -> Forwarder {
        Forwarder {
            seldom_nanos,
            ..self
        }
    }

    /// Adds every topic of the table for which `how` says so, for an arm of
    /// those joints.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened on either side.
    pub fn add_topics(
        &mut self,
        from: &Bus,
        to: &Bus,
        stamp: Stamp,
        joints: &JointNames,
        how: impl Fn(Row) -> Forwarding,
    ) -> Result<(), CreateError> {
        struct Add<'a, F> {
            forwarder: &'a mut Forwarder,
            from: &'a Bus,
            to: &'a Bus,
            stamp: Stamp,
            how: F,
            result: Result<(), CreateError>,
        }
        impl<F: Fn(Row) -> Forwarding> Visitor for Add<'_, F> {
            fn topic<M: Message>(&mut self, topic: Topic<M>) {
                let forwarding = (self.how)(topic.row());
                if forwarding != Forwarding::Not && self.result.is_ok() {
                    self.result = self
                        .forwarder
                        .add(topic, self.from, self.to, self.stamp, forwarding);
                }
            }
        }
        let mut add = Add {
            forwarder: self,
            from,
            to,
            stamp,
            how,
            result: Ok(()),
        };
        topics::visit(joints, &mut add)?;
        add.result
    }

    /// Adds one topic.
    ///
    /// # Errors
    ///
    /// The topic cannot be opened on either side.
    pub fn add<M: Message>(
        &mut self,
        topic: Topic<M>,
        from: &Bus,
        to: &Bus,
        stamp: Stamp,
        forwarding: Forwarding,
    ) -> Result<(), CreateError> {
        let depth = match forwarding {
            Forwarding::Every { queue } | Forwarding::Stops { queue } => Depth::Queue(queue),
            Forwarding::Newest { .. } | Forwarding::Not => Depth::Newest,
        };
        self.routes.push(Box::new(TypedRoute {
            topic: topic.name,
            delivery: topic.delivery,
            from: from.subscriber(topic, depth)?,
            to: to.publisher(topic)?,
            forwarding,
            due: Time::INVALID,
            stamp,
            refused: 0,
            lost_before: 0,
        }));
        Ok(())
    }

    /// One round: forwards what is visible at `now`.
    pub fn forward(&mut self, now: Time) -> Forwarded {
        let mut all = Forwarded::default();
        let seldom = now >= self.due;
        if seldom {
            self.due = now.plus_nanos(self.seldom_nanos);
        }
        for route in &mut self.routes {
            if !seldom && !route.is_stream() {
                continue;
            }
            let forwarded = route.forward(now);
            all.messages += forwarded.messages;
            if !self.planted.lacks(Rule::FailuresTold) {
                all.failed += forwarded.failed;
            }
        }
        all
    }

    /// Counts losses from now on: until all topics were open, the queues of the
    /// first may have run over.
    pub fn forget_losses(&mut self) {
        for route in &mut self.routes {
            route.forget_losses();
        }
    }

    /// Tells `each` the topic of every route and what became of its messages.
    pub fn inputs(&self, each: &mut dyn FnMut(&TopicName, &SubscriberCounts)) {
        for route in &self.routes {
            each(route.topic(), &route.counts());
        }
    }
}

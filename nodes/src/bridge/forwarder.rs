//! Carries topics from one bus to another: gateway, recorder and player are
//! made of these.

use ferntast_bus::{Bus, CreateError, Depth, Publisher, Subscriber, SubscriberCounts};
use ferntast_msgs::{
    Message, Time,
    topics::{self, Row, Topic, Visitor},
};

/// How a topic is carried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carry {
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
}

/// One topic on its way from a bus to another.
trait Lane {
    fn carry(&mut self, now: Time) -> Carried;
    fn topic(&self) -> &'static str;
    fn counts(&self) -> SubscriberCounts;
}

/// What one round carried.
#[derive(Clone, Copy, Debug, Default)]
pub struct Carried {
    /// Messages that went over.
    pub messages: u64,
    /// Messages that could not be sent.
    pub failed: u64,
}

struct TypedLane<M: Message> {
    topic: &'static str,
    from: Subscriber<M>,
    to: Publisher<M>,
    carry: Carry,
    due: Time,
    stamp: Stamp,
}

/// Which time a carried message is published with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stamp {
    /// The time of the round.
    Round,
    /// The time at which the message was received.
    Received,
}

impl<M: Message> TypedLane<M> {
    fn send(&mut self, now: Time, received: ferntast_bus::Received<M>, carried: &mut Carried) {
        let mut message = received.message;
        if received.source != 0 {
            // Commands are told apart by their sender.
            message.set_source(received.source);
        }
        let time = match self.stamp {
            Stamp::Round => now,
            Stamp::Received => received.received,
        };
        match self.to.publish(time, &message) {
            Ok(()) => carried.messages += 1,
            Err(_) => carried.failed += 1,
        }
    }
}

impl<M: Message> Lane for TypedLane<M> {
    fn carry(&mut self, now: Time) -> Carried {
        let mut carried = Carried::default();
        match self.carry {
            Carry::Not => {}
            Carry::Newest { period_nanos } => {
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
                    self.send(now, received, &mut carried);
                }
            }
            Carry::Every { .. } => {
                while let Some(received) = self.from.next(now) {
                    self.send(now, received, &mut carried);
                }
            }
        }
        carried
    }

    fn topic(&self) -> &'static str {
        self.topic
    }

    fn counts(&self) -> SubscriberCounts {
        self.from.counts()
    }
}

/// Topics on their way from one bus to another.
#[derive(Default)]
pub struct Carrier {
    lanes: Vec<Box<dyn Lane>>,
}

impl Carrier {
    /// Adds every topic of the table for which `how` says so.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened on either side.
    pub fn add_topics(
        &mut self,
        from: &Bus,
        to: &Bus,
        stamp: Stamp,
        how: impl Fn(Row) -> Carry,
    ) -> Result<(), CreateError> {
        struct Add<'a, F> {
            carrier: &'a mut Carrier,
            from: &'a Bus,
            to: &'a Bus,
            stamp: Stamp,
            how: F,
            result: Result<(), CreateError>,
        }
        impl<F: Fn(Row) -> Carry> Visitor for Add<'_, F> {
            fn topic<M: Message>(&mut self, topic: Topic<M>) {
                let carry = (self.how)(topic.row());
                if carry != Carry::Not && self.result.is_ok() {
                    self.result = self
                        .carrier
                        .add(topic, self.from, self.to, self.stamp, carry);
                }
            }
        }
        let mut add = Add {
            carrier: self,
            from,
            to,
            stamp,
            how,
            result: Ok(()),
        };
        topics::visit(&mut add);
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
        carry: Carry,
    ) -> Result<(), CreateError> {
        let depth = match carry {
            Carry::Every { queue } => Depth::Queue(queue),
            Carry::Newest { .. } | Carry::Not => Depth::Newest,
        };
        self.lanes.push(Box::new(TypedLane {
            topic: topic.name,
            from: from.subscriber(topic, depth)?,
            to: to.publisher(topic)?,
            carry,
            due: Time::INVALID,
            stamp,
        }));
        Ok(())
    }

    /// One round: carries what is visible at `now`.
    pub fn carry(&mut self, now: Time) -> Carried {
        let mut all = Carried::default();
        for lane in &mut self.lanes {
            let carried = lane.carry(now);
            all.messages += carried.messages;
            all.failed += carried.failed;
        }
        all
    }

    /// Tells `each` the topic of every lane and what became of its messages.
    pub fn inputs(&self, each: &mut dyn FnMut(&'static str, SubscriberCounts)) {
        for lane in &self.lanes {
            each(lane.topic(), lane.counts());
        }
    }
}

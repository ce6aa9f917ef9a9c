//! Compares what is published with what is recorded.

use ferntast_bus::{Bus, CreateError, Depth, Subscriber};
use ferntast_msgs::{
    Message, RosMessage, Time,
    sample::JointNames,
    topics::{self, Topic, TopicName, Visitor},
};

use super::Comparison;

/// Compares the messages of one topic.
pub trait Check {
    /// Compares what arrived before `now`.
    fn check(&mut self, now: Time, result: &mut Comparison);
}

struct TypedCheck<M: Message> {
    topic: TopicName,
    recorded: Subscriber<M>,
    replayed: Subscriber<M>,
}

impl<M: Message> Check for TypedCheck<M> {
    fn check(&mut self, now: Time, result: &mut Comparison) {
        loop {
            let recorded = self.recorded.next(now);
            let replayed = self.replayed.next(now);
            if recorded.is_none() && replayed.is_none() {
                return;
            }
            result.compared += 1;
            // In the ROS 2 form: what the recording cannot hold does not count.
            let recorded = recorded.map(|own| (own.received, own.message.to_ros()));
            let replayed = replayed.map(|own| (own.received, own.message.to_ros()));
            let equal = match (&recorded, &replayed) {
                (Some(first), Some(second)) => {
                    first.0 == second.0 && same_bytes(&first.1, &second.1)
                }
                _ => false,
            };
            if !equal {
                result.different += 1;
                result.equal = false;
                if result.first_difference.is_none() {
                    let which = match (&recorded, &replayed) {
                        (Some(_), None) => "missing in the replay",
                        (None, Some(_)) => "not in the recording",
                        _ => "different",
                    };
                    let at = recorded
                        .as_ref()
                        .or(replayed.as_ref())
                        .map_or(0, |own| own.0.nanos());
                    result.first_difference = Some(format!("{} at {at} ns: {which}", self.topic));
                }
            }
        }
    }
}

/// Whether two messages are the same bytes on the wire (NaN equals NaN).
fn same_bytes<R: RosMessage>(first: &R, second: &R) -> bool {
    let (mut first_bytes, mut second_bytes) = (Vec::new(), Vec::new());
    first.encode(&mut first_bytes).is_ok()
        && second.encode(&mut second_bytes).is_ok()
        && first_bytes == second_bytes
}

/// Checks that compare those topics of the two buses, of an arm of those joints.
///
/// # Errors
///
/// A topic that cannot be opened.
pub fn checks(
    topics: Vec<TopicName>,
    joints: &JointNames,
    recorded: &Bus,
    replayed: &Bus,
) -> Result<Vec<Box<dyn Check>>, CreateError> {
    let mut add = AddChecks {
        topics,
        recorded,
        replayed,
        checks: Ok(Vec::new()),
    };
    topics::visit(joints, &mut add)?;
    add.checks
}

struct AddChecks<'a> {
    topics: Vec<TopicName>,
    recorded: &'a Bus,
    replayed: &'a Bus,
    checks: Result<Vec<Box<dyn Check>>, CreateError>,
}

impl AddChecks<'_> {
    fn check<M: Message>(&self, topic: Topic<M>) -> Result<Box<dyn Check>, CreateError> {
        Ok(Box::new(TypedCheck {
            topic: topic.name,
            recorded: self.recorded.subscriber(topic, Depth::Queue(64))?,
            replayed: self.replayed.subscriber(topic, Depth::Queue(64))?,
        }))
    }
}

impl Visitor for AddChecks<'_> {
    fn topic<M: Message>(&mut self, topic: Topic<M>) {
        if !self.topics.contains(&topic.name) {
            return;
        }
        let check = self.check(topic);
        if let Ok(checks) = &mut self.checks {
            match check {
                Ok(check) => checks.push(check),
                Err(error) => self.checks = Err(error),
            }
        }
    }
}

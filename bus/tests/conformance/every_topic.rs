//! Every topic of the table has its two ends on a bus.

use ferntast_bus::{Bus, Depth, MemoryBus};
use ferntast_msgs::{
    Message, Time,
    sample::JointNames,
    topics::{self, Topic, Visitor},
};

struct Open {
    bus: Bus,
    topics: usize,
}

impl Visitor for Open {
    fn topic<M: Message>(&mut self, topic: Topic<M>) {
        let name = topic.name;
        let subscriber = self.bus.subscriber(topic, Depth::Newest);
        let mut subscriber = subscriber.unwrap_or_else(|error| panic!("{name}: {error}"));
        let publisher = self.bus.publisher(topic);
        publisher.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(subscriber.newest(Time::from_ros(1, 0)).is_none());
        self.topics += 1;
    }
}

#[test]
fn every_topic_of_the_table_has_its_ends() {
    let mut open = Open {
        bus: Bus::Memory(MemoryBus::new()),
        topics: 0,
    };
    topics::visit(&JointNames::numbered(2), &mut open).unwrap();
    assert!(open.topics > 30, "{}", open.topics);
}

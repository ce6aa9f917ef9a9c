use ferntast_msgs::{
    sample::{JointNames, JointSample},
    topics::{Topic, TopicName},
};

use super::*;

const STREAM: Topic<JointSample> = Topic::new(TopicName::constant("/stream"), Delivery::Stream);
const STATE: Topic<JointSample> = Topic::new(TopicName::constant("/state"), Delivery::State);

fn at(nanos: i64) -> Time {
    Time::from_nanos(nanos)
}

fn sample(number: i64) -> JointSample {
    JointSample::zero(JointNames::numbered(2), at(number))
}

fn stamp(received: Option<Received<JointSample>>) -> Option<i64> {
    received.map(|received| received.message.stamp.nanos())
}

#[test]
fn visible_only_after_the_time_of_publication() {
    let bus = MemoryBus::new();
    let mut publisher = bus.publisher(STREAM).unwrap();
    let mut subscriber = bus.subscriber(STREAM, Depth::Newest).unwrap();
    publisher.publish(at(10), &sample(1)).unwrap();
    assert_eq!(stamp(subscriber.newest(at(9))), None);
    assert_eq!(stamp(subscriber.newest(at(10))), None);
    let received = subscriber.newest(at(11)).unwrap();
    assert_eq!((received.received, received.source), (at(10), 0));
    assert_eq!(stamp(subscriber.newest(at(11))), None);
}

/// The reader that runs before the publisher within a tick, and the one that
/// runs after it, see the same.
#[test]
fn the_order_within_a_tick_does_not_matter() {
    let bus = MemoryBus::new();
    let mut publisher = bus.publisher(STREAM).unwrap();
    let mut before = bus.subscriber(STREAM, Depth::Newest).unwrap();
    let mut after = bus.subscriber(STREAM, Depth::Newest).unwrap();
    for tick in 1..200 {
        let first = stamp(before.newest(at(tick)));
        publisher.publish(at(tick), &sample(tick)).unwrap();
        let second = stamp(after.newest(at(tick)));
        assert_eq!(first, second, "tick {tick}");
        assert_eq!(first, (tick > 1).then_some(tick - 1));
    }
}

#[test]
fn a_burst_within_one_tick_does_not_push_out_what_was_visible() {
    let bus = MemoryBus::new();
    let mut publisher = bus.publisher(STREAM).unwrap();
    let mut subscriber = bus.subscriber(STREAM, Depth::Newest).unwrap();
    publisher.publish(at(1), &sample(1)).unwrap();
    for number in 2..40 {
        publisher.publish(at(2), &sample(number)).unwrap();
    }
    assert_eq!(stamp(subscriber.newest(at(2))), Some(1));
    assert_eq!(stamp(subscriber.newest(at(3))), Some(39));
}

#[test]
fn a_queue_keeps_as_many_as_it_says_and_counts_the_rest() {
    let bus = MemoryBus::new();
    let mut publisher = bus.publisher(STREAM).unwrap();
    let mut subscriber = bus.subscriber(STREAM, Depth::Queue(100)).unwrap();
    for number in 1..=1000 {
        publisher.publish(at(number), &sample(number)).unwrap();
    }
    let mut read = Vec::new();
    while let Some(received) = subscriber.next(at(2000)) {
        read.push(received.message.stamp.nanos());
    }
    assert_eq!(read, (901..=1000).collect::<Vec<_>>());
    let counts = subscriber.counts();
    assert_eq!((counts.delivered, counts.overflowed), (100, 900));
}

#[test]
fn a_state_waits_for_late_joiners() {
    let bus = MemoryBus::new();
    let mut publisher = bus.publisher(STATE).unwrap();
    let mut early = bus.subscriber(STATE, Depth::Newest).unwrap();
    assert_eq!(stamp(early.newest(at(1))), None);
    publisher.publish(at(1), &sample(1)).unwrap();
    publisher.publish(at(2), &sample(2)).unwrap();
    drop(publisher);
    let mut late = bus.subscriber(STATE, Depth::Newest).unwrap();
    assert_eq!(stamp(late.newest(at(3))), Some(2));
    assert_eq!(stamp(late.newest(at(3))), None);
}

/// Looked at once, and refused by everybody who reads it.
#[test]
fn what_cannot_be_acted_on_is_counted_by_each_reader() {
    let bus = MemoryBus::new();
    let mut publisher = bus.publisher(STREAM).unwrap();
    let mut readers = [Depth::Newest, Depth::Queue(4)].map(|depth| {
        let reader = bus.subscriber(STREAM, depth);
        reader.unwrap()
    });
    let bad = sample(2).with_position([f64::NAN]);
    for message in [sample(1), bad, sample(3), bad] {
        publisher.publish(at(1), &message).unwrap();
    }
    let [newest, queue] = &mut readers;
    assert_eq!(stamp(newest.newest(at(2))), Some(3));
    assert_eq!(stamp(queue.next(at(2))), Some(1));
    assert_eq!(stamp(queue.next(at(2))), Some(3));
    assert_eq!(stamp(queue.next(at(2))), None);
    let counts = readers.map(|own| *own.counts());
    assert_eq!(counts.map(|own| own.delivered), [1, 2]);
    assert_eq!(counts.map(|own| own.invalid), [1, 2]);
    assert!(
        counts
            .iter()
            .all(|own| own.last_refusal.as_str().contains("position"))
    );
}

//! The cases that every way passes alike.

use ferntast_bus::{CreateError, Depth, Publisher};
use ferntast_msgs::{
    Time,
    sample::{JointNames, JointSample, WrenchSample},
    topics::Delivery,
};

use crate::world::{Reader, Way, World, sample};

fn publish(world: &World, publisher: &mut Publisher<JointSample>, numbers: std::ops::Range<i32>) {
    for number in numbers {
        publisher.publish(world.tick(), &sample(number)).unwrap();
    }
}

fn read_all(reader: &mut Reader<JointSample>, count: usize) -> Vec<JointSample> {
    let mut all = Vec::new();
    while all.len() < count {
        match reader.next() {
            Some(received) => all.push(received.message),
            None => break,
        }
    }
    all
}

fn samples(numbers: std::ops::Range<i32>) -> Vec<JointSample> {
    numbers.map(sample).collect()
}

/// Values are equal, in order, each once; the source is reported.
pub fn delivery(world: &World) {
    let topic = world.topic("events", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(64)).unwrap();
    let mut publisher = world.participant().publisher(topic).unwrap();
    world.meet(&mut publisher, &mut reader);
    let before = reader_counts(world, &mut reader);
    publish(world, &mut publisher, 0..40);
    let first = reader.next().unwrap();
    assert_eq!(first.message, sample(0));
    assert!(first.received.is_valid());
    let on_this_host = matches!(world.way, Way::Memory | Way::SharedMemory | Way::Mcap);
    assert_eq!(first.source == 0, on_this_host, "source {}", first.source);
    assert_eq!(read_all(&mut reader, 39), samples(1..40));
    assert!(reader.is_quiet());
    let counts = reader.counts();
    assert_eq!(counts.delivered - before, 40);
    assert_eq!(counts.refused(), 0);
    assert_eq!(counts.overflowed, 0);
}

/// What the meeting delivered; a recording is still being written then.
fn reader_counts(world: &World, reader: &mut Reader<JointSample>) -> u64 {
    match world.way {
        Way::Mcap => 0,
        _ => reader.counts().delivered,
    }
}

/// A reader that looks seldom gets the newest, once.
pub fn newest_wins(world: &World) {
    let topic = world.topic("stream", Delivery::Stream);
    let mut reader = world.reader(topic, Depth::Newest).unwrap();
    let mut publisher = world.participant().publisher(topic).unwrap();
    world.meet(&mut publisher, &mut reader);
    publish(world, &mut publisher, 0..10);
    reader.settle();
    assert_eq!(reader.newest().unwrap().message, sample(9));
    assert!(reader.is_quiet(), "each message is handed out once");
    assert_eq!(
        reader.counts().overflowed,
        0,
        "nothing that counts was lost"
    );
}

/// Past its depth a queue drops the oldest, and counts them.
pub fn full_queue(world: &World) {
    let topic = world.topic("events", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(4)).unwrap();
    let mut publisher = world.participant().publisher(topic).unwrap();
    world.meet(&mut publisher, &mut reader);
    if world.way != Way::Mcap {
        // Numbers are counted from a publisher's first message that was seen.
        publish(world, &mut publisher, 0..1);
        assert_eq!(read_all(&mut reader, 1), samples(0..1));
    }
    publish(world, &mut publisher, 1..11);
    reader.settle();
    assert_eq!(read_all(&mut reader, 4), samples(7..11));
    assert!(reader.is_quiet());
    assert_eq!(reader.counts().overflowed, 6);
}

/// Who comes late to a stream gets the next message, not an old one.
pub fn late_joiner_of_a_stream(world: &World) {
    let topic = world.topic("stream", Delivery::Stream);
    let mut publisher = world.participant().publisher(topic).unwrap();
    publish(world, &mut publisher, 0..3);
    world.tick();
    let mut reader = world.reader(topic, Depth::Newest).unwrap();
    if !world.is_virtual() {
        assert!(
            reader.is_quiet(),
            "what was before is not for a late joiner"
        );
    }
    world.meet(&mut publisher, &mut reader);
    publish(world, &mut publisher, 3..4);
    assert_eq!(reader.next().unwrap().message, sample(3));
    assert!(reader.is_quiet());
}

/// Who comes late to a state gets the last one, though nothing is published since.
pub fn late_joiner_of_a_state(world: &World) {
    let topic = world.topic("state", Delivery::State);
    let mut publisher = world.participant().publisher(topic).unwrap();
    publish(world, &mut publisher, 0..3);
    world.tick();
    let mut reader = world.reader(topic, Depth::Newest).unwrap();
    assert_eq!(reader.newest().unwrap().message, sample(2));
    assert!(reader.is_quiet(), "the last one comes once");
}

/// A reader goes on with a publisher that was started again.
pub fn publisher_restart(world: &World) {
    let topic = world.topic("events", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(64)).unwrap();
    for life in 0..3 {
        let mut publisher = world.participant().publisher(topic).unwrap();
        world.meet(&mut publisher, &mut reader);
        publish(world, &mut publisher, 10 * life..10 * life + 5);
        if world.way != Way::Mcap {
            assert_eq!(read_all(&mut reader, 5), samples(10 * life..10 * life + 5));
        }
    }
    if world.way == Way::Mcap {
        let all = [samples(0..5), samples(10..15), samples(20..25)].concat();
        assert_eq!(read_all(&mut reader, 15), all);
    }
    assert!(reader.is_quiet());
    assert_eq!(reader.counts().overflowed, 0);
}

/// Several publishers on one topic, as on `/diagnostics`.
pub fn two_publishers(world: &World) {
    let topic = world.topic("events", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(64)).unwrap();
    let mut one = world.participant().publisher(topic).unwrap();
    let mut other = world.participant().publisher(topic).unwrap();
    world.meet(&mut one, &mut reader);
    world.meet(&mut other, &mut reader);
    publish(world, &mut one, 0..5);
    publish(world, &mut other, 100..105);
    let mut all = read_all(&mut reader, 10);
    // Each publisher's messages keep their order; between the two there is none.
    let (low, high): (Vec<_>, Vec<_>) = all.drain(..).partition(|s| s.position[0] < 50.0);
    assert_eq!(low, samples(0..5));
    assert_eq!(high, samples(100..105));
    assert!(reader.is_quiet());
}

/// Two types under one name never mix.
pub fn wrong_type(world: &World) {
    let topic = world.topic::<JointSample>("typed", Delivery::Event);
    let wrong = ferntast_msgs::topics::Topic::<WrenchSample>::new(topic.name, topic.delivery);
    let mut reader = world.reader(topic, Depth::Queue(8)).unwrap();
    let mut publisher = world.participant().publisher(topic).unwrap();
    let wrong_publisher = world.participant().publisher(wrong);
    match world.way {
        Way::Memory | Way::SharedMemory | Way::Mcap => {
            let Err(CreateError::WrongType { wanted, found, .. }) = wrong_publisher else {
                panic!("{wrong_publisher:?}");
            };
            assert!(wanted.contains("WrenchSample"), "{wanted}");
            assert!(found.contains("Joint"), "{found}");
            if world.way != Way::Mcap {
                let reader = world.reader(wrong, Depth::Newest);
                assert!(matches!(reader, Err(CreateError::WrongType { .. })));
            }
        }
        Way::Dds | Way::Zenoh => {
            let mut wrong_publisher = wrong_publisher.unwrap();
            world.meet(&mut publisher, &mut reader);
            let wrench = WrenchSample {
                stamp: world.now(),
                ..wrench()
            };
            for _ in 0..20 {
                wrong_publisher.publish(world.tick(), &wrench).unwrap();
            }
            assert!(reader.is_quiet(), "nothing of another type arrives");
            // Over Zenoh the two never meet; over DDS they may, see `dds/senders.rs`.
            let refused = reader.counts();
            assert_eq!(refused.refused(), refused.undecodable);
            assert!(world.way == Way::Dds || refused.undecodable == 0);
        }
    }
    // And the right one goes on.
    publish(world, &mut publisher, 0..1);
    assert_eq!(reader.next().unwrap().message, sample(0));
}

fn wrench() -> WrenchSample {
    // SAFETY: every bit pattern of a message is a value.
    let mut wrench: WrenchSample = unsafe { std::mem::zeroed() };
    wrench.stamp = Time::from_nanos(1);
    wrench
}

/// A sample that cannot be acted on is counted, and the older valid one stands.
pub fn invalid(world: &World) {
    let topic = world.topic("stream", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(8)).unwrap();
    let mut publisher = world.participant().publisher(topic).unwrap();
    world.meet(&mut publisher, &mut reader);
    publish(world, &mut publisher, 0..1);
    let no_stamp = JointSample::zero(JointNames::numbered(2), Time::INVALID);
    let mut not_finite = sample(1);
    not_finite.velocity[1] = f64::NAN;
    for bad in [no_stamp, not_finite] {
        publisher.publish(world.tick(), &bad).unwrap();
    }
    reader.settle();
    assert_eq!(reader.newest().unwrap().message, sample(0));
    let counts = reader.counts();
    assert_eq!((counts.invalid, counts.refused()), (2, 2));
    assert!(reader.is_quiet());
}

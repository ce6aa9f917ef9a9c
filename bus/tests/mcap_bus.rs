//! A recording as a way across: the contract that all ways share, and what is
//! particular to recordings.

#![allow(clippy::unwrap_used)] // A test may.

#[path = "../../bag/tests/samples/mod.rs"]
mod samples;

use ferntast_bag::info;
use ferntast_bus::{CreateError, Depth, McapBus, PublishError};
use ferntast_msgs::{
    Time,
    sample::{JointSample, PoseSample},
    topics::{
        Delivery, FOLLOWER_MEASURED_JS, FOLLOWER_OPERATING_STATE, FOLLOWER_STATE_COMMAND, Topic,
    },
};
use samples::{START, joint, operating_state, state_command};
use tempfile::TempDir;

/// `ms` milliseconds after the start.
fn at(ms: i64) -> Time {
    START.plus_nanos(ms * 1_000_000)
}

/// A bus over a recording made by `record`.
fn recorded(record: impl FnOnce(&McapBus)) -> (TempDir, McapBus) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    let bus = McapBus::create(&path).unwrap();
    record(&bus);
    bus.finish().unwrap().unwrap();
    let bus = McapBus::open(&path).unwrap();
    (directory, bus)
}

/// Joints at 10, 20, … ms, numbered from 1.
fn joints(count: i64) -> (TempDir, McapBus) {
    recorded(|bus| {
        let mut publisher = bus.publisher(FOLLOWER_MEASURED_JS).unwrap();
        for k in 1..=count {
            publisher
                .publish(at(10 * k), &joint(k as f64, at(10 * k)))
                .unwrap();
        }
    })
}

/// The number of a message of [`joints`].
fn number(message: &JointSample) -> f64 {
    message.position[0] - 0.25
}

#[test]
fn a_message_is_visible_strictly_after_its_time() {
    let (_directory, bus) = joints(3);
    let mut subscriber = bus.subscriber(FOLLOWER_MEASURED_JS, Depth::Newest).unwrap();
    assert_eq!(subscriber.newest(at(10)), None);
    let received = subscriber.newest(at(10).plus_nanos(1)).unwrap();
    assert_eq!(number(&received.message), 1.0);
    assert_eq!((received.received, received.source), (at(10), 0));
    assert_eq!(received.message.stamp, at(10));
    assert_eq!(subscriber.newest(at(20)), None);
    assert_eq!(subscriber.counts().delivered, 1);
}

#[test]
fn the_newest_wins_and_what_it_replaces_is_not_counted() {
    let (_directory, bus) = joints(100);
    let mut newest = bus.subscriber(FOLLOWER_MEASURED_JS, Depth::Newest).unwrap();
    assert_eq!(number(&newest.newest(at(505)).unwrap().message), 50.0);
    assert_eq!(newest.newest(at(505)), None);
    assert_eq!(number(&newest.next(at(705)).unwrap().message), 70.0);
    assert_eq!(newest.next(at(705)), None);
    assert_eq!(
        (newest.counts().delivered, newest.counts().overflowed),
        (2, 0)
    );
}

#[test]
fn a_queue_keeps_its_depth_and_counts_what_overflows() {
    let (_directory, bus) = joints(100);
    let mut queue = bus
        .subscriber(FOLLOWER_MEASURED_JS, Depth::Queue(4))
        .unwrap();
    let taken: Vec<f64> = std::iter::from_fn(|| queue.next(at(105)))
        .map(|received| number(&received.message))
        .collect();
    assert_eq!(taken, [7.0, 8.0, 9.0, 10.0]);
    assert_eq!(
        (queue.counts().delivered, queue.counts().overflowed),
        (4, 6)
    );
}

#[test]
fn a_late_joiner_gets_the_last_state_and_the_next_of_all_else() {
    let (_directory, bus) = recorded(|bus| {
        let mut joints = bus.publisher(FOLLOWER_MEASURED_JS).unwrap();
        let mut states = bus.publisher(FOLLOWER_OPERATING_STATE).unwrap();
        let mut commands = bus.publisher(FOLLOWER_STATE_COMMAND).unwrap();
        for k in 1..=4_u32 {
            let now = at(i64::from(k) * 10);
            joints.publish(now, &joint(f64::from(k), now)).unwrap();
            states.publish(now, &operating_state(k, now)).unwrap();
            commands.publish(now, &state_command(k, now)).unwrap();
        }
    });
    let mut early = bus.subscriber(FOLLOWER_MEASURED_JS, Depth::Newest).unwrap();
    early.newest(at(25)).unwrap();

    let mut late = bus
        .subscriber(FOLLOWER_MEASURED_JS, Depth::Queue(8))
        .unwrap();
    let mut state = bus
        .subscriber(FOLLOWER_OPERATING_STATE, Depth::Newest)
        .unwrap();
    let mut command = bus
        .subscriber(FOLLOWER_STATE_COMMAND, Depth::Queue(8))
        .unwrap();
    assert_eq!(late.next(at(26)), None);
    assert_eq!(command.next(at(26)), None);
    assert_eq!(state.newest(at(26)).unwrap().received, at(20));
    assert_eq!(state.newest(at(26)), None);
    assert_eq!(late.next(at(41)).unwrap().received, at(30));
    assert_eq!(command.next(at(41)).unwrap().received, at(30));
    assert_eq!(state.next(at(41)).unwrap().received, at(40));
}

#[test]
fn a_publisher_that_comes_back_continues_the_topic() {
    let (_directory, bus) = recorded(|bus| {
        for k in 1..=3 {
            let mut publisher = bus.publisher(FOLLOWER_MEASURED_JS).unwrap();
            publisher
                .publish(at(10 * k), &joint(k as f64, at(10 * k)))
                .unwrap();
        }
    });
    let mut queue = bus
        .subscriber(FOLLOWER_MEASURED_JS, Depth::Queue(8))
        .unwrap();
    let taken: Vec<f64> = std::iter::from_fn(|| queue.next(at(100)))
        .map(|received| number(&received.message))
        .collect();
    assert_eq!(taken, [1.0, 2.0, 3.0]);
    let topics = info(bus.reader().unwrap().path()).unwrap().topics;
    assert_eq!(topics.len(), 1);
    let numbers: Vec<u32> = bus
        .reader()
        .unwrap()
        .raw()
        .map(|message| message.unwrap().sequence)
        .collect();
    assert_eq!(numbers, [0, 1, 2]);
}

#[test]
fn the_wrong_type_side_and_depth_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    let poses = Topic::<PoseSample>::new(FOLLOWER_MEASURED_JS.name, Delivery::Stream);
    let writing = McapBus::create(&path).unwrap();
    let mut publisher = writing.publisher(FOLLOWER_MEASURED_JS).unwrap();
    let error = writing.publisher(poses).unwrap_err();
    assert!(matches!(error, CreateError::WrongType { .. }), "{error}");
    let error = writing
        .subscriber(FOLLOWER_MEASURED_JS, Depth::Newest)
        .unwrap_err();
    assert!(matches!(error, CreateError::Recording { .. }), "{error}");
    publisher.publish(at(1), &joint(1.0, at(1))).unwrap();
    assert_eq!(writing.finish().unwrap().unwrap().messages, 1);
    assert_eq!(writing.finish().unwrap(), None);
    let error = publisher.publish(at(2), &joint(2.0, at(2))).unwrap_err();
    assert!(matches!(error, PublishError::Recording { .. }), "{error}");
    assert!(writing.publisher(FOLLOWER_MEASURED_JS).is_err());

    let reading = McapBus::open(&path).unwrap();
    let error = reading.publisher(FOLLOWER_MEASURED_JS).unwrap_err();
    assert!(matches!(error, CreateError::Recording { .. }), "{error}");
    let error = reading.subscriber(poses, Depth::Newest).unwrap_err();
    assert!(matches!(error, CreateError::WrongType { .. }), "{error}");
    let error = reading
        .subscriber(FOLLOWER_OPERATING_STATE, Depth::Newest)
        .unwrap_err();
    assert!(
        error.to_string().contains("/follower/measured_js"),
        "{error}"
    );
    for depth in [0, usize::MAX] {
        let error = reading
            .subscriber(FOLLOWER_MEASURED_JS, Depth::Queue(depth))
            .unwrap_err();
        assert!(matches!(error, CreateError::BadDepth { .. }), "{error}");
    }
    assert_eq!(reading.finish().unwrap(), None);
}

#[test]
fn invalid_messages_are_recorded_counted_and_not_handed_out() {
    let (_directory, bus) = recorded(|bus| {
        let mut publisher = bus.publisher(FOLLOWER_MEASURED_JS).unwrap();
        let mut bad = joint(1.0, at(10));
        bad.velocity[1] = f64::NAN;
        publisher.publish(at(10), &bad).unwrap();
        publisher.publish(at(20), &joint(2.0, at(20))).unwrap();
        publisher
            .publish(at(30), &joint(3.0, Time::INVALID))
            .unwrap();
    });
    let mut queue = bus
        .subscriber(FOLLOWER_MEASURED_JS, Depth::Queue(8))
        .unwrap();
    assert_eq!(number(&queue.next(at(100)).unwrap().message), 2.0);
    assert_eq!(queue.next(at(100)), None);
    let counts = queue.counts();
    assert_eq!(
        (counts.delivered, counts.invalid, counts.refused()),
        (1, 2, 2)
    );
    let reader = bus.reader().unwrap();
    let read = reader
        .messages::<JointSample>("/follower/measured_js")
        .unwrap();
    assert_eq!(read.filter(Result::is_err).count(), 2);
}

#[test]
fn subscribers_of_one_recording_do_not_disturb_each_other() {
    let (_directory, bus) = joints(3000);
    let mut ticks = bus.subscriber(FOLLOWER_MEASURED_JS, Depth::Newest).unwrap();
    let mut queue = bus
        .subscriber(FOLLOWER_MEASURED_JS, Depth::Queue(3000))
        .unwrap();
    let other = std::thread::spawn(move || {
        let numbers = std::iter::from_fn(|| queue.next(at(1_000_000)));
        numbers
            .map(|received| number(&received.message))
            .collect::<Vec<f64>>()
    });
    let mut expected = 0.0;
    for ms in 1..=30_001 {
        if let Some(received) = ticks.newest(at(ms)) {
            expected += 1.0;
            assert_eq!(number(&received.message), expected);
        }
    }
    assert_eq!(expected, 3000.0);
    let all: Vec<f64> = (1..=3000).map(f64::from).collect();
    assert_eq!(other.join().unwrap(), all);
}

//! Recordings that are broken.

use std::{fs, path::Path};

use ferntast_bus::{Bus, Depth, McapBus};
use ferntast_msgs::{
    Message, Time,
    sample::JointSample,
    topics::{Delivery, Topic},
};

use crate::world::{World, sample};

/// A recording with bytes changed at will: refused or read as far as it goes, never a panic.
pub fn garbage(world: &World) {
    let directory = tempfile::tempdir().unwrap();
    let bag = directory.path().join("bag");
    let writer = McapBus::create(&bag).unwrap();
    let topic = world.topic("garbage", Delivery::Event);
    let mut publisher = writer.publisher(topic).unwrap();
    for number in 0..50 {
        publisher.publish(world.tick(), &sample(number)).unwrap();
    }
    writer.finish().unwrap();
    let file = fs::read_dir(&bag)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|kind| kind == "mcap"))
        .unwrap();
    let good = fs::read(&file).unwrap();
    assert_eq!(
        read_all(&file, topic),
        (0..50).map(sample).collect::<Vec<_>>()
    );

    let broken = directory.path().join("broken.mcap");
    for at in (0..good.len()).step_by(7) {
        let mut bytes = good.clone();
        bytes[at] ^= 0xff;
        fs::write(&broken, &bytes).unwrap();
        for message in read_all(&broken, topic) {
            assert_eq!(message.check(), Ok(()));
        }
        fs::write(&broken, &good[..at]).unwrap();
        let cut = read_all(&broken, topic);
        assert!(cut.len() <= 50);
    }
    fs::write(&broken, vec![0xff; 100_000]).unwrap();
    assert_eq!(read_all(&broken, topic), []);
}

fn read_all(file: &Path, topic: Topic<JointSample>) -> Vec<JointSample> {
    let Ok(bus) = McapBus::open(file) else {
        return Vec::new();
    };
    let Ok(mut subscriber) = Bus::Mcap(bus).subscriber(topic, Depth::Queue(100)) else {
        return Vec::new();
    };
    let end = Time::from_nanos(i64::MAX);
    std::iter::from_fn(|| subscriber.next(end))
        .map(|received| received.message)
        .collect()
}

//! Sessions in shared memory: who is in one, and what stays behind.

use std::fs;

use ferntast_bus::{CleanUpError, CreateError, Depth, SharedMemoryBus};
use ferntast_msgs::{sample::JointSample, topics::Delivery};

use crate::world::{Way, World, sample};

/// Files of the session, in shared memory and in its directory.
fn left_behind(session: &str) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir("/dev/shm")
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with(&format!("ferntast.{session}.")))
        .collect();
    let directory = format!("/dev/shm/ferntast.{session}");
    if fs::exists(&directory).unwrap() {
        names.push(directory);
    }
    names
}

#[test]
fn a_session_in_use_is_named_and_left_alone() {
    let world = World::new(Way::SharedMemory);
    assert_eq!(SharedMemoryBus::processes(&world.name), Ok(vec![]));
    let bus = world.participant();
    let this = std::process::id();
    assert_eq!(SharedMemoryBus::processes(&world.name), Ok(vec![this]));
    assert!(SharedMemoryBus::sessions().contains(&world.name));
    let error = SharedMemoryBus::clean_up(&world.name).unwrap_err();
    assert_eq!(
        error,
        CleanUpError::InUse {
            session: world.name.clone(),
            processes: vec![this],
        }
    );
    assert!(error.to_string().contains(&this.to_string()), "{error}");

    let topic = world.topic::<JointSample>("stream", Delivery::Stream);
    let mut reader = world.reader(topic, Depth::Newest).unwrap();
    let mut publisher = bus.publisher(topic).unwrap();
    publisher.publish(world.tick(), &sample(1)).unwrap();
    assert_eq!(reader.next().unwrap().message, sample(1), "still works");

    drop((bus, publisher, reader));
    assert_eq!(SharedMemoryBus::processes(&world.name), Ok(vec![]));
    SharedMemoryBus::clean_up(&world.name).unwrap();
    assert_eq!(left_behind(&world.name), Vec::<String>::new());
    assert_eq!(
        SharedMemoryBus::clean_up(&world.name),
        Ok(0),
        "nothing twice"
    );
}

#[test]
fn two_sessions_do_not_meet() {
    let (one, other) = (World::new(Way::SharedMemory), World::new(Way::SharedMemory));
    let topic = one.topic::<JointSample>("stream", Delivery::Stream);
    let mut elsewhere = other.reader(topic, Depth::Newest).unwrap();
    let mut publisher = one.participant().publisher(topic).unwrap();
    publisher.publish(one.tick(), &sample(1)).unwrap();
    assert!(elsewhere.is_quiet());
}

#[test]
fn sixteen_publishers_find_a_place_and_the_next_is_told() {
    let world = World::new(Way::SharedMemory);
    let bus = world.participant();
    let topic = world.topic::<JointSample>("diagnostics", Delivery::Event);
    let mut reader = world.reader(topic, Depth::Queue(64)).unwrap();
    let mut publishers: Vec<_> = (0..16).map(|_| bus.publisher(topic).unwrap()).collect();
    for (publisher, number) in publishers.iter_mut().zip(0..) {
        publisher.publish(world.tick(), &sample(number)).unwrap();
    }
    let mut numbers: Vec<f64> = (0..16)
        .map(|_| reader.next().unwrap().message.position[0])
        .collect();
    numbers.sort_by(f64::total_cmp);
    assert_eq!(numbers, (0..16).map(f64::from).collect::<Vec<_>>());
    let error = bus.publisher(topic).unwrap_err();
    assert!(
        matches!(error, CreateError::TooMany { limit: 16, .. }),
        "{error:?}"
    );
}

//! A publisher over DDS goes on, however soon after its creation it sends much.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    process, thread,
    time::{Duration, Instant},
};

use ferntast_bus::{Bus, DdsBus, DdsConfig};
use ferntast_msgs::{
    Text, Time,
    sample::{OperatingState, OperatingStateSample},
    topics::{Delivery, Topic, TopicName},
};

/// How long a publisher may be refused, where it takes 0.1 s on a busy machine.
const PATIENCE: Duration = Duration::from_secs(10);

/// Creates publishers, each of which sends more at once than may wait; says how many were
/// refused for good.
fn refused_for_good(domain_id: u32, participant: usize) -> usize {
    let bus = Bus::Dds(
        DdsBus::open(&DdsConfig {
            domain_id,
            node_name: format!("new_writers_{participant}"),
            namespace: "/".to_owned(),
        })
        .unwrap(),
    );
    let sends_all = |number: usize| {
        let name = format!("/new_{}_{participant}_{number}/state", process::id());
        let name = TopicName::new(&name).unwrap();
        let mut publisher = bus
            .publisher(Topic::<OperatingStateSample>::new(name, Delivery::State))
            .unwrap();
        let begin = Instant::now();
        (0..100).all(|k| {
            let stamp = Time::from_nanos(1_000_000_000 + k);
            let state = OperatingStateSample {
                stamp,
                state: OperatingState::ENABLED,
                is_homed: 1,
                is_busy: 0,
                reserved: [0; 5],
                reason: Text::EMPTY,
            };
            while publisher.publish(stamp, &state).is_err() {
                if begin.elapsed() > PATIENCE {
                    return false;
                }
                thread::sleep(Duration::from_millis(1));
            }
            true
        })
    };
    (0..250).filter(|&number| !sends_all(number)).count()
}

/// Participants that find each other's topics keep the loop of RustDDS busy, so that some of
/// a thousand writers are told of before it has taken them up.
#[test]
fn what_a_new_publisher_sends_at_once_is_taken() {
    let domain_id = 1 + process::id() % 100;
    let participants: Vec<_> = (0..4)
        .map(|participant| thread::spawn(move || refused_for_good(domain_id, participant)))
        .collect();
    let refused: usize = participants.into_iter().map(|p| p.join().unwrap()).sum();
    assert_eq!(refused, 0, "of 1000 publishers were refused for good");
}

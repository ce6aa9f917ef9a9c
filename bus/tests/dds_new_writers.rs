//! A publisher over DDS goes on, however soon after its creation it sends much.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod dds_states;

use std::{process, thread};

use dds_states::publish;
use ferntast_bus::{Bus, DdsBus, DdsConfig};
use ferntast_msgs::{
    sample::OperatingStateSample,
    topics::{Delivery, Topic, TopicName},
};

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
        (0..100).all(|k| publish(&mut publisher, k).is_ok())
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

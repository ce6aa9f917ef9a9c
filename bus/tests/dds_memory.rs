//! A DDS bus that nobody listens to stays as large as it is.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod dds_states;

use std::{fs, process, thread, time::Duration};

use dds_states::publish;
use ferntast_bus::{Bus, DdsBus, DdsConfig};
use ferntast_msgs::{
    sample::OperatingStateSample,
    topics::{Delivery, Topic, TopicName},
};

/// Memory of this process that is its own \[bytes\].
fn anonymous_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("RssAnon:"));
    let size = line.and_then(|line| line.split_whitespace().nth(1)?.parse().ok());
    size.map(|kibibytes: u64| kibibytes << 10).unwrap()
}

#[test]
fn states_that_nobody_reads_take_no_memory() {
    let bus = Bus::Dds(
        DdsBus::open(&DdsConfig {
            domain_id: 1 + process::id() % 100,
            node_name: "memory".to_owned(),
            namespace: "/".to_owned(),
        })
        .unwrap(),
    );
    let name = format!("/memory_{}/state", process::id());
    let name = TopicName::new(&name).unwrap();
    let topic = Topic::<OperatingStateSample>::new(name, Delivery::State);
    let mut publisher = bus.publisher(topic).unwrap();
    // RustDDS looks after its history every six seconds, and what it gave back by
    // then is used again.
    let mut burst = |number: i64| {
        for k in 2_500 * number..2_500 * (number + 1) {
            publish(&mut publisher, k).unwrap();
        }
        thread::sleep(Duration::from_secs(7));
        anonymous_memory()
    };
    let before = burst(0);
    burst(1);
    let growth = burst(2).saturating_sub(before);
    assert!(growth < 400 << 10, "{growth} bytes more");
}

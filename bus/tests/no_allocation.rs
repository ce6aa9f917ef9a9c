//! What the ways that control loops use allocate once they run.

#![allow(missing_docs)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../../tests/shared/allocations.rs"]
mod allocations;

use std::process;

use allocations::allocations;

use ferntast_bus::{Bus, Depth, MemoryBus, SharedMemoryBus, SharedMemoryConfig, frames};
use ferntast_msgs::{
    Time,
    sample::{HealthSample, JointNames, JointSample},
    topics::{DIAGNOSTICS, FOLLOWER_MEASURED_JS},
};

#[test]
fn the_counter_counts() {
    let ((), counted) = allocations(|| drop(std::hint::black_box(vec![1])));
    assert!(counted >= 1);
}

const TICKS: i64 = 4_000;

/// What `TICKS` times publishing and reading two topics allocates: `(publishing, reading)`.
fn run(bus: &Bus) -> (u64, u64) {
    let mut joints = bus.publisher(FOLLOWER_MEASURED_JS).unwrap();
    let mut newest = bus.subscriber(FOLLOWER_MEASURED_JS, Depth::Newest).unwrap();
    let mut queue = bus
        .subscriber(FOLLOWER_MEASURED_JS, Depth::Queue(100))
        .unwrap();
    let mut health = bus.publisher(DIAGNOSTICS).unwrap();
    let mut events = bus.subscriber(DIAGNOSTICS, Depth::Queue(64)).unwrap();
    // SAFETY: every bit pattern of a message is a value.
    let mut state: HealthSample = unsafe { std::mem::zeroed() };
    let (mut publishing, mut reading, mut delivered) = (0, 0, 0);
    let warm_up = 1_000;
    for tick in 1..=warm_up + TICKS {
        let now = Time::from_nanos(tick * 1_000_000);
        state.stamp = now;
        let ((), published) = allocations(|| {
            joints
                .publish(now, &JointSample::zero(JointNames::numbered(2), now))
                .unwrap();
            health.publish(now, &state).unwrap();
        });
        let later = now.plus_nanos(1);
        let ((), read) = allocations(|| {
            delivered += i32::from(newest.newest(later).is_some());
            // Now and then, so that it runs full.
            if tick % 300 == 0 {
                while queue.next(later).is_some() {}
                while events.next(later).is_some() {}
            }
        });
        if tick > warm_up {
            publishing += published;
            reading += read;
        }
    }
    assert_eq!(i64::from(delivered), warm_up + TICKS);
    (publishing, reading)
}

#[test]
fn memory_does_not_allocate() {
    assert_eq!(run(&Bus::Memory(MemoryBus::new())), (0, 0));
}

/// iceoryx2 0.10 allocates a small block for each message that is loaned; no
/// more than that.
#[test]
fn shared_memory_allocates_one_block_a_message_and_none_to_read() {
    let session = format!("no_allocation_{}", process::id());
    let bus = SharedMemoryBus::open(&SharedMemoryConfig {
        session: session.clone(),
    })
    .unwrap();
    let bus = Bus::SharedMemory(bus);
    let (publishing, reading) = run(&bus);
    drop(bus);
    SharedMemoryBus::clean_up(&session).unwrap();
    assert!(publishing <= 2 * TICKS as u64, "{publishing}");
    assert_eq!(reading, 0);
}

#[test]
fn frames_in_memory_do_not_allocate() {
    let (mut sender, mut receiver) = frames::memory();
    let mut buffer = [0; frames::MAX_FRAME];
    let ((), count) = allocations(|| {
        for tick in 1..5_000 {
            sender.send(Time::from_nanos(tick), &[7; 64]).unwrap();
            if tick % 3 == 0 {
                receiver.receive(Time::from_nanos(tick), &mut buffer);
            }
        }
    });
    assert_eq!(count, 0);
    assert!(receiver.dropped() > 0, "it ran full");
}

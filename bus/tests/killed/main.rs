//! A publisher killed with SIGKILL leaves nothing that its successor, its
//! readers or the next session stumble over.
//!
//! This test is a program of its own (no test harness): it starts itself
//! again as the publisher that is killed.

#![allow(missing_docs)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    env,
    process::{self, Child, Command},
    thread,
    time::{Duration, Instant},
};

use ferntast_bus::{Depth, SharedMemoryBus, SharedMemoryConfig};
use ferntast_msgs::{
    Time,
    sample::{JointNames, JointSample},
    topics::{Delivery, Topic, TopicName},
};

const STREAM: Topic<JointSample> =
    Topic::new(TopicName::constant("/killed/stream"), Delivery::Stream);
const STATE: Topic<JointSample> = Topic::new(TopicName::constant("/killed/state"), Delivery::State);
const PATIENCE: Duration = Duration::from_secs(10);

/// The tests, as the harness that this file goes without would run them.
const TESTS: [(&str, fn()); 2] = [
    (
        "a_killed_publisher_is_replaced",
        a_killed_publisher_is_replaced,
    ),
    (
        "a_killed_session_is_cleaned_up",
        a_killed_session_is_cleaned_up,
    ),
];

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("publish") => publish(&arguments[1], arguments[2].parse().unwrap()),
        Some("--list") => TESTS.iter().for_each(|(name, _)| println!("{name}: test")),
        _ => run(&wanted(&arguments)),
    }
}

/// Tests whose names contain one of the arguments, of all if there is none, and
/// nothing that is to be skipped.
fn wanted(arguments: &[String]) -> Vec<(&'static str, fn())> {
    let (mut names, mut skipped) = (Vec::new(), Vec::new());
    let mut each = arguments.iter();
    while let Some(argument) = each.next() {
        match argument.as_str() {
            "--skip" => skipped.extend(each.next()),
            "--test-threads" => drop(each.next()),
            option if option.starts_with("--") => {}
            _ => names.push(argument),
        }
    }
    let holds = |list: &[&String], name: &str| list.iter().any(|own| name.contains(own.as_str()));
    let mut tests = TESTS.to_vec();
    tests.retain(|(name, _)| (names.is_empty() || holds(&names, name)) && !holds(&skipped, name));
    tests
}

/// A test that fails panics, and says no result.
fn run(tests: &[(&'static str, fn())]) {
    let begun = Instant::now();
    for (name, test) in tests {
        test();
        println!("test {name} ... ok");
    }
    println!(
        "test result: ok. {} passed; 0 failed; 0 ignored; 0 measured; {} filtered out; finished in {:.2}s",
        tests.len(),
        TESTS.len() - tests.len(),
        begun.elapsed().as_secs_f64()
    );
}

fn join(session: &str) -> SharedMemoryBus {
    SharedMemoryBus::open(&SharedMemoryConfig {
        session: session.into(),
    })
    .unwrap()
}

/// The child: publishes its life's number at 1 kHz until it is killed.
fn publish(session: &str, life: f64) {
    let bus = join(session);
    let mut stream = bus.publisher(STREAM).unwrap();
    let mut state = bus.publisher(STATE).unwrap();
    let stamp = Time::from_nanos(1);
    let sample = JointSample::zero(JointNames::numbered(2), stamp).with_position([life; 2]);
    state.publish(stamp, &sample).unwrap();
    loop {
        stream.publish(stamp, &sample).unwrap();
        thread::sleep(Duration::from_millis(1));
    }
}

fn start(session: &str, life: u32) -> Child {
    Command::new(env::current_exe().unwrap())
        .args(["publish", session, &life.to_string()])
        .spawn()
        .unwrap()
}

fn kill(mut child: Child) {
    child.kill().unwrap();
    child.wait().unwrap();
}

fn wait_for(what: &str, mut found: impl FnMut() -> bool) {
    let start = Instant::now();
    while !found() {
        assert!(start.elapsed() < PATIENCE, "waited in vain for {what}");
        thread::sleep(Duration::from_millis(1));
    }
}

fn a_killed_publisher_is_replaced() {
    let session = format!("killed_{}_a", process::id());
    let bus = join(&session);
    let now = Time::from_nanos(2);
    let mut stream = bus.subscriber(STREAM, Depth::Newest).unwrap();
    // More lives than a topic has places for publishers: each dead one's must come free.
    for life in 1..=20 {
        let child = start(&session, life);
        let value = f64::from(life);
        wait_for("the stream of a new publisher", || {
            stream
                .newest(now)
                .is_some_and(|received| received.message.position[0] == value)
        });
        let mut late = bus.subscriber(STATE, Depth::Newest).unwrap();
        let mut newest = 0.0;
        wait_for("the last state, for a late joiner", || {
            if let Some(received) = late.newest(now) {
                newest = received.message.position[0];
            }
            newest == value
        });
        kill(child);
    }
    drop((stream, bus));
    SharedMemoryBus::clean_up(&session).unwrap();
}

fn a_killed_session_is_cleaned_up() {
    let session = format!("killed_{}_b", process::id());
    let child = start(&session, 1);
    wait_for("the child in the session", || {
        SharedMemoryBus::processes(&session) == Ok(vec![child.id()])
    });
    assert!(SharedMemoryBus::clean_up(&session).is_err(), "it is in use");
    kill(child);
    assert_eq!(SharedMemoryBus::processes(&session), Ok(vec![]));
    let removed = SharedMemoryBus::clean_up(&session).unwrap();
    assert!(removed > 0, "a killed process leaves something");
    assert_eq!(SharedMemoryBus::clean_up(&session), Ok(0));
    let prefix = format!("ferntast.{session}.");
    let left = std::fs::read_dir("/dev/shm")
        .unwrap()
        .filter(|entry| {
            let name = entry.as_ref().unwrap().file_name();
            name.to_string_lossy().starts_with(&prefix)
        })
        .count();
    assert_eq!(left, 0);
    assert!(!std::fs::exists(format!("/dev/shm/ferntast.{session}")).unwrap());
}

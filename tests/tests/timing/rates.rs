//! Stock ROS 2 clients get the streams at their rate.

use ferntast_tests::{
    Machine, PATIENCE, Process, Session, Window, await_enabled, now, number, start,
};
use serde_json::{Value, json};

/// At which the gateway publishes joint states \[Hz\].
const RATE: f64 = 250.0;

/// What `peer` counted in 6 s of a session with these arguments.
fn counted(machine: &Machine, arguments: &[&str], peer: impl Fn(&Session) -> Process) -> Value {
    let session = Session::new();
    let mut process = start(&session, arguments);
    await_enabled(&session, &mut process);
    let from = now();
    let counted = peer(&session).wait(PATIENCE).success().json();
    let stalled = machine.stalled(Window { from, to: now() });
    process.interrupt();
    process.wait(PATIENCE).success();
    // The stamps of the first and the last say for how long.
    let rate = number(&counted, "stamp_rate_hz");
    let least = 0.95 * RATE * (1.0 - stalled / 6.0);
    assert!(
        (least..=1.01 * RATE).contains(&rate),
        "the machine stalled for {stalled} s, {counted:#}"
    );
    assert!(
        number(&counted, "received") > 6.0 * least,
        "the machine stalled for {stalled} s, {counted:#}"
    );
    if let Some(key) = counted["keys"][0].as_str() {
        let domain = session.domain();
        assert!(key.starts_with(&format!("{domain}/follower/measured_js/")));
    }
    counted
}

const WHAT: [&str; 5] = [
    "/follower/measured_js",
    "sensor_msgs/msg/JointState",
    "--seconds",
    "6",
    "--from-first",
];

#[test]
fn rclpy_receives_the_joint_states_at_their_rate() {
    let machine = Machine::alone();
    let counted = counted(&machine, &[], |session| {
        Process::spawn(session.peer("count_messages.py", &WHAT))
    });
    assert_eq!(number(&counted, "zero_stamps"), 0.0);
    assert_eq!(number(&counted, "stamps_back"), 0.0);
    assert_eq!(counted["last"]["name"], json!(["joint_1", "joint_2"]));
}

#[test]
fn a_zenoh_peer_receives_the_joint_states_at_their_rate() {
    let machine = Machine::alone();
    let counted = counted(&machine, &["--middleware", "zenoh"], |session| {
        let router = session.router_endpoint();
        let arguments = [&["--router", &router, "count"], &WHAT[..]].concat();
        Process::spawn(session.peer("zenoh_peer.py", &arguments))
    });
    assert_eq!(counted["broken"], json!([]));
    // It subscribed by its own hash; the key that it got carries the same.
    let key = counted["keys"][0].as_str().expect("a key");
    let hash = counted["type_hash"].as_str().expect("a hash");
    assert!(key.ends_with(hash), "{key}");
}

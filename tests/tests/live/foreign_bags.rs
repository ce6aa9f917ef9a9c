//! Recordings of other people, played onto ROS 2 as they are.

use ferntast_tests::{PATIENCE, Process, Session, number, run};
use serde_json::{Value, json};

/// Has a recording written by `by` at `path`; gives what is in it.
fn written(session: &Session, by: &str, path: &str) -> Value {
    let peer = session.peer("foreign_bag.py", &[by, path]);
    Process::spawn(peer).wait(PATIENCE).success().json()
}

fn play(session: &Session, path: &str, arguments: &[&str]) -> Process {
    let mut command = session.ferntast(&["play", path, "--json", "--session", session.name()]);
    command.args(arguments);
    Process::spawn(command)
}

/// A stock client that stops once it has heard something `topic`; reliable, and late where
/// `kept` says so.
fn listener(session: &Session, topic: &str, kind: &str, kept: bool, at_least: &str) -> Process {
    let qos = if kept { "state" } else { "event" };
    let arguments = [
        topic,
        kind,
        "--qos",
        qos,
        "--seconds",
        "60",
        "--at-least",
        at_least,
    ];
    Process::spawn(session.peer("count_messages.py", &arguments))
}

#[test]
fn a_foreign_bag_is_heard_by_a_stock_client_byte_for_byte() {
    let session = Session::new();
    let topics = written(&session, "rosbags", "foreign");
    let heard = [
        "/imu/data",
        "/robot/joint_states",
        "/camera/image",
        "/follower/measured_js",
    ];
    let mut listeners = Vec::new();
    for topic in heard {
        let kind = topics[topic]["type"].as_str().expect("a type");
        let mut own = listener(&session, topic, kind, false, "5");
        own.await_stderr("ready", PATIENCE);
        listeners.push((topic, own));
    }
    let player = play(&session, "foreign", &["--loop"]);
    for (topic, own) in listeners {
        let told = own.wait(PATIENCE).success().json();
        assert!(number(&told, "received") >= 5.0, "{topic}: {told:#}");
        assert_eq!(told["last"], topics[topic]["message"], "{topic}");
    }
    player.interrupt();
    let played = player.wait(PATIENCE).success().json();
    let as_recorded = played["as_recorded"].as_array().expect("topics");
    let mut names: Vec<&str> = as_recorded.iter().filter_map(Value::as_str).collect();
    names.sort_unstable();
    let expected = [
        "/camera/image",
        "/follower/measured_js",
        "/imu/data",
        "/robot/joint_states",
        "/tf",
        "/tf_static",
    ];
    assert_eq!(names, expected, "{played:#}");
    assert_eq!(played["left_out"], json!([]));
    assert_eq!(played["lost"], 0, "{played:#}");
}

#[test]
fn what_is_no_topic_of_ros_is_left_out_with_its_reason() {
    let session = Session::new();
    let topics = written(&session, "mcap", "foreign.mcap");
    let mut own = listener(&session, "/cmd_vel", "geometry_msgs/msg/Twist", false, "5");
    own.await_stderr("ready", PATIENCE);
    let player = play(&session, "foreign.mcap", &["--loop"]);
    let told = own.wait(PATIENCE).success().json();
    assert_eq!(told["last"], topics["/cmd_vel"]["message"]);
    player.interrupt();
    let played = player.wait(PATIENCE).success().json();
    assert_eq!(played["as_recorded"], json!(["/cmd_vel"]), "{played:#}");
    let left_out = &played["left_out"][0];
    assert_eq!(left_out["topic"], "/notes", "{played:#}");
    assert!(
        left_out["reason"]
            .as_str()
            .expect("a reason")
            .contains("json"),
        "{played:#}"
    );

    let words = run(
        &session,
        &["play", "foreign.mcap", "--session", session.name()],
    )
    .success()
    .stdout;
    assert!(
        words.contains("as recorded: /cmd_vel") && words.contains("left out: /notes"),
        "{words}"
    );
}

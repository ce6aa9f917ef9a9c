//! Those with tools of their own: Foxglove's WebSocket, the robot's description, transforms.

use ferntast_tests::{
    PATIENCE, Process, Session, await_armed, free_tcp_port, run, start, state_of_follower,
};

#[test]
fn foxglove_sees_every_topic_and_what_was_said_before_it_came() {
    let session = Session::new();
    let port = free_tcp_port();
    let foxglove = format!("--foxglove=127.0.0.1:{port}");
    let mut process = start(&session, &[&foxglove]);
    await_armed(&session, &mut process);
    let state = state_of_follower(&session);
    let url = format!("ws://127.0.0.1:{port}");
    let peer = session.peer("foxglove_peer.py", &[&url, "--seconds", "3"]);
    let seen = Process::spawn(peer).wait(PATIENCE).success().json();
    // It can watch, and nothing else.
    assert_eq!(seen["capabilities"], serde_json::json!([]));
    let topics = &seen["topics"];
    let interfaces = run(&session, &["interfaces", "--json"]).success().json();
    for topic in interfaces["topics"].as_array().expect("topics") {
        let name = topic["name"].as_str().expect("name");
        assert_eq!(topics[name]["type"], topic["type"], "{name}");
    }
    let count = |name: &str| topics[name]["count"].as_u64().unwrap_or_default();
    let rate = |name: &str| {
        let seconds = topics[name]["seconds"].as_f64().expect("a time");
        (count(name) - 1) as f64 / seconds
    };
    // 250 a second of the streams, 50 of the transforms, less what a slow peer misses.
    let joints = rate("/follower/measured_js");
    assert!((100.0..=255.0).contains(&joints), "{joints} Hz");
    let transforms = rate("/tf");
    assert!((20.0..=51.5).contains(&transforms), "{transforms} Hz");
    // Published once, long before.
    assert_eq!(count("/robot_description"), 1);
    assert_eq!(
        topics["/follower/operating_state"]["first"]["state"],
        state.as_str()
    );
    let position = &topics["/follower/measured_js"]["last"]["position"][1];
    assert!(position.as_f64().is_some_and(|q| (0.2..3.0).contains(&q)));
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn the_description_is_the_arm_that_moves() {
    let session = Session::new();
    let record = ["lockstep", "--duration", "3", "--record", "run"];
    run(&session, &record).success();
    let report = Process::spawn(session.peer("urdf_tip.py", &["run"]))
        .wait(PATIENCE)
        .success()
        .json();
    assert_eq!(report["joints"], serde_json::json!(["joint_1", "joint_2"]));
    let compared = report["compared"].as_u64().expect("a number");
    assert!((140..=151).contains(&compared), "{compared}");
    let difference = report["largest_difference_m"].as_f64().expect("a number");
    assert!(difference < 1e-9, "{difference} m");
}

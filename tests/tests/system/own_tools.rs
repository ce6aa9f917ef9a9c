//! Those with tools of their own: Foxglove's WebSocket, the robot's description, transforms.

use std::fs;

use ferntast_msgs::interface::{self, Base, Library};
use ferntast_tests::{Process, Session, free_tcp_port};

use crate::support::{PATIENCE, attempts, refused, run, start};

#[test]
fn foxglove_sees_every_topic_and_what_was_said_before_it_came() {
    attempts(|| {
        let session = Session::new();
        let port = free_tcp_port();
        let foxglove = format!("--foxglove=127.0.0.1:{port}");
        let mut process = start(&session, &["--duration", "8", &foxglove]);
        process.await_stderr("follower ENABLED", PATIENCE);
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
        // 250 a second of the streams, 50 of the transforms, less what it took to connect.
        let joints = count("/follower/measured_js");
        assert!((375..=760).contains(&joints), "{joints}");
        let transforms = count("/tf");
        assert!((75..=155).contains(&transforms), "{transforms}");
        // Published once, long before.
        assert_eq!(count("/robot_description"), 1);
        let state = &topics["/follower/operating_state"]["first"]["state"];
        assert_eq!(state, "ENABLED");
        let position = &topics["/follower/measured_js"]["last"]["position"][1];
        assert!(position.as_f64().is_some_and(|q| (0.2..3.0).contains(&q)));
        process.wait(PATIENCE).success();
    });
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

#[test]
fn foxglove_is_for_this_host_only() {
    let session = Session::new();
    refused(
        &session,
        &["session", "--foxglove=0.0.0.0:8765"],
        &["0.0.0.0:8765", "127.0.0.1:8765", "ssh -L"],
    );
}

/// Whether `field`, such as `pose.position.x`, stands in a message of `interface`.
fn has_field(library: &Library, interface: &str, fields: &[&str]) -> bool {
    let Some((first, rest)) = fields.split_first() else {
        return true;
    };
    let definition = library.definition(interface).expect("built in");
    let found = definition.fields.iter().find(|field| field.name == *first);
    found.is_some_and(|field| match &field.kind.base {
        Base::Interface(inner) => has_field(library, inner, rest),
        _ => rest.is_empty(),
    })
}

/// Whether a text in a layout is a topic, with or without a field: not the end of an XML element.
fn is_path(word: &str) -> bool {
    word.starts_with('/') && !word.contains(['<', '>'])
}

#[test]
fn the_layouts_show_what_there_is() {
    let session = Session::new();
    let interfaces = run(&session, &["interfaces", "--json"]).success().json();
    let library = interface::library().expect("built in");
    let folder = ferntast_tests::root().join("config/layouts");
    let mut shown = 0;
    for name in ["foxglove.json", "plotjuggler.xml"] {
        let text = fs::read_to_string(folder.join(name)).expect(name);
        for word in text.split('"').filter(|word| is_path(word)) {
            let topics = interfaces["topics"].as_array().expect("topics");
            let topic = topics.iter().find_map(|topic| {
                let rest = word.strip_prefix(topic["name"].as_str()?)?;
                let ends = rest.is_empty() || rest.starts_with(['.', '/']);
                ends.then(|| (topic["type"].as_str(), rest))
            });
            let (interface, rest) = topic.unwrap_or_else(|| panic!("{name}: no topic {word}"));
            let fields: Vec<&str> = rest.split(['.', '/']).filter(|f| !f.is_empty()).collect();
            let found = has_field(&library, interface.expect("a type"), &fields);
            assert!(found, "{name}: no field {word}");
            shown += 1;
        }
    }
    assert!(shown > 20, "{shown}");
}

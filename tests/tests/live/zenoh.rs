//! A peer over rmw_zenoh's protocol that matches on type hashes does what rclpy does.

use ferntast_msgs::topics;
use ferntast_tests::{
    PATIENCE, Process, Session, arm_state, await_enabled, hand_of_strokes, messages, number,
    operated, recording, run, start, state_of_follower, wait_until,
};

const MIDDLEWARE: [&str; 2] = ["--middleware", "zenoh"];

fn peer(session: &Session, arguments: &[&str]) -> Process {
    let router = session.router_endpoint();
    let arguments = [&["--router", router.as_str()], arguments].concat();
    Process::spawn(session.peer("zenoh_peer.py", &arguments))
}

/// Whether somebody listens at `tcp/HOST:PORT`.
fn listens(endpoint: &str) -> bool {
    std::net::TcpStream::connect(endpoint.trim_start_matches("tcp/")).is_ok()
}

#[test]
fn it_lists_every_topic_with_its_true_hash() {
    let session = Session::new();
    let mut process = start(&session, &[&MIDDLEWARE[..], &["--hand", "crtk"]].concat());
    await_enabled(&session, &mut process);
    let listed = peer(&session, &["list"]).wait(PATIENCE).success().json();
    let interfaces = run(&session, &["interfaces", "--json"]).success().json();
    for topic in interfaces["topics"].as_array().expect("topics") {
        let name = topic["name"].as_str().expect("name");
        let hash = interfaces["interfaces"]
            .as_array()
            .expect("interfaces")
            .iter()
            .find(|interface| interface["name"] == topic["type"])
            .map(|interface| &interface["hash"]);
        let seen = &listed["topics"][name];
        let ends: Vec<_> = [&seen["publishers"], &seen["subscriptions"]]
            .iter()
            .flat_map(|ends| ends.as_array().into_iter().flatten())
            .collect();
        assert!(!ends.is_empty(), "{name} is not there");
        for end in ends {
            assert_eq!(end["type"], topic["type"], "{name}");
            assert_eq!(Some(&end["type_hash"]), hash, "{name}");
        }
    }
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn it_drives_the_arm_and_feels_the_contour() {
    let session = Session::alone();
    let mut process = start(&session, &[&MIDDLEWARE[..], &["--hand", "crtk"]].concat());
    await_enabled(&session, &mut process);
    let file = &hand_of_strokes(&session);
    let arguments = [
        "operator",
        "--hand",
        file,
        "--duration",
        "15",
        "--until-felt",
        "50",
        "--arm-state",
        &arm_state(&session),
    ];
    let operator = peer(&session, &arguments);
    let sent = operated(&session, operator).success().json();
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    assert!(number(&sent["force"], "rate_hz") > 50.0, "{sent:#}");
    assert_eq!(number(&sent["force"], "not_finite"), 0.0);
    assert!(number(&sent["force"], "nonzero") >= 50.0, "{sent:#}");
    assert!(
        number(&summary, "contact.peak_normal_force_N") > 5.0,
        "{summary:#}"
    );
    assert!(recording(&session).is_dir());
}

/// Anybody may stop the arm; who may arm it, the scenario says.
#[test]
fn its_stop_is_obeyed_and_its_other_commands_where_they_are_allowed() {
    for (allowed, after) in [(false, "PAUSED"), (true, "ENABLED")] {
        let session = Session::new();
        let options: &[&str] = if allowed { &["--ros-commands"] } else { &[] };
        let mut process = start(&session, &[&MIDDLEWARE[..], options].concat());
        await_enabled(&session, &mut process);
        let command = |what| {
            let told = peer(&session, &["command", "/follower/state_command", what]);
            assert_eq!(told.wait(PATIENCE).success().json()["heard"], true);
        };
        command("pause");
        process.await_stderr("follower PAUSED", PATIENCE);
        command("resume");
        std::thread::sleep(std::time::Duration::from_secs(1));
        assert_eq!(state_of_follower(&session), after);
        let set = peer(&session, &["set_parameter", "/link", "law", "wave"]);
        let set = set.wait(PATIENCE).success().json();
        assert_eq!(set["successful"], allowed, "{set:#}");
        process.interrupt();
        process.wait(PATIENCE).success();
        let told = messages(&recording(&session), topics::DIAGNOSTICS);
        let told = told.iter().any(|own| {
            let words = own.message.message.as_str();
            own.message.node.as_str() == "gateway" && words.contains("commands = true")
        });
        assert_eq!(told, !allowed);
    }
}

#[test]
fn it_sets_the_law_as_a_parameter() {
    let session = Session::new();
    let mut process = start(
        &session,
        &[&MIDDLEWARE[..], &["--law", "wave", "--ros-commands"]].concat(),
    );
    await_enabled(&session, &mut process);
    let set = |value| {
        let told = peer(&session, &["set_parameter", "/link", "law", value]);
        told.wait(PATIENCE).success().json()
    };
    let told = set("tdpa");
    assert_eq!(told["before"], "wave", "{told:#}");
    assert_eq!(told["successful"], true, "{told:#}");
    assert_eq!(told["after"], "tdpa", "{told:#}");
    let told = set("nonsense");
    assert_eq!(told["successful"], false, "{told:#}");
    let reason = told["reason"].as_str().expect("a reason");
    assert!(reason.contains("tdpa"), "{told:#}");
    assert_eq!(told["after"], "tdpa", "{told:#}");
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn it_hears_a_recording_that_is_played() {
    let session = Session::new();
    let lockstep = ["lockstep", "--duration", "3", "--seed", "3"];
    run(&session, &[&lockstep[..], &["--record", "run"]].concat()).success();
    let mut command = session.ferntast(&["play", "run", "--loop", "--json"]);
    command.args(["--session", session.name()]).args(MIDDLEWARE);
    command.args(["--router-endpoint", &session.router_endpoint()]);
    let player = Process::spawn(command);
    assert!(
        wait_until(PATIENCE, || listens(&session.router_endpoint())),
        "no router"
    );
    let arguments = [
        "count",
        "/follower/measured_js",
        "sensor_msgs/msg/JointState",
        "--seconds",
        "60",
        "--at-least",
        "500",
    ];
    let heard = peer(&session, &arguments).wait(PATIENCE).success().json();
    player.interrupt();
    let played = player.wait(PATIENCE).success().json();
    assert_eq!(played["lost"], 0, "{played:#}");
    assert!(number(&heard, "received") >= 500.0, "{heard:#}");
    assert_eq!(heard["broken"], serde_json::json!([]), "{heard:#}");
    // What it heard last is in the recording, number by number.
    let stamp = &heard["last"]["header"]["stamp"];
    let part = |name: &str| stamp[name].as_i64().expect("a whole number");
    let stamp = part("sec") * 1_000_000_000 + part("nanosec");
    let recorded = messages(&recording(&session), topics::FOLLOWER_MEASURED_JS);
    let recorded = recorded
        .iter()
        .find(|own| own.message.stamp.nanos() == stamp)
        .unwrap_or_else(|| panic!("not recorded: {heard:#}"));
    for (key, numbers) in [
        ("position", recorded.message.position),
        ("velocity", recorded.message.velocity),
        ("effort", recorded.message.effort),
    ] {
        let told = heard["last"][key].as_array().expect("a list");
        assert_eq!(told.len(), 2, "{key}");
        for (told, number) in told.iter().zip(numbers) {
            // Of JSON the last bit may be read wrongly.
            let off = (told.as_f64().expect("a number") - number).abs();
            assert!(off <= f64::EPSILON * number.abs(), "{key}: {told} {number}");
        }
    }
}

//! The delay law is changed while a session runs, without a jump in force.

use std::{thread, time::Duration};

use ferntast_msgs::{Time, topics};
use ferntast_tests::{
    Machine, PATIENCE, Session, Window, await_enabled, force_steps, laws, now, recording, run,
    set_parameter, start, switches,
};
use serde_json::Value;

/// Longer than a change of laws takes.
const LED_OVER: Duration = Duration::from_millis(500);

fn switch(session: &Session, law: &str) -> Value {
    let arguments = ["link", "law", law, "--session", session.name(), "--json"];
    run(session, &arguments).success().json()
}

fn set_law(session: &Session, value: &str) -> Value {
    set_parameter(session, ["/link", "law", value])
}

#[test]
fn switched_from_the_command_line_and_as_a_ros_parameter() {
    let machine = Machine::alone();
    let session = Session::new();
    let mut process = start(
        &session,
        &["--law", "position_force", "--rtt", "100", "--ros-commands"],
    );
    await_enabled(&session, &mut process);
    let mut expected = vec!["position_force"];
    // There and back, until the machine let it.
    let (window, _) = machine.undisturbed(|| {
        let from = now();
        for law in ["model_mediated", "position_position", "position_force"] {
            switch(&session, law);
            expected.push(law);
            thread::sleep(LED_OVER);
        }
        let window = Window { from, to: now() };
        assert!(machine.is_quiet(window), "what a stall does to the force");
        window
    });
    let told = run(&session, &["link", "law", "--session", session.name()]).success();
    assert_eq!(told.stdout.trim(), "position_force");

    let set = set_law(&session, "position_position");
    assert_eq!(set["before"], "position_force", "{set:#}");
    assert_eq!(set["successful"], true, "{set:#}");
    assert_eq!(set["after"], "position_position", "{set:#}");
    expected.push("position_position");
    let listed = set["listed"].as_array().expect("a list");
    assert!(listed.iter().any(|name| name == "law"), "{set:#}");
    let set = set_law(&session, "nonsense");
    assert_eq!(set["successful"], false, "{set:#}");
    let reason = set["reason"].as_str().expect("a reason");
    assert!(reason.contains("wave"), "{set:#}");
    assert_eq!(set["after"], "position_position", "{set:#}");

    process.interrupt();
    process.wait(PATIENCE).success();
    let path = recording(&session);
    for topic in [topics::LINK_STATUS, topics::LINK_FOLLOWER_STATUS] {
        assert_eq!(laws(&path, topic), expected);
    }
    let switched = switches(&path);
    let during = |stamp: Time| {
        let mut since = switched.iter().map(|at| stamp.seconds_since(*at));
        window.contains(stamp) && since.any(|since| (-0.05..0.35).contains(&since))
    };
    let steps = force_steps(&path).into_iter();
    let during = steps
        .filter(|&(stamp, _)| during(stamp))
        .map(|(_, change)| change)
        .fold(0.0, f64::max);
    assert!(during < 0.5, "{during} N in a step");
}

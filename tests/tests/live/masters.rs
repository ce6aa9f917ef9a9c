//! Two hands: one holds the authority, the other is refused and told so.

use ferntast_msgs::{
    sample::{Fault, HealthSample},
    topics,
};
use ferntast_tests::{
    PATIENCE, Process, Session, await_enabled, hand_through, messages, number, recording, start,
};

/// A hand that goes slowly along x at a place of its own in y.
fn operator(session: &Session, name: &str, y: f64, seconds: &str) -> Process {
    let hand = &hand_through(session, name, &[(0.0, -0.02, y), (20.0, 0.02, y)]);
    let arguments = ["--hand", hand, "--duration", seconds];
    Process::spawn(session.peer("ros_operator.py", &arguments))
}

#[test]
fn the_first_holds_and_the_second_is_refused_and_told() {
    let session = Session::alone();
    let mut process = start(&session, &["--hand", "crtk"]);
    await_enabled(&session, &mut process);
    let mut first = operator(&session, "first.csv", 0.015, "40");
    first.await_stderr("ready", PATIENCE);
    std::thread::sleep(std::time::Duration::from_secs(1));
    let second = operator(&session, "second.csv", -0.015, "3");
    let second = second.wait(PATIENCE).success().json();
    assert!(number(&second, "sent") > 500.0);
    first.interrupt();
    first.wait(PATIENCE).success();
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    assert!(
        number(&summary, "leader.refused_masters") > 100.0,
        "{summary:#}"
    );

    let path = recording(&session);
    let authority = messages(&path, topics::LEADER_AUTHORITY);
    let contested = authority
        .iter()
        .find(|own| own.message.refused_count > 0)
        .expect("the refusal is published");
    let (holder, refused) = (contested.message.holder, contested.message.refused);
    assert!(
        holder != 0 && refused != 0 && holder != refused,
        "{contested:?}"
    );
    assert!(contested.message.reason.as_str().contains("refused"));
    // On /diagnostics too, which every ROS 2 client can read.
    let told = messages(&path, topics::DIAGNOSTICS).into_iter().any(|own| {
        let health: HealthSample = own.message;
        health.node.as_str() == "master" && health.faults.has(Fault::CommandUnauthorised)
    });
    assert!(told);
    // All that moved the arm came from one hand: what the master passed on is
    // what the holder sent, at the holder's rate.
    let passed = messages(&path, topics::LEADER_SETPOINT_CP);
    let jumps = passed
        .windows(2)
        .filter(|pair| {
            let [a, b] = [pair[0].message.position, pair[1].message.position];
            let step = ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt();
            step > 0.02
        })
        .count();
    assert_eq!(jumps, 0, "the second hand came through");
}

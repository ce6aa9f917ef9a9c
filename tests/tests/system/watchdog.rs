//! A silent master or link puts the arm into a hold, latched until it is re-armed.

use std::{thread, time::Duration};

use ferntast_bus::Received;
use ferntast_msgs::{
    sample::{OperatingState, OperatingStateSample},
    topics,
};
use ferntast_tests::{Process, Session, wait_until};

use crate::support::{
    PATIENCE, attempts, await_enabled, messages, node, recording, signal, start, state,
    state_of_follower,
};

/// Longest time from the last valid command to the hold \[s\].
const HOLD_WITHIN: f64 = 0.030;

fn is(session: &Session, wanted: &str) -> bool {
    state_of_follower(session) == wanted
}

/// Stops `silent` and lets it go on; the arm has to pause, stay paused, and
/// come back when `device` is told to resume.
fn falls_silent(silent: &str, device: &str) {
    let session = Session::new();
    let mut process = start(&session, &["--rtt", "0"]);
    await_enabled(&session, &mut process);
    thread::sleep(Duration::from_secs(1));

    let victim = node(&session, silent);
    signal(victim, libc::SIGSTOP);
    assert!(wait_until(PATIENCE, || is(&session, "PAUSED")), "{silent}");
    // Commands come again, but the hold is latched.
    signal(victim, libc::SIGCONT);
    thread::sleep(Duration::from_secs(1));
    assert_eq!(state_of_follower(&session), "PAUSED", "{silent}");
    // Re-armed.
    state(&session, device, "resume");
    assert!(wait_until(PATIENCE, || is(&session, "ENABLED")), "{silent}");
    process.interrupt();
    process.wait(PATIENCE).success();

    let path = recording(&session);
    let states = messages(&path, topics::FOLLOWER_OPERATING_STATE);
    let paused = first(&states, OperatingState::PAUSED);
    let commands = messages(&path, topics::FOLLOWER_SERVO_CP);
    let last = commands
        .iter()
        .rfind(|command| command.message.stamp < paused.message.stamp)
        .expect("commands before the hold");
    let after = paused.message.stamp.seconds_since(last.message.stamp);
    // Not at once either: the watchdog of 25 ms rides over single lost frames.
    assert!(
        (0.015..=HOLD_WITHIN).contains(&after),
        "{silent}: {after} s"
    );

    // Held: it stands where it was a moment after, until it is re-armed.
    let resumed = states
        .iter()
        .find(|state| {
            state.received > paused.received && state.message.state == OperatingState::ENABLED
        })
        .expect("re-armed");
    let joints = messages(&path, topics::FOLLOWER_MEASURED_JS);
    let held: Vec<_> = joints
        .iter()
        .filter(|joint| {
            let since = joint.message.stamp.seconds_since(paused.message.stamp);
            since > 0.2 && joint.message.stamp < resumed.message.stamp
        })
        .map(|joint| joint.message.position::<2>())
        .collect();
    assert!(held.len() > 300, "{} samples", held.len());
    for joint in 0..2 {
        let (low, high) = held
            .iter()
            .fold((f64::MAX, f64::MIN), |(low, high), position| {
                (low.min(position[joint]), high.max(position[joint]))
            });
        assert!(
            high - low < 2e-3,
            "{silent}: joint {joint} moved {} rad",
            high - low
        );
    }
}

fn first(
    states: &[Received<OperatingStateSample>],
    wanted: OperatingState,
) -> &Received<OperatingStateSample> {
    states
        .iter()
        .find(|state| state.message.state == wanted)
        .unwrap_or_else(|| panic!("never {wanted:?}"))
}

#[test]
fn a_silent_master() {
    attempts(|| {
        falls_silent("master", "follower");
    });
}

#[test]
fn a_silent_link() {
    attempts(|| {
        falls_silent("link_leader", "leader");
    });
}

#[test]
fn a_silent_operator_on_ros() {
    attempts(|| {
        // The last valid command of a client that is killed.
        let session = Session::new();
        let mut process = start(&session, &["--hand", "crtk", "--rtt", "0"]);
        await_enabled(&session, &mut process);
        let hand = &crate::support::hand("hand_2.csv");
        let mut operator = Process::spawn(session.peer("ros_operator.py", &["--hand", hand]));
        operator.await_stderr("ready", PATIENCE);
        thread::sleep(Duration::from_secs(3));
        operator.crash();
        assert!(wait_until(PATIENCE, || is(&session, "PAUSED")));
        drop(operator);
        process.interrupt();
        process.wait(PATIENCE).success();

        let path = recording(&session);
        let states = messages(&path, topics::FOLLOWER_OPERATING_STATE);
        // A state is repeated: the hold began with the first PAUSED after the last ENABLED.
        let enabled = states
            .iter()
            .rposition(|state| state.message.state == OperatingState::ENABLED)
            .expect("enabled");
        let paused = first(&states[enabled..], OperatingState::PAUSED);
        let hand = messages(&path, topics::LEADER_SETPOINT_CP);
        let last = hand
            .iter()
            .rfind(|pose| pose.message.stamp < paused.message.stamp)
            .expect("the hand moved");
        let after = paused.message.stamp.seconds_since(last.message.stamp);
        // From the operator's side: the time over the link comes on top.
        assert!((0.015..=HOLD_WITHIN + 0.010).contains(&after), "{after} s");
    });
}

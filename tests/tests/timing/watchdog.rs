//! A silent master or link puts the arm into a hold, latched until it is re-armed.

use std::{path::Path, thread, time::Duration};

use ferntast_control::delay::Law;
use ferntast_msgs::{
    Message, Time,
    sample::OperatingState,
    topics::{self, Topic},
};
use ferntast_tests::{
    Machine, PATIENCE, Process, Session, Window, await_enabled, hand_of_strokes, messages, node,
    rearmed, recording, run, signal, start, state, state_of_follower, wait_until,
};

/// From the last valid command to the hold \[s\]: the watchdog of 24 ms rides
/// over single lost frames.
const HOLD: std::ops::RangeInclusive<f64> = 0.015..=0.030;
/// For so long after it was held up itself, the servo waits for others \[s\].
const RECOVERY: f64 = 0.006;

fn is(session: &Session, wanted: &str) -> bool {
    state_of_follower(session) == wanted
}

/// Stops `silent` and lets it go on; the arm has to pause, stay paused, and
/// come back when `device` is told to resume.
fn silence(session: &Session, silent: &str, device: &str) {
    rearmed(session);
    thread::sleep(Duration::from_millis(500));
    assert!(is(session, "ENABLED"), "before it was silent");
    let victim = node(session, silent);
    signal(victim, libc::SIGSTOP);
    let held = wait_until(PATIENCE, || !is(session, "ENABLED"));
    // Commands come again, but the hold is latched.
    signal(victim, libc::SIGCONT);
    assert!(held && is(session, "PAUSED"), "{silent}");
    thread::sleep(Duration::from_millis(700));
    assert_eq!(state_of_follower(session), "PAUSED", "{silent}");
    // Re-armed.
    state(session, device, "resume");
    assert!(wait_until(PATIENCE, || is(session, "ENABLED")), "{silent}");
}

/// By every law, one after the other.
fn falls_silent(silent: &str, device: &str) {
    let machine = Machine::alone();
    let session = Session::new();
    let mut process = start(&session, &["--rtt", "0"]);
    await_enabled(&session, &mut process);
    let windows: Vec<Window> = Law::NAMES
        .iter()
        .map(|law| {
            let arguments = ["link", "law", law, "--session", session.name()];
            run(&session, &arguments).success();
            let ((), window) = machine.undisturbed(|| silence(&session, silent, device));
            window
        })
        .collect();
    process.interrupt();
    process.wait(PATIENCE).success();

    let path = recording(&session);
    for (window, law) in windows.into_iter().zip(Law::NAMES) {
        println!("{law}:");
        let paused = paused(&path, window);
        holds_in_time(&machine, &path, topics::FOLLOWER_SERVO_CP, paused, 0.0);
        stands_still(&path, paused, silent);
    }
}

/// When the last hold within `window` began. A state is repeated: it began with
/// the first `PAUSED` after an `ENABLED`.
fn paused(path: &Path, window: Window) -> Time {
    let states = messages(path, topics::FOLLOWER_OPERATING_STATE);
    let began = states.windows(2).rev().find(|pair| {
        let [before, now] = [&pair[0].message, &pair[1].message];
        before.state == OperatingState::ENABLED
            && now.state == OperatingState::PAUSED
            && window.contains(now.stamp)
    });
    began.expect("a hold").last().expect("two").message.stamp
}

/// From the last message of `commands` to the hold passed as long as it may:
/// `more` \[s\] on top, and what the machine stalled.
fn holds_in_time<M: Message>(
    machine: &Machine,
    path: &Path,
    commands: Topic<M>,
    paused: Time,
    more: f64,
) {
    let commands = messages(path, commands);
    let mut stamps = commands.iter().rev().map(|own| own.message.stamp());
    let from = stamps.find(|&stamp| stamp < paused).expect("commands");
    let after = paused.seconds_since(from);
    let stalled = machine.stalled(Window { from, to: paused });
    let recovery = if stalled > 0.0 { RECOVERY } else { 0.0 };
    let most = HOLD.end() + more + stalled + recovery;
    assert!(
        (*HOLD.start()..=most).contains(&after),
        "held {after} s after the last command, within {most} s, \
         of which the machine stalled for {stalled} s"
    );
    println!("held after {after} s; the machine stalled for {stalled} s of it");
}

/// Held: it stands where it was a moment after, until it is re-armed.
fn stands_still(path: &Path, paused: Time, silent: &str) {
    let states = messages(path, topics::FOLLOWER_OPERATING_STATE);
    let mut states = states.iter().map(|state| state.message);
    let resumed = states
        .find(|state| state.stamp > paused && state.state == OperatingState::ENABLED)
        .expect("re-armed")
        .stamp;
    let joints = messages(path, topics::FOLLOWER_MEASURED_JS);
    let held: Vec<_> = joints
        .iter()
        .map(|joint| joint.message)
        .filter(|joint| joint.stamp.seconds_since(paused) > 0.2 && joint.stamp < resumed)
        .map(|joint| joint.position)
        .collect();
    assert!(held.len() > 300, "{} samples", held.len());
    for joint in 0..2 {
        let (low, high) = held
            .iter()
            .fold((f64::MAX, f64::MIN), |(low, high), position| {
                (low.min(position[joint]), high.max(position[joint]))
            });
        let moved = high - low;
        assert!(moved < 2e-3, "{silent}: joint {joint} moved {moved} rad");
    }
}

#[test]
fn a_silent_master() {
    falls_silent("master", "follower");
}

#[test]
fn a_silent_link() {
    falls_silent("link_leader", "leader");
}

/// A client that is killed while it commands.
#[test]
fn a_silent_operator_on_ros() {
    let machine = Machine::alone();
    let session = Session::new();
    let mut process = start(&session, &["--hand", "crtk", "--rtt", "0"]);
    await_enabled(&session, &mut process);
    let hand = &hand_of_strokes(&session);
    let ((), window) = machine.undisturbed(|| {
        let mut operator = Process::spawn(session.peer("ros_operator.py", &["--hand", hand]));
        operator.await_stderr("ready", PATIENCE);
        thread::sleep(Duration::from_secs(2));
        // Python may itself have been silent for 25 ms.
        rearmed(&session);
        thread::sleep(Duration::from_millis(500));
        operator.crash();
        assert!(wait_until(PATIENCE, || is(&session, "PAUSED")));
    });
    process.interrupt();
    process.wait(PATIENCE).success();

    let path = recording(&session);
    let paused = paused(&path, window);
    // From the operator's side: the time over the link comes on top.
    holds_in_time(&machine, &path, topics::LEADER_SETPOINT_CP, paused, 0.010);
}

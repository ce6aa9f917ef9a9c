//! Strangers on another host flood the arm's end of the link: one who got hold of a
//! certificate for TLS, with frames, and one who has none, with packets. (Whom it does not
//! let in without one, `live` has.)

use std::{path::Path, process::Command, thread, time::Duration};

use ferntast_msgs::{
    Time,
    sample::{Fault, LinkStatusSample, OperatingState},
    topics,
};
use ferntast_tests::{
    Host, Machine, PATIENCE, Process, Session, TwoHosts, messages, number, wait_until,
};

/// Frames a second that are tried; what comes of it is the machine's.
const FLOOD: f64 = 100_000.0;
/// Frames a second that make a flood: ten times the operator's.
const LEAST: f64 = 5_000.0;
/// For how long \[s\].
const SECONDS: f64 = 3.0;

/// Where the ends of the link meet.
fn address() -> String {
    format!("{}:7448", Host::Arm.address())
}

/// The share of the operator's frames that did not come through from `from` to `to`.
fn lost(status: &[LinkStatusSample], from: Time, to: Time) -> f64 {
    let inside: Vec<_> = status
        .iter()
        .filter(|own| own.stamp >= from && own.stamp < to)
        .collect();
    let [first, .., last] = &inside[..] else {
        panic!("no status of the link");
    };
    let lost = (last.lost - first.lost) as f64;
    lost / (lost + (last.received - first.received) as f64).max(1.0)
}

/// The session is on one host, the stranger that `stranger` makes for the link's endpoint on
/// the other.
fn flooded(
    session: &Session,
    hosts: &TwoHosts,
    stranger: impl FnOnce(&str) -> Command,
) -> serde_json::Value {
    let endpoint = format!("quic/{}", address());
    let mut command = session.ferntast(&["--json", "session", "--session", session.name()]);
    command.args(["--link-endpoint", &endpoint, "--record", "recording"]);
    command.args(["--no-console", "--no-rearm", "--rtt", "0"]);
    command.env("XDG_RUNTIME_DIR", session.folder());
    let process = hosts.start(Host::Arm, &command);
    let enabled = || {
        let arguments = ["state", "follower", "--session", session.name(), "--json"];
        let mut asked = session.ferntast(&arguments);
        asked.env("XDG_RUNTIME_DIR", session.folder());
        let asked = hosts.start(Host::Arm, &asked);
        let told = asked.wait(PATIENCE);
        told.status.success() && told.stdout.contains("ENABLED")
    };
    assert!(wait_until(PATIENCE, enabled), "the arm is not armed");
    thread::sleep(Duration::from_secs(3));
    let stranger: Process = hosts.start(Host::Operator, &stranger(&endpoint));
    let sent = stranger.wait(PATIENCE).success().json();
    thread::sleep(Duration::from_secs(1));
    process.interrupt();
    process.wait(PATIENCE).success();
    sent
}

fn statuses(recording: &Path, topic: topics::Topic<LinkStatusSample>) -> Vec<LinkStatusSample> {
    let all = messages(recording, topic).into_iter();
    all.map(|own| own.message).collect()
}

fn judge(recording: &Path, sent: &serde_json::Value) {
    let follower = statuses(recording, topics::LINK_FOLLOWER_STATUS);
    let refused = |own: &LinkStatusSample| {
        own.refused_checksum + own.refused_replayed + own.refused_session + own.refused_length
    };
    let begun = follower
        .windows(2)
        .find(|own| refused(&own[1]) > refused(&own[0]) + 50);
    let begun = begun.expect("the flood is seen")[1].stamp;
    assert!(refused(follower.last().expect("status")) > 1000);
    let told = messages(recording, topics::DIAGNOSTICS);
    assert!(
        told.iter()
            .any(|own| own.message.faults.has(Fault::StrangerOnLink))
    );
    judge_motion(recording, sent, begun);
}

/// Nothing but the operator's frames was acted on in a flood that began then, and they came
/// through, or the arm held.
fn judge_motion(recording: &Path, sent: &serde_json::Value, begun: Time) {
    let follower = statuses(recording, topics::LINK_FOLLOWER_STATUS);
    let leader = statuses(recording, topics::LINK_STATUS);
    let ended = begun.plus_nanos(SECONDS as i64 * 1_000_000_000);
    let (quiet, flood) = (
        lost(&follower, begun.plus_nanos(-3_000_000_000), begun),
        lost(&follower, begun, ended),
    );
    // The arm's end as it was when the operator's end last said what it had sent.
    let operator = leader.last().expect("status");
    let mut until = follower.iter().rev();
    let last = until.find(|own| own.stamp <= operator.stamp);
    let last = last.expect("status");
    println!(
        "{sent}: of the operator's frames lost {:.2} % before and {:.2} % in the flood",
        100.0 * quiet,
        100.0 * flood
    );
    // Nothing but the operator's own was acted on.
    assert!(last.received <= operator.sent, "{last:?}, {operator:?}");
    let commands = messages(recording, topics::FOLLOWER_SERVO_CP);
    assert!(commands.len() > 500);
    for own in commands {
        let [x, y, _] = own.message.position;
        assert!((x - 0.35355).hypot(y) < 0.08, "{:?}", own.message);
    }
    // It goes on, or holds and stays so: nobody said that it may go on.
    let states = messages(recording, topics::FOLLOWER_OPERATING_STATE);
    let during = states.iter().map(|own| own.message);
    let mut during = during.filter(|own| own.stamp >= begun).map(|own| own.state);
    let held = during.any(|own| own == OperatingState::PAUSED);
    assert!(
        !during.any(|own| own == OperatingState::ENABLED),
        "armed by nobody"
    );
    assert!(
        held || flood <= quiet + 0.01,
        "{flood} of the operator's frames lost, {quiet} before, and the arm went on"
    );
    println!("held: {held}");
}

#[test]
fn a_flood_of_forged_frames_moves_nothing() {
    let machine = Machine::alone();
    machine.undisturbed(|| {
        let session = Session::new();
        let hosts = TwoHosts::new();
        let sent = flooded(&session, &hosts, |endpoint| {
            let mut stranger = Command::new(env!("CARGO_BIN_EXE_intruder"));
            stranger.args([session.name(), endpoint, &SECONDS.to_string()]);
            stranger.arg(FLOOD.to_string());
            stranger.env("INTRUDER_KEY", session.link_secret());
            stranger
        });
        assert!(number(&sent, "sent") > LEAST * SECONDS, "{sent:#}");
        judge(&session.folder().join("recording"), &sent);
    });
}

#[test]
fn a_flood_of_packets_without_a_certificate_moves_nothing() {
    let machine = Machine::alone();
    machine.undisturbed(|| {
        let session = Session::new();
        let hosts = TwoHosts::new();
        let sent = flooded(&session, &hosts, |_| {
            let mut stranger = Command::new(env!("CARGO_BIN_EXE_packet_flood"));
            stranger.args([address(), SECONDS.to_string(), FLOOD.to_string()]);
            stranger
        });
        assert!(number(&sent, "sent") > LEAST * SECONDS, "{sent:#}");
        let begun = sent["begun_ns"].as_i64().map(Time::from_nanos);
        let recording = session.folder().join("recording");
        judge_motion(&recording, &sent, begun.expect("when it began"));
    });
}

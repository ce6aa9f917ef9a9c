//! The delay law is chosen, and changed while it runs, without a jump in force.

use ferntast_msgs::{
    sample::{LinkStatusSample, WrenchSample},
    topics::{self, Topic},
};
use ferntast_tests::{Process, Session};
use serde_json::Value;

use crate::support::{
    PATIENCE, attempts, await_enabled, messages, number, recording, refused, run, start,
};

/// The laws that the link ran, in order.
fn laws(session: &Session, topic: Topic<LinkStatusSample>) -> Vec<String> {
    let all = messages(&recording(session), topic);
    let mut names: Vec<String> = all.iter().map(|own| own.message.law.to_string()).collect();
    names.dedup();
    names
}

/// Largest change of the reflected force \[N\] from one step to the next, within
/// a second from when the law of the link changed, and at all other times.
fn steps(session: &Session) -> (f64, f64) {
    let status = messages(&recording(session), topics::LINK_STATUS);
    let switched: Vec<_> = status
        .windows(2)
        .filter(|pair| pair[0].message.law != pair[1].message.law)
        .map(|pair| pair[0].message.stamp)
        .collect();
    let forces = messages(&recording(session), topics::LEADER_REFLECTED_CF);
    let (mut during, mut else_where) = (0.0_f64, 0.0_f64);
    for pair in forces.windows(2) {
        let [before, after]: [WrenchSample; 2] = [pair[0].message, pair[1].message];
        let change = before.force.iter().zip(after.force);
        let change = change.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let near = switched
            .iter()
            .any(|at| (-0.05..1.0).contains(&after.stamp.seconds_since(*at)));
        let place = if near { &mut during } else { &mut else_where };
        *place = place.max(change);
    }
    (during, else_where)
}

#[test]
fn every_preset_runs_and_can_be_switched_in_lockstep() {
    for scenario in ["rokviss", "kontur_2", "relay", "ku_band"] {
        let session = Session::new();
        // In the middle of sliding, with force in the hand.
        let arguments = [
            "lockstep",
            scenario,
            "--law",
            "position_force",
            "--switch",
            "5=wave",
            "--switch",
            "7=position_position",
            "--duration",
            "10",
            "--record",
            "run",
            "--json",
        ];
        let summary = run(&session, &arguments).success().json();
        let expected = ["position_force", "wave", "position_position"];
        for topic in [topics::LINK_STATUS, topics::LINK_FOLLOWER_STATUS] {
            assert_eq!(laws(&session, topic), expected, "{scenario}");
        }
        assert_eq!(summary["link"]["law"], "position_position");
        assert!(
            number(&summary, "contact.peak_normal_force_N") > 1.0,
            "{scenario}: {summary:#}"
        );
        let (during, else_where) = steps(&session);
        assert!(
            during < (1.5 * else_where).max(0.05),
            "{scenario}: {during} N in a step while switching, {else_where} N at other times"
        );
    }
}

fn switch(session: &Session, law: &str) -> Value {
    let arguments = ["link", "law", law, "--session", session.name(), "--json"];
    run(session, &arguments).success().json()
}

fn set_parameter(session: &Session, value: &str) -> Value {
    let arguments = ["--node", "/link", "--name", "law", "--value", value];
    Process::spawn(session.peer("set_parameter.py", &arguments))
        .wait(PATIENCE)
        .success()
        .json()
}

#[test]
fn switched_from_the_command_line_and_as_a_ros_parameter() {
    attempts(|| {
        let session = Session::new();
        let mut process = start(&session, &["--law", "position_force", "--rtt", "100"]);
        await_enabled(&session, &mut process);
        assert_eq!(switch(&session, "wave")["law"], "wave");
        let told = run(&session, &["link", "law", "--session", session.name()]).success();
        assert_eq!(told.stdout.trim(), "wave");

        let set = set_parameter(&session, "position_position");
        assert_eq!(set["before"], "wave", "{set:#}");
        assert_eq!(set["successful"], true, "{set:#}");
        assert_eq!(set["after"], "position_position", "{set:#}");
        let listed = set["listed"].as_array().expect("a list");
        assert!(listed.iter().any(|name| name == "law"), "{set:#}");
        let set = set_parameter(&session, "nonsense");
        assert_eq!(set["successful"], false, "{set:#}");
        let reason = set["reason"].as_str().expect("a reason");
        assert!(reason.contains("wave"), "{set:#}");
        assert_eq!(set["after"], "position_position", "{set:#}");

        process.interrupt();
        process.wait(PATIENCE).success();
        let expected = ["position_force", "wave", "position_position"];
        for topic in [topics::LINK_STATUS, topics::LINK_FOLLOWER_STATUS] {
            assert_eq!(laws(&session, topic), expected);
        }
        let (during, _) = steps(&session);
        assert!(during < 1.0, "{during} N in a step");
    });
}

#[test]
fn a_law_that_there_is_not_is_refused() {
    let session = Session::new();
    refused(&session, &["lockstep", "--law", "none"], &["none", "wave"]);
    refused(&session, &["link", "law", "none"], &["none", "wave"]);
    refused(
        &session,
        &["lockstep", "--switch", "wave"],
        &["SECONDS=LAW"],
    );
    refused(
        &session,
        &["lockstep", "--switch", "1=none"],
        &["none", "wave"],
    );
}

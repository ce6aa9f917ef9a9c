//! The delay law is chosen, and changed while it runs, without a jump in force.

use ferntast_msgs::{
    sample::{LinkStatusSample, WrenchSample},
    topics::{self, Topic},
};
use ferntast_tests::Session;
use serde_json::Value;

use crate::support::{
    PATIENCE, attempts, await_enabled, messages, number, recording, refused, run, set_parameter,
    start,
};

/// The laws that the link ran, in order.
fn laws(session: &Session, topic: Topic<LinkStatusSample>) -> Vec<String> {
    let all = messages(&recording(session), topic);
    let mut names: Vec<String> = all.iter().map(|own| own.message.law.to_string()).collect();
    names.dedup();
    names
}

/// Largest change of the reflected force \[N\] from one step to the next, within
/// 0.35 s from when the law of the link began to change, and at all other times.
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
            .any(|at| (-0.05..0.35).contains(&after.stamp.seconds_since(*at)));
        let place = if near { &mut during } else { &mut else_where };
        *place = place.max(change);
    }
    (during, else_where)
}

/// Runs the scenario in lockstep; gives its summary.
fn lockstep(session: &Session, scenario: &str, arguments: &[&str]) -> Value {
    let common = ["--duration", "10", "--record", "run", "--json"];
    let arguments = [&["lockstep", scenario], arguments, &common].concat();
    run(session, &arguments).success().json()
}

#[test]
fn every_preset_runs_and_can_be_switched_in_lockstep() {
    let chosen = ["position_force", "model_mediated", "position_position"];
    for scenario in ["rokviss", "kontur_2", "relay", "ku_band"] {
        // By itself each law is as rough as the link makes it.
        let own = chosen.map(|law| {
            let session = Session::new();
            lockstep(&session, scenario, &["--law", law]);
            steps(&session).1
        });
        let own = own.into_iter().fold(0.0, f64::max);
        let session = Session::new();
        // In the middle of sliding, with force in the hand.
        let [first, second, third] = chosen;
        let switches = [format!("5={second}"), format!("7={third}")];
        let summary = lockstep(
            &session,
            scenario,
            &[
                "--law",
                first,
                "--switch",
                &switches[0],
                "--switch",
                &switches[1],
            ],
        );
        for topic in [topics::LINK_STATUS, topics::LINK_FOLLOWER_STATUS] {
            assert_eq!(laws(&session, topic), chosen, "{scenario}");
        }
        assert_eq!(summary["link"]["law"], third);
        assert!(
            number(&summary, "contact.peak_normal_force_N") > 1.0,
            "{scenario}: {summary:#}"
        );
        let (during, _) = steps(&session);
        assert!(
            during < 1.2 * own,
            "{scenario}: {during} N in a step while switching, {own} N without"
        );
    }
}

#[test]
fn every_preset_runs_by_its_own_law() {
    for (scenario, law) in [
        ("rokviss", "position_force"),
        ("kontur_2", "tdpa"),
        ("relay", "tdpa"),
        ("ku_band", "wave"),
    ] {
        let session = Session::new();
        let summary = lockstep(&session, scenario, &[]);
        assert_eq!(summary["link"]["law"], law, "{scenario}");
        assert_eq!(
            summary["states"]["follower"]["final"], "ENABLED",
            "{scenario}"
        );
        assert!(
            number(&summary, "contact.time_s") > 1.0,
            "{scenario}: {summary:#}"
        );
    }
}

fn switch(session: &Session, law: &str) -> Value {
    let arguments = ["link", "law", law, "--session", session.name(), "--json"];
    run(session, &arguments).success().json()
}

fn set_law(session: &Session, value: &str) -> Value {
    set_parameter(session, ["/link", "law", value])
}

#[test]
fn switched_from_the_command_line_and_as_a_ros_parameter() {
    attempts(|| {
        let session = Session::new();
        let mut process = start(&session, &["--law", "position_force", "--rtt", "100"]);
        await_enabled(&session, &mut process);
        assert_eq!(switch(&session, "model_mediated")["law"], "model_mediated");
        let told = run(&session, &["link", "law", "--session", session.name()]).success();
        assert_eq!(told.stdout.trim(), "model_mediated");

        let set = set_law(&session, "position_position");
        assert_eq!(set["before"], "model_mediated", "{set:#}");
        assert_eq!(set["successful"], true, "{set:#}");
        assert_eq!(set["after"], "position_position", "{set:#}");
        let listed = set["listed"].as_array().expect("a list");
        assert!(listed.iter().any(|name| name == "law"), "{set:#}");
        let set = set_law(&session, "nonsense");
        assert_eq!(set["successful"], false, "{set:#}");
        let reason = set["reason"].as_str().expect("a reason");
        assert!(reason.contains("wave"), "{set:#}");
        assert_eq!(set["after"], "position_position", "{set:#}");

        process.interrupt();
        process.wait(PATIENCE).success();
        let expected = ["position_force", "model_mediated", "position_position"];
        for topic in [topics::LINK_STATUS, topics::LINK_FOLLOWER_STATUS] {
            assert_eq!(laws(&session, topic), expected);
        }
        let (during, _) = steps(&session);
        assert!(during < 0.5, "{during} N in a step");
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

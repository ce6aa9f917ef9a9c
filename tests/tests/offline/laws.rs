//! The delay law is chosen, and changed in virtual time, without a jump in force.

use ferntast_msgs::topics;
use ferntast_tests::{Session, force_steps, laws, number, recording, refused, run, switches};
use serde_json::Value;

/// Largest change of the reflected force \[N\] from one step to the next, within
/// 0.35 s from when the law of the link began to change, and at all other times.
fn steps(session: &Session) -> (f64, f64) {
    let path = recording(session);
    let switched = switches(&path);
    let (mut during, mut else_where) = (0.0_f64, 0.0_f64);
    for (stamp, change) in force_steps(&path) {
        let near = switched
            .iter()
            .any(|at| (-0.05..0.35).contains(&stamp.seconds_since(*at)));
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
            assert_eq!(laws(&recording(&session), topic), chosen, "{scenario}");
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
        ("relay", "auto"),
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

//! `ferntast session --end`: the hand on one host, the arm on another, as docs/two_hosts.md has it.

use std::{collections::BTreeSet, fs, path::Path};

use ferntast_msgs::topics;
use ferntast_tests::{
    Host, LINK_KEYS, PATIENCE, Process, Session, TwoHosts, messages, number, refused, wait_until,
};
use serde_json::Value;

/// `ferntast session` of an end on its host, whose runtime folder is its own as well.
fn end(session: &Session, hosts: &TwoHosts, host: Host, arguments: &[&str]) -> Process {
    let end = match host {
        Host::Operator => "operator",
        Host::Arm => "arm",
    };
    let runtime = session.folder().join(format!("runtime-{end}"));
    fs::create_dir_all(&runtime).expect("scratch folder");
    let endpoint = format!("quic/{}:7448", Host::Arm.address());
    let mut command = session.ferntast(&["session", "--end", end, "--session", session.name()]);
    command.args(["--link-endpoint", &endpoint, "--no-console", "--json"]);
    command.args(["--record", end]).args(arguments);
    command.env(LINK_KEYS, host.keys(session));
    command.env("XDG_RUNTIME_DIR", &runtime);
    hosts.start(host, &command)
}

fn nodes(summary: &Value) -> BTreeSet<&str> {
    let nodes = summary["nodes"].as_object().expect("nodes");
    nodes.keys().map(String::as_str).collect()
}

#[test]
fn each_host_runs_its_end_by_one_command() {
    let session = Session::new();
    let hosts = TwoHosts::new();
    hosts.exchange_keys(&session);
    // The operator comes first and waits, longer than for anything of its own.
    let mut operator = end(&session, &hosts, Host::Operator, &["--duration", "20"]);
    operator.await_stderr("waits for the arm's host", PATIENCE);
    let arm = end(&session, &hosts, Host::Arm, &[]);
    let told = |host: Host, arguments: &[&str]| {
        let all = [
            &["state"],
            arguments,
            &["--session", session.name(), "--json"],
        ]
        .concat();
        let told = hosts.start(host, &session.ferntast(&all)).wait(PATIENCE);
        told.stdout
    };
    let is = |state: &str| told(Host::Arm, &["follower"]).contains(&format!("\"{state}\""));
    operator.await_stderr("master ENABLED", PATIENCE);
    assert!(
        wait_until(PATIENCE, || is("ENABLED")),
        "the arm is not armed"
    );
    // Who stands there stops it, and the operator's word over the link lets it go on.
    told(Host::Arm, &["follower", "pause"]);
    assert!(wait_until(PATIENCE, || is("PAUSED")));
    told(Host::Operator, &["leader", "resume"]);
    assert!(
        wait_until(PATIENCE, || is("ENABLED")),
        "the operator's word does not arrive"
    );
    let operator = operator.wait(PATIENCE).success().json();
    arm.interrupt();
    let arm = arm.wait(PATIENCE).success().json();

    let both = ["gateway", "recorder"];
    let of_operator = ["link_leader", "master"];
    let of_arm = ["arm", "estimator", "link_follower", "servo"];
    let expected = |own: &[&'static str]| own.iter().chain(&both).copied().collect::<BTreeSet<_>>();
    assert_eq!(nodes(&operator), expected(&of_operator));
    assert_eq!(nodes(&arm), expected(&of_arm));
    assert_eq!(
        (&operator["end"], &arm["end"]),
        (&"operator".into(), &"arm".into())
    );

    // What the script's hand pressed, it felt.
    assert!(number(&arm, "armed_s") > 8.0, "{arm:#}");
    assert!(number(&arm, "contact.peak_normal_force_N") > 2.0, "{arm:#}");
    assert!(
        number(&operator, "leader.peak_force_N") > 0.1,
        "{operator:#}"
    );
    // What the arm's end says of its arm is told at the operator's.
    let visited = operator["states"]["follower"]["visited"].to_string();
    assert!(
        visited.contains(r#""ENABLED","PAUSED","ENABLED""#),
        "{visited}"
    );
    // The scenario's channel and a line of microseconds.
    for own in [&operator, &arm] {
        let round_trip = number(own, "link.rtt_ms");
        assert!((18.0..40.0).contains(&round_trip), "{own:#}");
    }
    let recorded = ["operator", "arm"].map(|end| session.folder().join(end));
    the_arm_is_seen_as_it_was(&recorded[0], &recorded[1]);
}

/// What the operator's host recorded of the arm is what the arm's host measured at that time: both
/// have the clock of this machine.
fn the_arm_is_seen_as_it_was(operator: &Path, arm: &Path) {
    let seen = messages(operator, topics::LINK_ARM_MEASURED_JS);
    let truth = messages(arm, topics::FOLLOWER_MEASURED_JS);
    let (first, last) = (seen[0].message.stamp, seen[seen.len() - 1].message.stamp);
    let rate = (seen.len() - 1) as f64 / last.seconds_since(first);
    assert!((20.0..26.0).contains(&rate), "{rate} Hz");
    let mut compared = 0;
    for view in &seen {
        let at = view.message.stamp;
        // By then it has crossed the emulated channel.
        let way = view.received.seconds_since(at);
        assert!((0.007..0.2).contains(&way), "seen {way} s late");
        let after = truth.partition_point(|own| own.message.stamp < at);
        let near = truth.iter().skip(after.saturating_sub(5)).take(10);
        let near: Vec<_> = near
            .filter(|own| own.message.stamp.seconds_since(at).abs() < 0.005)
            .collect();
        if near.is_empty() {
            // Recorded before the arm's host did, or after.
            continue;
        }
        compared += 1;
        for joint in 0..2 {
            let apart = |own: f64| (own - view.message.position[joint]).abs();
            let least = near.iter().map(|own| apart(own.message.position[joint]));
            assert!(least.fold(f64::INFINITY, f64::min) < 1e-4, "{view:?}");
        }
    }
    assert!(compared > seen.len() / 2, "{compared} of {}", seen.len());
    let contacts = messages(operator, topics::LINK_ARM_CONTACT_STATE);
    let touched = contacts.iter().filter(|own| own.message.in_contact == 1);
    let share = touched.count() as f64 / contacts.len() as f64;
    assert!(
        (0.02..0.98).contains(&share),
        "in contact {share} of the time"
    );
}

#[test]
fn what_belongs_to_the_other_end_is_refused() {
    let session = Session::new();
    for (arguments, words) in [
        (
            &["--end", "operator", "--driver", "simulated"][..],
            ["--driver", "session --end arm"],
        ),
        (
            &["--end", "operator", "--twin", "joint.toml"],
            ["--twin", "arm's host"],
        ),
        (
            &["--end", "arm", "--hand", "crtk"],
            ["--hand", "session --end operator"],
        ),
        (&["--link-peer", "arm"], ["--link-peer", "--end operator"]),
    ] {
        refused(&session, &[&["session"][..], arguments].concat(), &words);
    }
}

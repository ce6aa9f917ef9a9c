//! What is injected is what the link measures.

use ferntast_tests::{Session, number, run};

const ROUND_TRIPS_MS: [f64; 4] = [0.0, 20.0, 100.0, 600.0];

#[test]
fn in_lockstep_exactly() {
    let session = Session::new();
    for expected in ROUND_TRIPS_MS {
        let rtt = expected.to_string();
        let summary = run(
            &session,
            &["lockstep", "--rtt", &rtt, "--duration", "3", "--json"],
        )
        .success()
        .json();
        for key in ["link.rtt_ms", "link.rtt_p99_ms"] {
            let measured = number(&summary, key);
            // Equal in nanoseconds; in milliseconds up to rounding.
            assert!((measured - expected).abs() < 1e-9, "{key}: {measured} ms");
        }
    }
}

#[test]
fn loss_is_measured_too() {
    // Kontur-2's link as assumed: 1 % lost in bursts.
    let session = Session::new();
    let summary = run(
        &session,
        &[
            "lockstep",
            "--link",
            "kontur_2",
            "--duration",
            "60",
            "--json",
        ],
    )
    .success()
    .json();
    let loss = number(&summary, "link.loss");
    assert!((0.005..0.02).contains(&loss), "{loss}");
    assert!((number(&summary, "link.rtt_ms") - 25.0).abs() < 1.0);
    assert!(number(&summary, "link.jitter_ms") > 0.3);
}

/// The scripted operator of `rokviss`, with every frame and with those that say something new:
/// it arms, touches and lets go as before, and no keep-alive is taken for a dead link.
#[test]
fn frames_that_say_nothing_new_may_be_left_out() {
    let session = Session::new();
    let summary = |codec: &str| {
        let arguments = ["lockstep", "--codec", codec, "--duration", "12", "--json"];
        run(&session, &arguments).success().json()
    };
    let (all, few) = (summary("none"), summary("deadband"));
    assert!((number(&all, "link.sent") - 1.0).abs() < 0.01, "{all:#}");
    let sent = number(&few, "link.sent");
    // A keep-alive every 8 ms is a quarter of the frames.
    assert!((0.2..0.4).contains(&sent), "{sent}");
    for key in [
        "states.follower.visited",
        "states.leader.visited",
        "contact.edges",
    ] {
        let at = |own: &serde_json::Value| {
            key.split('.')
                .fold(own.clone(), |own, part| own[part].clone())
        };
        assert_eq!(at(&all), at(&few), "{key}");
        assert!(
            at(&all).as_array().is_some_and(|own| !own.is_empty()),
            "{key}"
        );
    }
    for key in ["leader.peak_force_N", "contact.peak_normal_force_N"] {
        let (before, after) = (number(&all, key), number(&few, key));
        assert!(
            (after - before).abs() < 0.1 * before,
            "{key}: {before}, {after}"
        );
    }
}

/// Kontur-2's bursts pause the arm some three hundred times an hour; the scenario lets
/// it go on by itself after gaps up to half a second, and another does not.
#[test]
fn short_gaps_pause_the_arm_for_good_only_where_the_scenario_does_not_bridge_them() {
    let session = Session::new();
    let mut held = 0;
    for seed in 1..=5 {
        let seed = seed.to_string();
        let visited = |arguments: &[&str]| -> Vec<String> {
            let run_for = ["--law", "position_force", "--duration", "60", "--json"];
            let all = [&["lockstep", "--seed", &seed], arguments, &run_for].concat();
            let summary = run(&session, &all).success().json();
            let visited = &summary["states"]["follower"]["visited"];
            serde_json::from_value(visited.clone()).expect("states")
        };
        let bridged = visited(&["--scenario", "kontur_2"]);
        assert_eq!(bridged.last().expect("a state"), "ENABLED", "seed {seed}");
        held += usize::from(bridged.iter().any(|own| own == "PAUSED"));
        let latched = visited(&["--link", "kontur_2"]);
        assert_eq!(latched.last().expect("a state"), "PAUSED", "seed {seed}");
    }
    assert!(held >= 4, "{held} of 5 seeds held at all");
}

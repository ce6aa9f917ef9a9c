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

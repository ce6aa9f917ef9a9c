//! What is injected is what the link measures.

use ferntast_tests::{Machine, PATIENCE, Session, Window, now, number, start};

const ROUND_TRIPS_MS: [f64; 3] = [0.0, 20.0, 600.0];
/// How long each is measured [s].
const SECONDS: f64 = 3.0;

#[test]
fn in_real_time_within_two_milliseconds() {
    let machine = Machine::alone();
    for expected in ROUND_TRIPS_MS {
        let session = Session::new();
        let (rtt, seconds) = (expected.to_string(), SECONDS.to_string());
        let from = now();
        let summary = start(&session, &["--rtt", &rtt, "--duration", &seconds])
            .wait(PATIENCE)
            .success()
            .json();
        let stalled = machine.stalled(Window { from, to: now() });
        // The median: frames that a stall delayed do not move it.
        let measured = number(&summary, "link.rtt_ms");
        assert!(
            (measured - expected).abs() < 2.0,
            "{expected}: {measured} ms"
        );
        // Frames are dropped rather than queued, where the machine stalled.
        let lost = number(&summary, "link.loss") * SECONDS;
        assert!(
            lost <= stalled,
            "{expected} ms: frames of {lost} s were lost, the machine stalled for {stalled} s"
        );
    }
}

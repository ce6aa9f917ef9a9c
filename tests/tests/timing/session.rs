//! The main job: a session runs, is recorded and sums up.

use ferntast_msgs::{sample::Edge, topics};
use ferntast_tests::{Machine, PATIENCE, Session, messages, number, recording, start};

#[test]
fn a_session_runs_is_recorded_and_sums_up() {
    let machine = Machine::alone();
    // A hold that the machine causes ends the motion.
    machine.undisturbed(|| {
        let session = Session::new();
        let process = start(&session, &["--duration", "8"]);
        let ended = process.wait(PATIENCE).success();
        let summary = ended.json();

        assert!((number(&summary, "duration_s") - 8.0).abs() < 0.5);
        assert!((number(&summary, "servo.rate_hz") - 1000.0).abs() < 50.0);
        assert!(number(&summary, "servo.missed") < 800.0, "{summary:#}");
        assert!(
            (number(&summary, "link.rtt_ms") - 20.0).abs() < 2.0,
            "{summary:#}"
        );
        assert!(number(&summary, "link.loss") < 0.02);
        // In the first eight seconds the script presses on the lubricated edge.
        let force = number(&summary, "contact.peak_normal_force_N");
        assert!((10.0..80.0).contains(&force), "{force} N");
        assert_eq!(summary["contact"]["edges"][0], "lubricated");
        let felt = number(&summary, "leader.peak_force_N");
        assert!((0.05 * 10.0..0.05 * 90.0).contains(&felt), "{felt} N");
        assert_eq!(summary["states"]["follower"]["final"], "ENABLED");
        assert_eq!(summary["recording"], "run");
        assert_eq!(summary["recorder"]["lost"], 0);
        for (name, node) in summary["nodes"].as_object().expect("nodes") {
            assert_eq!(node["alive"], true, "{name}");
            assert_eq!(node["restarts"], 0, "{name}");
        }
        // A person saw lines, not a wall of log.
        assert!(ended.stderr.contains("rtt "), "{}", ended.stderr);
        assert!(ended.stderr.lines().count() < 12, "{}", ended.stderr);

        // What was recorded is what was told.
        let path = recording(&session);
        let contacts = messages(&path, topics::FOLLOWER_CONTACT_STATE);
        assert!(
            contacts
                .iter()
                .any(|own| own.message.edge == Edge::LUBRICATED)
        );
        let joints = messages(&path, topics::FOLLOWER_MEASURED_JS);
        assert!(joints.len() > 7500, "{} of 8000", joints.len());
        let backwards = joints
            .windows(2)
            .filter(|pair| pair[1].message.stamp <= pair[0].message.stamp)
            .count();
        assert_eq!(backwards, 0);
    });
}

//! A stock rclpy client as the hand of an arm in space: it moves along three axes and turns, and the
//! table comes back to it.

use ferntast_msgs::topics;
use ferntast_nodes::master::THIS_HOST;
use ferntast_tests::{
    PATIENCE, Process, Session, arm_state, ask_python, await_enabled, messages, number, operated,
    peer, recording, root, start,
};
use serde_json::json;

#[test]
fn rclpy_moves_a_panda_in_space_turns_its_tool_and_feels_the_table() {
    let session = Session::new();
    let mut process = start(&session, &["--hand", "crtk", "--arm", "panda"]);
    await_enabled(&session, &mut process);
    // A machine that stalls holds the arm: the hand waits until it obeys again.
    let state = arm_state(&session);
    let arguments = ["--duration", "12", "--arm-state", &state];
    let mut hand = Process::spawn(session.peer("ros_hand_in_space.py", &arguments));
    hand.await_stderr("ready", PATIENCE);
    let felt = operated(&session, hand).success().json();
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    println!("{felt:#}");

    // The table, 30 mm below, pushes upwards, and rubs along both other axes.
    let force = |which: &str, axis: usize| felt[which][axis].as_f64().expect("a force");
    assert!(
        (0.5..10.0).contains(&force("most_N", 2)),
        "{felt:#} {summary:#}"
    );
    for axis in 0..2 {
        let rubbed = force("most_N", axis).max(-force("least_N", axis));
        assert!(
            rubbed > 0.02 && rubbed < force("most_N", 2),
            "{axis}: {felt:#}"
        );
    }
    assert!(
        number(&summary, "contact.peak_normal_force_N") > 10.0,
        "{summary:#}"
    );

    // The tool turned with the hand, by MuJoCo's kinematics.
    let bag = recording(&session);
    let all = messages(&bag, topics::FOLLOWER_MEASURED_JS);
    let hands = messages(&bag, topics::LEADER_MEASURED_CP);
    let client = hands.iter().filter(|own| own.message.source > THIS_HOST);
    let times: Vec<f64> = client
        .map(|own| own.received.seconds_since(all[0].received))
        .collect();
    let (first, last) = (times[0], times[times.len() - 1]);
    let joints: Vec<String> = (1..=7).map(|joint| format!("panda_joint{joint}")).collect();
    let asked = json!({
        "bag": bag, "urdf": root().join("config/arms/panda.urdf"), "joints": joints, "tip": "stylus_tip",
        "from": first + 0.5, "to": last - 0.2,
    });
    let turned = ask_python(&peer("tool_turns.py"), &asked);
    println!("{turned}");
    assert!(number(&turned, "turned_rad") > 0.35, "{turned}");
    assert!(number(&turned, "error_rad") < 0.05, "{turned}");
    assert!(number(&turned, "delay_s") < 0.08, "{turned}");
}

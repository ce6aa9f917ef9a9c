//! The lab on recordings of whole arms that MuJoCo made, with an effect hidden.

use ferntast_tests::{Session, is_thorough, run};
use serde_json::Value;

use super::recorded;

/// Robot and effect: nothing, one of a joint, of two, of the arm. A thorough run has
/// all, others the first four; more of them: `tests/python/peers/arm_recordings.py`.
const CASES: [(&str, &str); 7] = [
    ("ur5_robot", "none"),
    ("ur5_robot", "warm_up_viscous"),
    ("panda", "joint_coupling"),
    ("ur5_robot", "payload"),
    ("panda", "stribeck"),
    ("ur5_robot", "load_elasticity"),
    ("panda", "joint_zeros"),
];

#[test]
fn what_is_hidden_in_an_arm_is_named_with_its_joint() {
    let session = Session::new();
    let cases = if is_thorough() { CASES.len() } else { 4 };
    for &(robot, effect) in &CASES[..cases] {
        let name = recorded(&session, robot, effect);
        let hidden = std::fs::read_to_string(session.folder().join(format!("{name}.json")));
        let hidden: Value = serde_json::from_str(&hidden.expect("a file")).expect("JSON");
        let experiment = format!("{name}.toml");
        let told = run(&session, &["lab", "diagnose", &experiment, "--json"])
            .success()
            .json();
        if effect == "none" {
            assert_eq!(told["verdict"], "complete", "{name}: {told:#}");
            continue;
        }
        let first = &told["candidates"][0];
        assert_eq!(first["effect"], effect, "{name}: {told:#}");
        assert_eq!(first["joint"], hidden["joint"], "{name}: {told:#}");
        if !hidden["partner"].is_null() {
            assert_eq!(first["partner"], hidden["partner"], "{name}: {told:#}");
        }
        let mut all = told["candidates"].as_array().into_iter().flatten();
        let only_there = all.all(|own| own["joint"] == hidden["joint"]);
        assert!(only_there, "{name}: {told:#}");
    }
}

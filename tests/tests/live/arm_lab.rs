//! The lab on recordings of whole arms that MuJoCo made, with an effect hidden.

use ferntast_tests::{Session, ask_python, peer, run};
use serde_json::{Value, json};

/// Robot, effect, seed, strength. More of them: `tests/python/peers/arm_recordings.py`.
const CASES: [(&str, &str, &str, &str); 7] = [
    ("ur5_robot", "none", "1", "1"),
    ("panda", "stribeck", "1", "1"),
    ("ur5_robot", "payload", "1", "1"),
    ("panda", "joint_coupling", "1", "1"),
    ("ur5_robot", "load_elasticity", "1", "1"),
    ("ur5_robot", "warm_up_viscous", "1", "1"),
    ("panda", "joint_zeros", "1", "1"),
];

#[test]
fn what_is_hidden_in_an_arm_is_named_with_its_joint() {
    let session = Session::new();
    let listed = ask_python(&peer("rigid_body.py"), &json!({}));
    let files = listed["files"].as_array().expect("files");
    for (robot, effect, seed, strength) in CASES {
        let ending = format!("/{robot}.urdf");
        let mut paths = files.iter().filter_map(Value::as_str);
        let urdf = paths.find(|path| path.ends_with(&ending)).expect("a URDF");
        let arguments = [urdf, ".", effect, seed, strength];
        let mut made = session.peer("arm_recordings.py", &arguments);
        assert!(made.status().expect("python starts").success());
        let arm = robot.split('_').next().unwrap_or(robot);
        let name = format!("{arm}-{effect}-{seed}-100");
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

//! Held against independent programs, MuJoCo, Pinocchio and plain equations in Python, which
//! `./tests/run --quick` has not.

use ferntast_tests::{Session, ask_python, peer};
use serde_json::{Value, json};

mod arm_export;
mod arm_lab;
mod contact_force;
mod dynamics;
mod numbers;
mod reference_laws;
mod rigid_body;
mod serial_arm;

/// A recording of an arm by MuJoCo with an effect hidden, in the session's folder: the
/// experiment's name without `.toml`, beside which a `.json` of that name tells what is hidden.
fn recorded(session: &Session, robot: &str, effect: &str) -> String {
    let listed = ask_python(&peer("rigid_body.py"), &json!({}));
    let files = listed["files"].as_array().expect("files");
    let ending = format!("/{robot}.urdf");
    let mut paths = files.iter().filter_map(Value::as_str);
    let urdf = paths.find(|path| path.ends_with(&ending)).expect("a URDF");
    let mut made = session.peer("arm_recordings.py", &[urdf, ".", effect, "1", "1"]);
    assert!(made.status().expect("python starts").success());
    let arm = robot.split('_').next().unwrap_or(robot);
    format!("{arm}-{effect}-1-100")
}

//! What the lab identified of an arm, exported and held against its recording in MuJoCo.

use std::fs;

use ferntast_tests::{Session, ask_python, number, root, run};
use serde_json::{Value, json};

use super::recorded;

/// The experiment with these effects more.
fn with(session: &Session, name: &str, effects: &[&str]) -> String {
    let text = fs::read_to_string(session.folder().join(format!("{name}.toml")));
    let more: String = effects.iter().map(|own| format!(", \"{own}\"")).collect();
    let text = text.expect("an experiment").replace(
        "\"coulomb\", \"viscous\"",
        &format!("\"coulomb\", \"viscous\"{more}"),
    );
    let file = format!("{name}-with.toml");
    fs::write(session.folder().join(&file), text).expect("scratch folder");
    file
}

fn export(session: &Session, experiment: &str, to: &str, output: &str, more: &[&str]) -> Value {
    let mut arguments = vec![
        "lab", "export", experiment, "--to", to, "-o", output, "--json",
    ];
    arguments.extend(more);
    run(session, &arguments).success().json()
}

fn held_against(session: &Session, name: &str, files: &[&str]) -> Value {
    let at = |file: &str| session.folder().join(file).to_str().map(str::to_owned);
    let text = fs::read_to_string(session.folder().join(format!("{name}.toml")));
    let given: toml::Table = text.expect("an experiment").parse().expect("TOML");
    let arm = &given["arm"];
    ask_python(
        &root().join("tests/python/arm_in_mujoco.py"),
        &json!({
            "recording": at(&format!("{name}.csv")),
            "urdf": at(arm["urdf"].as_str().expect("a path")),
            "armature": arm["armature"],
            "exported": files.iter().map(|file| at(file)).collect::<Vec<_>>(),
        }),
    )
}

fn is_a_body(exported: &Value, joints: usize) {
    let least = exported["least_eigenvalues"].as_object().expect("bodies");
    assert_eq!(least.len(), joints);
    for (body, value) in least {
        assert!(
            value.as_f64().is_some_and(|own| own > 0.0),
            "{body}: {value}"
        );
    }
}

/// Friction of every joint; Stribeck, which MuJoCo has no words for, is told and weighed.
#[test]
fn an_arm_in_mujoco_moves_as_it_was_recorded() {
    let session = Session::new();
    let name = recorded(&session, "panda", "stribeck");
    let hidden = fs::read_to_string(session.folder().join(format!("{name}.json")));
    let hidden: Value = serde_json::from_str(&hidden.expect("a file")).expect("JSON");
    let joint = hidden["joint"].as_str().expect("a joint");
    let experiment = with(&session, &name, &[&format!("stribeck@{joint}")]);
    let whole = export(&session, &experiment, "mujoco", "whole.xml", &[]);
    export(
        &session,
        &experiment,
        "mujoco",
        "approximate.xml",
        &["--approximate"],
    );
    let lost = whole["unsaid"].as_array().expect("a list");
    assert_eq!(lost.len(), 1, "{whole:#}");
    assert_eq!(
        (&lost[0]["joint"], &lost[0]["effect"]),
        (&hidden["joint"], &json!("stribeck"))
    );
    let errors = &whole["joints"][joint];
    let [whole_errs, alone, anew] =
        ["train", "said_alone", "said_refitted"].map(|key| number(errors, key));
    assert!(whole_errs < anew && anew < alone, "{errors:#}");
    let rms = number(&lost[0], "rms");
    assert!(rms > 0.3 * alone && rms < 1.5 * alone, "{rms} {errors:#}");

    // Ten numbers of a light link, of which the motion shows a few: still a body.
    let experiment = with(&session, &name, &["link_inertia@panda_joint6"]);
    export(&session, &experiment, "mujoco", "link.xml", &[]);

    let files = ["whole.xml", "approximate.xml", "link.xml"];
    let told = held_against(&session, &name, &files);
    let before = &told["before"];
    for exported in told["exported"].as_array().expect("a list") {
        is_a_body(exported, 7);
        // The same links as MuJoCo reads out of the URDF, but for the one that was fitted.
        assert!(number(exported, "apart") < 0.05, "{exported:#}");
        let torque = number(exported, "all_torque_Nm") / number(before, "all_torque_Nm");
        assert!(torque > 0.01 && torque < 0.2, "{torque}: {told:#}");
        let position = number(exported, "all_position_mrad") / number(before, "all_position_mrad");
        assert!(position > 0.005 && position < 0.2, "{position}: {told:#}");
    }
    for exported in &told["exported"].as_array().expect("a list")[..2] {
        assert!(number(exported, "apart") < 1e-6, "{exported:#}");
    }
    // The judge finds of the other joints what the lab says of them, with more noise since it smooths
    // less; of this one more, since it judges slower samples too, where Stribeck friction is largest.
    for (name, errors) in whole["joints"].as_object().expect("joints") {
        let judged = number(&told["exported"][0]["torque_Nm"], name);
        let times = judged / number(errors, "said_alone");
        let bounds = if name == joint { 1.0..5.0 } else { 0.7..3.0 };
        assert!(bounds.contains(&times), "{name}: {times} {errors:#}");
    }
}

/// A payload goes into the masses, of whatever form; MuJoCo reads the URDF, too.
#[test]
fn a_payload_is_in_the_masses_that_are_written() {
    let session = Session::new();
    let name = recorded(&session, "ur5_robot", "payload");
    let experiment = with(&session, &name, &["payload"]);
    for (to, file) in [
        ("mujoco", "arm.xml"),
        ("urdf", "arm.urdf"),
        ("sdf", "arm.sdf"),
        ("ferntast", "own.arm.toml"),
    ] {
        let told = export(&session, &experiment, to, file, &[]);
        assert_eq!(told["unsaid"], json!([]), "{told:#}");
    }
    let told = held_against(&session, &name, &["arm.xml", "arm.urdf"]);
    is_a_body(&told["exported"][0], 6);
    for exported in told["exported"].as_array().expect("a list") {
        let torque = number(exported, "all_torque_Nm") / number(&told["before"], "all_torque_Nm");
        assert!(torque > 0.005 && torque < 0.1, "{torque}: {told:#}");
    }
    // The arm's file is one that a session takes.
    let lockstep = [
        "lockstep",
        "--arm",
        "own.arm.toml",
        "--duration",
        "1",
        "--json",
    ];
    run(&session, &lockstep).success();
    let text = fs::read_to_string(session.folder().join("arm.sdf")).expect("a file");
    assert_eq!(text.matches("<link name").count(), 7);
    let told = export(&session, &experiment, "ur", "ur.yaml", &[]);
    let notes = told["notes"].as_array().expect("a list");
    assert!(notes.iter().any(|own| {
        own.as_str()
            .is_some_and(|own| own.contains("--compensated"))
    }));
    let identified = arms_friction(&session, "own.arm.toml");
    under_compensation(&session, &name);
    let more = ["--compensated", "compensated.toml", "--force"];
    let text = fs::read_to_string(session.folder().join("ur.yaml")).expect("a file");
    assert!(
        text.contains("viscous_scale: [0.900, 0.900, 0.800, 0.900, 0.900, 0.900]"),
        "{text}"
    );
    export(&session, &experiment, "ur", "ur.yaml", &more);
    let text = fs::read_to_string(session.folder().join("ur.yaml")).expect("a file");
    for (key, own_model, friction) in [
        ("coulomb", ROBOT[0], identified[0]),
        ("viscous", ROBOT[1], identified[1]),
    ] {
        let line = text
            .lines()
            .find_map(|own| own.trim().strip_prefix(&format!("{key}_scale: [")));
        let shares = line
            .and_then(|own| own.strip_suffix(']'))
            .expect("shares")
            .split(", ");
        let shares: Vec<f64> = shares.map(|own| own.parse().expect("a number")).collect();
        for (share, friction) in shares.iter().zip(friction) {
            assert!(
                (share - friction / own_model).abs() < 0.03,
                "{key}: {share} {friction}"
            );
        }
    }
}

/// Coulomb and viscous friction that the robot itself believes in, of every joint.
const ROBOT: [f64; 2] = [5.0, 7.0];

/// Coulomb and viscous friction of each joint, as an arm's file has them.
fn arms_friction(session: &Session, file: &str) -> [[f64; 6]; 2] {
    let text = fs::read_to_string(session.folder().join(file)).expect("a file");
    let arm: toml::Table = text.parse().expect("TOML");
    [("coulomb", "b_0"), ("viscous", "b_1")].map(|(effect, key)| {
        std::array::from_fn(|at| {
            let value = &arm["joint"][at]["friction"]["effects"][effect][key];
            value.as_float().expect("a number")
        })
    })
}

/// The same motion under the robot's compensation with its default shares.
fn under_compensation(session: &Session, name: &str) {
    let folder = session.folder();
    let text = fs::read_to_string(folder.join(format!("{name}.csv"))).expect("a recording");
    let (head, rows) = text.split_once('\n').expect("a head");
    let rows: Vec<Vec<f64>> = (rows.lines())
        .map(|row| {
            row.split(',')
                .map(|own| own.parse().expect("a number"))
                .collect()
        })
        .collect();
    let mut compensated = format!("{head}\n");
    for at in 5..rows.len() - 5 {
        let (before, after) = (&rows[at - 5], &rows[at + 5]);
        if after[0] - before[0] > 1.0 {
            continue;
        }
        let mut row = rows[at].clone();
        for joint in 0..6 {
            let velocity = (after[1 + joint] - before[1 + joint]) / (after[0] - before[0]);
            let [coulomb, viscous] = if joint == 2 { [0.7, 0.8] } else { [0.8, 0.9] };
            row[7 + joint] -=
                coulomb * ROBOT[0] * velocity.signum() + viscous * ROBOT[1] * velocity;
        }
        let row: Vec<String> = row.iter().map(f64::to_string).collect();
        compensated.push_str(&row.join(","));
        compensated.push('\n');
    }
    fs::write(folder.join("compensated.csv"), compensated).expect("scratch folder");
    let text = fs::read_to_string(folder.join(format!("{name}-with.toml"))).expect("a file");
    let text = text.replace(&format!("{name}.csv"), "compensated.csv");
    fs::write(folder.join("compensated.toml"), text).expect("scratch folder");
}

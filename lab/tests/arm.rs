//! Experiments about a whole arm: what the file says, and how all joints are read.
#![allow(clippy::unwrap_used)]

use std::{f64::consts::TAU, fmt::Write as _, fs, path::Path};

use ferntast_identification::{Verdict, arm::ArmTerm};
use ferntast_lab::{
    experiment::Experiment,
    work::{self, OpenedArm, Trend, open_arm, trends_of_arm},
};
use ferntast_model::{Joints, rigid_body::Vector3};
use tempfile::TempDir;

const URDF: &str = r#"<robot name="two"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial></link>
<link name="lower"><inertial><origin xyz="0.15 0 0"/><mass value="1"/>
<inertia ixx="0.005" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/>
<origin xyz="0.4 0 0"/><axis xyz="0 1 0"/></joint></robot>"#;

const ARM: &str =
    "recording = \"run.csv\"\n[arm]\nurdf = \"two.urdf\"\njoints = [\"shoulder\", \"elbow\"]\n";
const SIGNALS: &str = "[signals]\nposition = \"q_{joint}\"\nmotor_torque = \"tau_{joint}\"\n";
const MODEL: &str = "[model]\neffects = [\"coulomb\", \"viscous\"]\n";

/// A folder with the URDF and a recording of two sessions, in which a payload of 0.4 kg
/// hangs at the end of the lower arm where `loaded`.
fn folder(loaded: bool) -> TempDir {
    let ball = "<origin xyz=\"0.15 0 0\"/><mass value=\"1\"/>";
    // 1 kg at 0.15 m and 0.4 kg at 0.3 m: 1.4 kg at 0.193 m.
    let heavy = "<origin xyz=\"0.192857142857 0 0\"/><mass value=\"1.4\"/>";
    let inertia = 0.01 + 1.0 * 0.042857142857_f64.powi(2) + 0.4 * 0.107142857143_f64.powi(2);
    let turning = format!("iyy=\"{inertia}\" iyz=\"0\" izz=\"{inertia}\"");
    let truth = match loaded {
        true => URDF
            .replace(ball, heavy)
            .replace("iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"", &turning),
        false => URDF.to_owned(),
    };
    folder_of(&truth)
}

/// A folder with the URDF and a recording of an arm that is in truth another.
fn folder_of(truth: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("two.urdf"), URDF).unwrap();
    let robot = ferntast_urdf::Robot::read(truth.as_bytes()).unwrap();
    let chain = robot.of_joints(&["shoulder", "elbow"]).unwrap().chain;
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let mut text = "t,q_shoulder,q_elbow,tau_shoulder,tau_elbow\n".to_owned();
    let mut state = 1_u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for k in 0..2 {
        for i in 0..4000 {
            let t = f64::from(i) * 0.005;
            let mut values = [[0.0; 2]; 3];
            for joint in 0..2 {
                for (size, rate) in [(0.6, 0.13), (0.3, 0.41), (0.08, 0.9)] {
                    let rate = TAU * rate * (1.0 + 0.3 * f64::from(joint) + 0.05 * f64::from(k));
                    let (sine, cosine) = (rate * t + f64::from(joint + k)).sin_cos();
                    let at = joint as usize;
                    values[0][at] += size * sine;
                    values[1][at] += size * rate * cosine;
                    values[2][at] -= size * rate * rate * sine;
                }
            }
            let [q, qd, qdd] = values.map(|own| Joints::from_slice(&own).unwrap());
            let links = chain.inverse_dynamics(&q, &qd, &qdd, &gravity);
            let torque = [0, 1].map(|at| {
                let friction = 0.8 * qd[at].signum() + 0.5 * qd[at];
                links[at] + [0.3, 0.1][at] * qdd[at] + friction + 0.1 * noise()
            });
            let time = t + 100.0 * f64::from(k);
            writeln!(text, "{time},{},{},{},{}", q[0], q[1], torque[0], torque[1]).unwrap();
        }
    }
    fs::write(folder.path().join("run.csv"), text).unwrap();
    folder
}

fn open(folder: &TempDir, text: &str) -> OpenedArm {
    let path = folder.path().join("e.toml");
    fs::write(&path, text).unwrap();
    open_arm(&path).unwrap().unwrap()
}

fn refused(folder: &TempDir, text: &str) -> String {
    let path = folder.path().join("e.toml");
    Experiment::parse(text, &path, Path::new("/nowhere"))
        .unwrap_err()
        .to_string()
}

/// Each row of the recording (time, positions, torques) as `change` has it.
fn rewrite(folder: &TempDir, change: impl Fn([f64; 5]) -> [f64; 5]) {
    let run = folder.path().join("run.csv");
    let text = fs::read_to_string(&run).unwrap();
    let mut lines = text.lines();
    let mut changed = format!("{}\n", lines.next().unwrap());
    for line in lines {
        let own: Vec<f64> = line.split(',').map(|own| own.parse().unwrap()).collect();
        let [t, shoulder, elbow, torque, of_elbow] = change(own.try_into().unwrap());
        writeln!(changed, "{t},{shoulder},{elbow},{torque},{of_elbow}").unwrap();
    }
    fs::write(&run, changed).unwrap();
}

/// A recording whose elbow counts the other way round, from a quarter of a turn, and whose shoulder has its
/// torque the other way round: what is told of it is what mends it.
#[test]
fn joints_that_count_otherwise_are_told_with_the_lines_that_mend_them() {
    let folder = folder(false);
    rewrite(&folder, |[t, shoulder, elbow, torque, of_elbow]| {
        [t, shoulder, 0.25 * TAU - elbow, -torque, -of_elbow]
    });
    let opened = open(&folder, &format!("{ARM}{SIGNALS}{MODEL}"));
    let told = opened.diagnose(&mut |_| ()).unwrap();
    assert_eq!(told.verdict, Verdict::Unexplained);
    let told = opened.tell_misread(&told.misread);
    let mends =
        "reversed = [\"elbow\"]  torque_reversed = [\"shoulder\"]  zero = { elbow = 1.570796 }";
    assert!(
        told.last().is_some_and(|line| line.ends_with(mends)),
        "{told:#?}"
    );
    assert!(
        told[0].starts_with("shoulder: the torque counts the other way round; "),
        "{told:#?}"
    );
    let elbow = "elbow: position and torque count the other way round, and the position lacks +90 degrees; ";
    assert!(told[1].starts_with(elbow), "{told:#?}");
    let mended = format!("{ARM}{}\n{SIGNALS}{MODEL}", mends.replace("  ", "\n"));
    let opened = open(&folder, &mended);
    let told = opened.diagnose(&mut |_| ()).unwrap();
    assert_eq!(told.verdict, Verdict::Complete, "{told:#?}");
    assert!(told.misread.is_empty());

    let other = mended.replace("reversed = [\"elbow\"]", "reversed = [\"wrist\"]");
    let error = refused(&folder, &other);
    assert!(
        error.contains("\"wrist\" is no joint of the arm: they are shoulder, elbow"),
        "{error}"
    );
}

/// Each torque of the recording times what `factors` says of its joint.
fn with_torques(folder: &TempDir, factors: [f64; 2]) {
    rewrite(folder, |[t, shoulder, elbow, torque, of_elbow]| {
        [
            t,
            shoulder,
            elbow,
            torque * factors[0],
            of_elbow * factors[1],
        ]
    });
}

/// Drives of 12.5 and 8 Nm/A, of which the elbow's counts its current the other way round.
#[test]
fn currents_are_told_by_the_weight_of_the_links_and_drive_gains_make_torques_of_them() {
    let folder = folder(false);
    let plain = format!("{ARM}{SIGNALS}{MODEL}");
    let torques = open(&folder, &plain).compare().unwrap();
    with_torques(&folder, [1.0 / 12.5, -1.0 / 8.0]);
    let opened = open(&folder, &plain);
    let found = opened.diagnose(&mut |_| ()).unwrap();
    assert_eq!(
        (found.verdict, found.candidates.len()),
        (Verdict::Unexplained, 0)
    );
    let gains: Vec<f64> = (found.misread.iter().filter_map(|own| own.torque_of_one)).collect();
    assert!((gains[0] / 12.5 - 1.0).abs() < 0.02 && (gains[1] / 8.0 - 1.0).abs() < 0.02);
    let told = opened.tell_misread(&found.misread).join("\n");
    for part in [
        "shoulder: the torque is not in Nm: by the weight of its links 1 of it is some 12.",
        "elbow: the torque counts the other way round, and the torque is not in Nm",
        "drive_gain = [12.",
        "torque_reversed = [\"elbow\"]",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }

    // As the makers say, the same comes out as of torques.
    let turned = "drive_gain = [12.5, 8]\ntorque_reversed = [\"elbow\"]\n";
    let amperes = SIGNALS.replace(
        "\"tau_{joint}\"",
        "{ column = \"tau_{joint}\", unit = \"A\" }",
    );
    for signals in [SIGNALS, &amperes] {
        let opened = open(&folder, &format!("{ARM}{turned}{signals}{MODEL}"));
        let found = opened.compare().unwrap();
        assert!(found.misread.is_empty());
        for (joint, own) in &torques.joints {
            let [now, then] = [&found.joints[joint], own].map(|own| own.parameters["b0"].value);
            assert!((now - then).abs() < 1e-6, "{joint}: {now} {then}");
            assert_eq!(found.joints[joint].parameters["b0"].unit, "Nm");
        }
    }
    with_torques(&folder, [1e3, 1e3]);
    let milliamperes = amperes.replace("\"A\"", "\"mA\"");
    let opened = open(&folder, &format!("{ARM}{turned}{milliamperes}{MODEL}"));
    let found = opened.compare().unwrap();
    assert!((found.joints["elbow"].parameters["b0"].value - 0.8).abs() < 0.01);

    let unknown = refused(&folder, &format!("{ARM}{amperes}{MODEL}"));
    assert!(
        unknown.contains("write [arm] drive_gain = [Nm/A, one for each joint]"),
        "{unknown}"
    );
    let twice = amperes.replace("\"A\"", "\"Nm\"");
    let twice = refused(&folder, &format!("{ARM}{turned}{twice}{MODEL}"));
    assert!(
        twice.contains("\"Nm\" of shoulder is one of torques"),
        "{twice}"
    );
    let count = refused(
        &folder,
        &format!("{ARM}drive_gain = [12.5]\n{SIGNALS}{MODEL}"),
    );
    assert!(
        count.contains("arm.drive_gain: 1 values for 2 joints"),
        "{count}"
    );
}

/// Links half as heavy as the file says, and a load on top of them: those are no other units.
#[test]
fn a_wrong_weight_is_not_another_unit() {
    let light = URDF.replace("mass value=\"1\"", "mass value=\"0.5\"");
    for folder in [
        folder_of(&light.replace("mass value=\"2\"", "mass value=\"1\"")),
        folder(true),
    ] {
        let opened = open(&folder, &format!("{ARM}{SIGNALS}{MODEL}"));
        let found = opened.compare().unwrap();
        assert_eq!(found.misread, Vec::new());
    }
}

/// The same arm empty and with 0.4 kg at its end: the load came, and no joint changed.
#[test]
fn what_came_on_an_arm_is_told_of_the_arm_and_not_of_its_joints() {
    let (empty, loaded) = (folder(false), folder(true));
    let run = loaded.path().join("run.csv");
    fs::copy(run, empty.path().join("loaded.csv")).unwrap();
    let text = format!("{ARM}armature = [0.3, 0.1]\n{SIGNALS}{MODEL}");
    let files = ["run.csv", "loaded.csv"].map(|recording| {
        let path = empty.path().join(recording).with_extension("toml");
        fs::write(&path, text.replace("run.csv", recording)).unwrap();
        open_arm(&path).unwrap().unwrap()
    });
    let trends = trends_of_arm(&files, true, &mut |_| ()).unwrap();
    let titles: Vec<&str> = trends
        .iter()
        .skip(1)
        .map(|own| own.title.as_str())
        .collect();
    assert_eq!(titles, ["shoulder", "elbow"]);
    let [arm, joints @ ..] = trends.as_slice() else {
        panic!("{trends:#?}")
    };
    let [turn] = arm.came_or_went.as_slice() else {
        panic!("{arm:#?}")
    };
    assert!(turn.effect == "payload" && turn.came && turn.by_diagnosis);
    let named = |own: &Trend| own.points.iter().any(|point| point.missing.is_some());
    assert!(!joints.iter().any(named), "{joints:#?}");

    // Where the model has it, its mass is beside that of nothing.
    let payload = text.replace("\"viscous\"]", "\"viscous\", \"payload\"]");
    let path = empty.path().join("loaded.toml");
    fs::write(&path, payload.replace("run.csv", "loaded.csv")).unwrap();
    let files = [files[0].clone(), open_arm(&path).unwrap().unwrap()];
    let trends = trends_of_arm(&files, false, &mut |_| ()).unwrap();
    assert_eq!(trends[0].effects, ["payload"]);
    let mut parameters = trends[0].parameters.iter();
    let mass = parameters.find(|own| own.name == "payload.mass").unwrap();
    let change = mass.change.as_ref().unwrap();
    assert!(
        (change.change - 0.4).abs() < 0.02 && change.exceeds_errors,
        "{mass:#?}"
    );
    let b0 = trends[2].parameters.iter().find(|own| own.name == "b0");
    assert!(!b0.unwrap().changes);

    // Of one file, its sessions; with another arm, nothing.
    let sessions = trends_of_arm(&files[..1], false, &mut |_| ()).unwrap();
    assert_eq!(sessions[1].points.len(), 2);
    let turned = text.replace("[\"shoulder\", \"elbow\"]", "[\"shoulder\"]");
    fs::write(&path, turned.replace("[0.3, 0.1]", "[0.3]")).unwrap();
    let files = [files[0].clone(), open_arm(&path).unwrap().unwrap()];
    let refused = trends_of_arm(&files, false, &mut |_| ())
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("joints shoulder, elbow, another one shoulder"),
        "{refused}"
    );
}

#[test]
fn armatures_that_are_not_given_are_fitted_with_friction_joint_by_joint() {
    let folder = folder(false);
    let opened = open(&folder, &format!("{ARM}{SIGNALS}{MODEL}"));
    let found = opened.compare().unwrap();
    for (joint, inertia) in [("shoulder", 0.3), ("elbow", 0.1)] {
        let own = &found.joints[joint];
        let value = |name: &str| own.parameters[name].value;
        assert!((value("inertia") - inertia).abs() < 0.01 * inertia);
        assert!((value("b0") - 0.8).abs() < 0.01 && (value("b1") - 0.5).abs() < 0.02);
        // Uniform noise of 0.1 Nm between its ends.
        assert!(own.rms.held_out > 0.004 && own.rms.held_out < 0.03);
    }
    // A list of columns is the same.
    let listed = SIGNALS.replace("\"q_{joint}\"", "[\"q_shoulder\", \"q_elbow\"]");
    let again = open(&folder, &format!("{ARM}{listed}{MODEL}"));
    assert_eq!(again.dataset, opened.dataset);
    // Each joint can be looked at by itself.
    let joints = work::open(&folder.path().join("e.toml")).unwrap();
    let titles = joints.iter().map(|own| own.experiment.title.as_str());
    assert_eq!(titles.collect::<Vec<_>>(), ["shoulder", "elbow"]);
    let alone = joints[1].compare().unwrap();
    assert_eq!(alone.rms, found.joints["elbow"].rms);
}

#[test]
fn a_joint_that_is_left_out_is_told_to_stand_at_zero() {
    let folder = folder(false);
    assert_eq!(
        open(&folder, &format!("{ARM}{SIGNALS}{MODEL}")).notes,
        [""; 0]
    );
    let only = ARM.replace(", \"elbow\"", "");
    let notes = open(&folder, &format!("{only}{SIGNALS}{MODEL}")).notes;
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].starts_with("elbow of ") && notes[0].contains("taken to stand at zero"));
}

#[test]
fn what_is_missing_in_an_arm_is_written_into_its_file() {
    let folder = folder(true);
    let given = format!("{ARM}armature = [0.3, 0.1]\n{SIGNALS}{MODEL}");
    let opened = open(&folder, &given);
    let told = opened.diagnose(&mut |_| ()).unwrap();
    assert_eq!(told.candidates[0].named.effect, "payload");
    let elsewhere = folder.path().join("steps");
    fs::create_dir(&elsewhere).unwrap();
    let output = elsewhere.join("e2.toml");
    let payload = ArmTerm::parse("payload");
    let added = opened.add(&payload, &output).unwrap();
    assert!(added.held_out_after < 0.2 * added.held_out_before);
    assert!((added.parameters["payload.mass"].value - 0.4).abs() < 0.01);
    assert!((added.parameters["payload.x"].value - 0.3).abs() < 0.01);
    // URDF and recording are found from there, too.
    let text = fs::read_to_string(&output).unwrap();
    assert!(text.contains("urdf = \"../two.urdf\""), "{text}");
    let second = open_arm(&output).unwrap().unwrap();
    let left = second.diagnose(&mut |_| ()).unwrap();
    assert_eq!(left.verdict, Verdict::Complete, "{:#?}", left.candidates);
    assert!(second.add(&payload, &elsewhere.join("e3.toml")).is_err());
}

#[test]
fn mistakes_in_the_file_are_told_with_their_key() {
    let folder = folder(false);
    let all = format!("{ARM}{SIGNALS}{MODEL}");
    let with = |old: &str, new: &str| refused(&folder, &all.replace(old, new));
    assert!(with("two.urdf", "three.urdf").contains("three.urdf"));
    assert!(with("\"elbow\"]", "\"elbo\"]").contains("did you mean \"elbow\"?"));
    let none = with("joints = [\"shoulder\", \"elbow\"]\n", "");
    assert!(
        none.contains("arm.joints") && none.contains("shoulder, elbow"),
        "{none}"
    );
    let one = with("\"q_{joint}\"", "\"q_elbow\"");
    assert!(
        one.contains("signals.position") && one.contains("one path or column"),
        "{one}"
    );
    let count = with("\"q_{joint}\"", "[\"q_elbow\"]");
    assert!(count.contains("1 paths for 2 joints"), "{count}");
    let armature = with("[signals]", "armature = [1]\n[signals]");
    assert!(
        armature.contains("arm.armature: 1 values for 2 joints"),
        "{armature}"
    );
    let inertia = with("[model]", "[model]\ninertia = 1");
    assert!(
        inertia.contains("armature and gear_ratio in [arm]"),
        "{inertia}"
    );
    let unit = with(
        "\"tau_{joint}\"",
        "{ column = \"tau_{joint}\", unit = \"A\" }",
    );
    assert!(
        unit.contains("signals.motor_torque") && unit.contains("Nm"),
        "{unit}"
    );
    let both = with("[model]", "[joint]\n[model]");
    assert!(both.contains("one of the three"), "{both}");
}

#[test]
fn arrays_of_messages_are_matched_by_name() {
    let folder = folder(false);
    let signals =
        "[signals]\nposition = \"/js.position.@deg2rad\"\nmotor_torque = \"/js.effort\"\n";
    let text = format!("{ARM}{signals}{MODEL}").replace("run.csv", "run.mcap");
    let path = folder.path().join("e.toml");
    let read = Experiment::parse(&text, &path, Path::new("/nowhere")).unwrap();
    assert_eq!(
        read.signals.position,
        "/js.position[:]{name==\"shoulder\"}.@deg2rad"
    );
    let other = &read.signals.extra["motor_torque@elbow"];
    assert_eq!(other, "/js.effort[:]{name==\"elbow\"}");
}

/// A recording of no body: the lower arm turns as if its inertia about its centre were
/// below zero. Least squares says so; what is reported can exist, and errs by more.
#[test]
fn a_link_that_cannot_exist_is_held_at_the_nearest_that_can() {
    let text = |effects: &str| format!("{ARM}{SIGNALS}[model]\neffects = [{effects}]\n");
    let free = text("\"coulomb\", \"viscous\", \"link_inertia@elbow\"");
    let heavy = folder(true);
    let found = open(&heavy, &free).compare().unwrap();
    assert!(found.held_possible.is_empty(), "{found:#?}");
    let less = "iyy=\"-0.02\" iyz=\"0\" izz=\"0.01\"";
    let impossible = folder_of(&URDF.replace("iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"", less));
    let opened = open(&impossible, &free);
    let held = opened.compare().unwrap();
    assert_eq!(held.held_possible, ["link_inertia@elbow"]);
    let parts = opened.take_apart(&|_| true).unwrap();
    for link in &parts.body.links {
        let eigenvalues = link.pseudo_inertia().symmetric_eigenvalues();
        assert!(eigenvalues.min() > 0.0, "{link:?}");
    }
    // The noise is 0.029 Nm; the believed inertia would err by about 0.03 kg m² times q̈.
    let errs = held.joints["elbow"].rms.held_out;
    assert!(errs > 0.03 && errs < 0.2, "{errs}");
}

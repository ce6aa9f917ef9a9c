//! Arms out of URDF files against independent libraries: Pinocchio and MuJoCo.

use std::path::Path;

use ferntast_model::{
    Joints,
    rigid_body::{Chain, JointKind, LINK_PARAMETERS, Vector3},
};
use ferntast_urdf::{Arm, Robot};
use serde_json::{Value, json};

use super::numbers::Numbers;

/// Arms that have to be among those compared with both.
const ARMS: [&str; 6] = ["panda", "ur5_robot", "xarm7", "kinova", "z1", "so101"];
const STATES: usize = 5;
const GRAVITY: [f64; 3] = [0.4, -0.7, -9.81];
/// How far apart numbers may be, in parts of their own size.
const APART: f64 = 1e-12;

/// An arm out of a file, and states to compare in.
struct Case {
    file: String,
    arm: Arm,
    states: Vec<[Joints<f64>; 3]>,
}

impl Case {
    /// The longest arm of at most eight joints from the file's first link that nothing
    /// carries; `None` where there is none.
    fn of(file: &str, numbers: &mut Numbers) -> Option<Case> {
        let text = std::fs::read(file).expect("a file");
        let robot = Robot::read(&text).ok()?;
        let carried = |link: usize| robot.joints.iter().any(|joint| joint.child == link);
        let root = (0..robot.links.len()).find(|link| !carried(*link))?;
        let tips = robot.links.iter();
        let arms = tips.filter_map(|tip| robot.between(&robot.links[root].name, &tip.name).ok());
        let arm = arms.max_by_key(|arm| arm.joints.len())?;
        let kinds = arm.chain.kinds();
        let mut values = |turning: f64, sliding: f64| {
            kinds.map(|kind| match kind {
                JointKind::Revolute => turning * numbers.next(),
                JointKind::Prismatic => sliding * numbers.next(),
            })
        };
        let states = (0..STATES)
            .map(|_| [values(3.0, 0.5), values(2.0, 0.5), values(5.0, 2.0)])
            .collect();
        let file = file.to_owned();
        Some(Case { file, arm, states })
    }

    fn name(&self) -> &str {
        let name = Path::new(&self.file).file_stem();
        name.and_then(|name| name.to_str()).unwrap_or_default()
    }

    fn asked(&self) -> Value {
        let list = |values: &Joints<f64>| values.to_vec();
        json!({
            "file": self.file, "joints": self.arm.joints, "tip": self.arm.tip, "gravity": GRAVITY,
            "states": self.states.iter().map(|[q, qd, qdd]| {
                json!({"q": list(q), "qd": list(qd), "qdd": list(qdd)})
            }).collect::<Vec<_>>(),
        })
    }

    /// How far what a library told is from ours, at most, in parts of its size.
    fn apart(&self, told: &Value) -> f64 {
        let states = told["states"].as_array().expect("states");
        assert_eq!(states.len(), self.states.len());
        let pairs = std::iter::zip(&self.states, states);
        pairs
            .map(|(state, theirs)| state_apart(&self.arm.chain, state, theirs))
            .fold(0.0, f64::max)
    }
}

fn state_apart(chain: &Chain, [q, qd, qdd]: &[Joints<f64>; 3], theirs: &Value) -> f64 {
    let (joints, gravity) = (q.len(), Vector3::from(GRAVITY));
    let (tip, jacobian) = chain.forward_and_jacobian(q);
    let mass = chain.mass_matrix(q);
    let regressor = chain.torque_regressor(q, qd, qdd, &gravity);
    let rows = |rows: usize, columns: usize, value: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
        (0..rows)
            .flat_map(|row| (0..columns).map(move |column| value(row, column)))
            .collect()
    };
    let ours = [
        (
            "torque",
            chain.inverse_dynamics(q, qd, qdd, &gravity).to_vec(),
        ),
        ("mass_matrix", rows(joints, joints, &|a, b| mass[(a, b)])),
        ("jacobian", rows(6, joints, &|a, b| jacobian[(a, b)])),
        ("rotation", rows(3, 3, &|a, b| tip.rotation[(a, b)])),
        ("translation", tip.translation.iter().copied().collect()),
        (
            "regressor",
            rows(joints, joints * LINK_PARAMETERS, &|a, b| regressor[(a, b)]),
        ),
    ];
    ours.iter()
        .filter(|(name, _)| theirs.get(name).is_some())
        .map(|(name, ours)| apart(ours, &flat(&theirs[name])))
        .fold(0.0, f64::max)
}

/// The numbers of a list, or of a list of rows.
fn flat(value: &Value) -> Vec<f64> {
    match value.as_array() {
        Some(rows) => rows.iter().flat_map(flat).collect(),
        None => vec![value.as_f64().expect("a number")],
    }
}

fn apart(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
    let difference = norm(&mut std::iter::zip(ours, theirs).map(|(a, b)| a - b));
    difference / norm(&mut theirs.iter().copied()).max(1e-12)
}

fn ask(input: &Value) -> Value {
    ferntast_tests::ask_python(&ferntast_tests::peer("rigid_body.py"), input)
}

#[test]
fn arms_out_of_urdf_files_are_those_of_independent_libraries() {
    let mut numbers = Numbers::new(0x2005_0126);
    let listed = ask(&json!({}));
    let files = listed["files"].as_array().expect("files");
    let files = files.iter().map(|file| file.as_str().expect("a path"));
    let cases: Vec<Case> = files
        .filter_map(|file| Case::of(file, &mut numbers))
        .collect();
    let asked: Vec<Value> = cases.iter().map(Case::asked).collect();
    let told = ask(&json!({ "arms": asked }));
    let told = told["arms"].as_array().expect("arms");
    assert_eq!(told.len(), cases.len());

    let mut compared = [Vec::new(), Vec::new()];
    for (case, told) in cases.iter().zip(told) {
        let name = case.name();
        print!(
            "{name}, {} joints to {}",
            case.arm.joints.len(),
            case.arm.tip
        );
        for (library, names) in ["pinocchio", "mujoco"].iter().zip(&mut compared) {
            let told = &told[library];
            if let Some(why) = told["refused"].as_str() {
                print!(
                    "; {library} refuses it: {}",
                    why.lines().next().unwrap_or_default()
                );
                continue;
            }
            let apart = case.apart(told);
            print!("; {apart:.1e} from {library}");
            assert!(apart < APART, "{name}: {apart} from {library}");
            names.push(name);
        }
        println!();
    }
    println!(
        "compared: {} with Pinocchio, {} with MuJoCo",
        compared[0].len(),
        compared[1].len()
    );
    for (name, names) in ARMS
        .iter()
        .flat_map(|name| compared.iter().map(move |c| (name, c)))
    {
        assert!(names.contains(name), "{name} was not compared with both");
    }
}

/// A comparison that could not fail would say nothing.
#[test]
fn an_arm_with_another_mass_is_seen_to_be_another() {
    let mut numbers = Numbers::new(1);
    let listed = ask(&json!({}));
    let files = listed["files"].as_array().expect("files");
    let panda = files
        .iter()
        .filter_map(Value::as_str)
        .find(|file| file.ends_with("/panda.urdf"));
    let mut case = Case::of(panda.expect("panda"), &mut numbers).expect("an arm");
    let told = ask(&json!({ "arms": [case.asked()] }));
    let text = std::fs::read_to_string(&case.file).expect("a file");
    let changed = text.replacen("<mass value=\"4.970684\"/>", "<mass value=\"4.98\"/>", 1);
    assert_ne!(changed, text);
    let robot = Robot::read(changed.as_bytes()).expect("readable");
    case.arm = robot.of_joints(&case.arm.joints).expect("an arm");
    assert!(case.apart(&told["arms"][0]["pinocchio"]) > 1e-6);
}

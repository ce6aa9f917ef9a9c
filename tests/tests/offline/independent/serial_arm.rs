//! The simulated arm of any joints against an independent library: MuJoCo.

use ferntast_drivers::{
    Driver, DriverCommand, Reading,
    process::{Greeting, Patience, ProcessPlant},
};
use ferntast_model::{Joints, rigid_body::Vector3};
use ferntast_msgs::sample::JointNames;
use ferntast_nodes::node::NodeHealth;
use ferntast_sim::serial_arm::{SerialArm, SerialArmParameters, SerialJointParameters};
use ferntast_urdf::{Arm, Robot};
use serde_json::{Value, json};

use super::numbers::Numbers;

/// Files of `example-robot-data`, the last link, and the joint before it.
const ARMS: [(&str, &str, usize); 3] = [
    ("panda.urdf", "panda_hand", 7),
    ("ur5_robot.urdf", "ee_link", 6),
    ("xarm7.urdf", "link_eef", 7),
];
const GRAVITY: [f64; 3] = [0.4, -0.7, -9.81];
const ARMATURE: f64 = 0.1;
/// Length of a step of torques \[s\], and how many there are.
const HOLD: f64 = 0.01;
const STEPS: usize = 100;

fn arm(files: &[&str], (file, tip, joints): (&str, &str, usize)) -> (String, Arm) {
    let path = files
        .iter()
        .find(|path| path.ends_with(&format!("/{file}")));
    let path = path.unwrap_or_else(|| panic!("{file} in example-robot-data"));
    let robot = Robot::read(&std::fs::read(path).expect("a file")).expect("a robot");
    let root = robot.links.iter().find_map(|link| {
        let arm = robot.between(&link.name, tip).ok()?;
        (arm.joints.len() == joints).then_some(arm)
    });
    ((*path).to_owned(), root.expect("an arm"))
}

#[test]
fn arms_without_friction_move_as_an_independent_library_has_them() {
    let listed = ferntast_tests::ask_python(&ferntast_tests::peer("rigid_body.py"), &json!({}));
    let files = listed["files"].as_array().expect("files");
    let files: Vec<&str> = files.iter().filter_map(Value::as_str).collect();
    let mut numbers = Numbers::new(0x2005_0126);
    let cases = ARMS.map(|known| {
        let (path, arm) = arm(&files, known);
        let count = arm.chain.count();
        let mut values =
            |scale: f64| -> Vec<f64> { (0..count.get()).map(|_| scale * numbers.next()).collect() };
        let start = values(1.0);
        let torques: Vec<Vec<f64>> = (0..STEPS).map(|_| values(8.0)).collect();
        let asked = json!({
            "file": path, "joints": arm.joints, "tip": arm.tip, "gravity": GRAVITY,
            "armature": vec![ARMATURE; count.get()], "start": start, "torques": torques, "hold": HOLD,
        });
        (arm, start, torques, asked)
    });
    let asked: Vec<&Value> = cases.iter().map(|(.., asked)| asked).collect();
    let peer = ferntast_tests::peer("mujoco_urdf.py");
    let told = ferntast_tests::ask_python(&peer, &json!({ "arms": asked }));
    for ((arm, start, torques, _), told) in cases.iter().zip(told["arms"].as_array().expect("arms"))
    {
        let parameters = SerialArmParameters {
            substep: Some(2e-5),
            start_position: start.clone(),
            gravity: GRAVITY,
            joint: vec![SerialJointParameters {
                motor_inertia: Some(ARMATURE),
                ..Default::default()
            }],
            ..Default::default()
        };
        let limits = Joints::filled(arm.chain.count(), 1e6);
        let mut ours = SerialArm::new(&arm.chain, &limits, &parameters, 1).expect("an arm");
        let begin = ours.truth();
        let (mut worst, mut farthest, mut away) = (0.0_f64, 0.0_f64, 0.0_f64);
        let motion = told["motion"].as_array().expect("motion");
        assert_eq!(motion.len(), STEPS);
        for (torque, theirs) in torques.iter().zip(motion) {
            ours.advance(&Joints::from_slice(torque).expect("torques"), HOLD);
            let truth = ours.truth();
            let number = |key: &str, index: usize| theirs[key][index].as_f64().expect("a number");
            for (joint, from) in start.iter().enumerate() {
                worst = worst.max((truth.position[joint] - number("q", joint)).abs());
                farthest = farthest.max((truth.position[joint] - from).abs());
            }
            for axis in 0..3 {
                away = away.max((truth.tip.translation[axis] - number("tip", axis)).abs());
            }
        }
        let gained = ours.truth().energy - begin.energy - ours.truth().motor_work;
        println!(
            "{}: {worst:.1e} rad and {away:.1e} m apart on a way of {farthest:.1} rad; {gained:.1e} J gained",
            arm.tip
        );
        assert!(farthest > 1.0, "it hardly moved: {farthest} rad");
        assert!(worst < 2e-6 && away < 1e-6, "{worst} rad, {away} m");
        assert!(gained.abs() < 1e-3, "{gained} J");
    }
}

/// Where the arm begins, and the wall under it: the tip comes down on it.
const HOME: [f64; 7] = [0.0, 0.3, 0.0, -1.9, 0.0, 2.2, 0.0];
const BELOW: f64 = 0.02;
const TICKS: usize = 1500;

/// What is the same in both: the file of an arm with a surface of `stiffness` \[N/m\] below its tip.
fn file(path: &str, arm: &Arm, stiffness: f64) -> Value {
    let tip = arm.chain.forward(&Joints::from(HOME)).translation;
    let urdf = std::fs::read_to_string(path).expect("a file");
    json!({
        "urdf": urdf, "base": arm.base, "tip": arm.tip, "gravity": [0.0, 0.0, -9.80665],
        "home": HOME, "joint": vec![json!({"motor_inertia": ARMATURE}); 7],
        "surface": [{
            "name": "table", "point": [tip.x, tip.y, tip.z - BELOW], "normal": [0.0, 0.0, 1.0],
            "stiffness": stiffness, "damping": 0.02 * stiffness.sqrt() * 30.0, "friction": 0.0,
        }],
    })
}

/// Joint torques that carry the arm and pull each joint towards home, and the tip downwards.
fn torque(arm: &Arm, tick: usize, position: &Joints<f64>, velocity: &Joints<f64>) -> Joints<f64> {
    let rest = Joints::filled(position.count(), 0.0);
    let gravity = Vector3::new(0.0, 0.0, -9.80665);
    let weight = arm.chain.inverse_dynamics(position, &rest, &rest, &gravity);
    let jacobian = arm.chain.jacobian(position);
    let down = 30.0 * (tick as f64 / 500.0).min(1.0);
    Joints::from_fn(position.count(), |joint| {
        weight[joint] + 50.0 * (HOME[joint] - position[joint])
            - 8.0 * velocity[joint]
            - down * jacobian[(2, joint)]
    })
}

/// Upward force on the tip and its height, tick by tick, of an arm that is stepped.
fn pressed(
    arm: &Arm,
    mut step: impl FnMut(&Joints<f64>, f64) -> (Reading, [f64; 2]),
) -> Vec<[f64; 2]> {
    let zero = Joints::filled(arm.chain.count(), 0.0);
    let (mut reading, _) = step(&zero, 0.0);
    let ticks = (0..TICKS).map(|tick| {
        let torque = torque(arm, tick, &reading.position, &reading.velocity);
        let (next, told) = step(&torque, 1e-3);
        reading = next;
        told
    });
    ticks.collect()
}

fn by_mujoco(arm: &Arm, file: &Value) -> Vec<[f64; 2]> {
    let names = JointNames::new(arm.joints.iter().map(String::as_str)).expect("names");
    let greeting = Greeting::new(&names, 1e-3, 1, file.clone());
    let command = format!(
        "'{}' '{}'",
        ferntast_tests::python().display(),
        ferntast_tests::peer("mujoco_plant.py").display()
    );
    let plant = ProcessPlant::start(&command, names, &greeting, Patience::default());
    let mut plant = plant.unwrap_or_else(|error| panic!("{error}"));
    pressed(arm, |torque, elapsed| {
        let mut health = NodeHealth::default();
        let command = DriverCommand {
            torque: *torque,
            elapsed: Some(elapsed),
        };
        plant.write(&command, &mut health);
        let reading = plant.read(&mut health).expect("a reading");
        let (force, tip) = (plant.truth().contact_force, plant.truth().tip);
        (
            reading,
            [force.expect("a force")[2], tip.expect("a tip")[2]],
        )
    })
}

fn by_ours(arm: &Arm, file: &Value) -> Vec<[f64; 2]> {
    let own = &file["surface"][0];
    let object = json!({
        "name": "table", "shape": {"kind": "plane", "point": own["point"], "normal": own["normal"]},
        "surface": {"stiffness": own["stiffness"], "damping": own["damping"], "friction": 0.0,
            "tangential_stiffness": 1.0, "tangential_damping": 0.0},
    });
    let parameters = SerialArmParameters {
        start_position: HOME.to_vec(),
        joint: vec![SerialJointParameters {
            motor_inertia: Some(ARMATURE),
            ..Default::default()
        }],
        object: vec![serde_json::from_value(object).expect("an object")],
        ..Default::default()
    };
    let limits = Joints::filled(arm.chain.count(), 1e6);
    let mut ours = SerialArm::new(&arm.chain, &limits, &parameters, 1).expect("an arm");
    pressed(arm, |torque, elapsed| {
        ours.advance(torque, elapsed);
        let truth = ours.truth();
        let reading = Reading {
            position: truth.position,
            velocity: truth.velocity,
            joint_torque: None,
            motor_torque: None,
            temperature: None,
        };
        (reading, [truth.force.z, truth.tip.translation.z])
    })
}

/// Contact on walls of three stiffnesses: MuJoCo as the plant in a program of its own gives the
/// same bytes again, and its force and ours are one.
#[test]
fn a_tip_that_presses_feels_what_it_feels_in_an_independent_library() {
    let listed = ferntast_tests::ask_python(&ferntast_tests::peer("rigid_body.py"), &json!({}));
    let files = listed["files"].as_array().expect("files");
    let files: Vec<&str> = files.iter().filter_map(Value::as_str).collect();
    let (path, arm) = arm(&files, ARMS[0]);
    for stiffness in [200.0, 2e3, 2e4] {
        let file = file(&path, &arm, stiffness);
        let theirs = by_mujoco(&arm, &file);
        assert_eq!(theirs, by_mujoco(&arm, &file), "twice the same");
        let ours = by_ours(&arm, &file);
        let peak = |told: &[[f64; 2]]| told.iter().map(|own| own[0]).fold(0.0, f64::max);
        let apart = std::iter::zip(&ours, &theirs).map(|(a, b)| (a[0] - b[0]).abs());
        let apart = apart.fold(0.0, f64::max);
        let [force, height] = *theirs.last().expect("ticks");
        let surface = file["surface"][0]["point"][2].as_f64().expect("a number");
        let spring = stiffness * (surface - height);
        println!(
            "{stiffness} N/m: {:.2} and {:.2} N at most, {apart:.2} N apart; in the end {force:.3} N, the spring {spring:.3} N",
            peak(&ours),
            peak(&theirs)
        );
        assert!(force > 10.0 && (force - spring).abs() < 0.03 * force);
        assert!((peak(&ours) - peak(&theirs)).abs() < 0.02 * peak(&theirs));
        assert!(apart < 0.02 * peak(&theirs));
    }
}

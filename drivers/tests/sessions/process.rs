//! A plant in a program of its own: it is the arm of a session in virtual time, as repeatable
//! as it is itself, and whatever it does wrong is told in words.

use std::time::Duration;

use ferntast_bus::Depth;
use ferntast_drivers::{
    ArmInput, ArmNode, ArmOutput, Driver, DriverCommand,
    process::{Greeting, Patience, PlantError, ProcessPlant},
};
use ferntast_model::Joints;
use ferntast_msgs::{
    Time,
    sample::{Fault, JointNames, Level, OperatingState},
    topics,
};
use ferntast_nodes::{
    lockstep::{LockstepSession, RunError},
    node::{Node, NodeHealth, Output},
    process::SessionContext,
    session_graph,
};

use crate::common::scenario;

const TICK: f64 = 1e-3;

/// The least plant there is, which fails as it is told to.
fn command(options: &str) -> String {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../tests/python/peers/sliding_masses.py"
    );
    format!("python3 '{file}' {options}")
}

fn names() -> JointNames {
    JointNames::new(["lift", "reach", "turn"]).expect("a session with a plant")
}

fn start_with(command: &str, patience: Patience) -> Result<ProcessPlant, PlantError> {
    let greeting = Greeting::new(&names(), TICK, 1, serde_json::Value::Null);
    ProcessPlant::start(command, names(), &greeting, patience)
}

fn start(options: &str) -> Result<ProcessPlant, PlantError> {
    start_with(&command(options), Patience::default())
}

/// What goes wrong within 10 ms, and the faults that it raises.
fn told(options: &str, patience: Patience) -> (String, NodeHealth) {
    let mut plant = start_with(&command(options), patience).expect("a session with a plant");
    for step in 0..10 {
        let command = DriverCommand {
            torque: Joints::from([1.0; 3]),
            elapsed: (step > 0).then_some(TICK),
        };
        let mut health = NodeHealth::default();
        plant.write(&command, &mut health);
        if plant.read(&mut health).is_none() {
            // It stays so.
            assert_eq!(plant.read(&mut health), None);
            return (plant.failure().expect("a session with a plant"), health);
        }
    }
    panic!("nothing went wrong");
}

#[test]
fn masses_move_as_newton_says_whatever_the_order_of_their_names() {
    for options in ["", "--joints turn lift reach"] {
        let mut plant = start(options).unwrap();
        assert!(plant.measures().joint_torque && !plant.measures().temperature);
        let torque = Joints::from([1.0, -2.0, 4.0]);
        let mut last = None;
        for step in 0..=100 {
            let elapsed = (step > 0).then_some(TICK);
            let mut health = NodeHealth::default();
            plant.write(&DriverCommand { torque, elapsed }, &mut health);
            last = plant.read(&mut health);
            assert_eq!(health.level, Level::OK);
        }
        let reading = last.unwrap();
        for joint in 0..3 {
            // 2 kg for 0.1 s.
            let speed = torque[joint] / 2.0 * 0.1;
            assert!((reading.velocity[joint] - speed).abs() < 1e-12);
            assert!((reading.position[joint] - speed * 0.0505).abs() < 1e-12);
        }
        assert_eq!(reading.motor_torque, Some(torque));
        let energy = plant.truth().energy.unwrap();
        assert!((energy - (0.05_f64.powi(2) + 0.1_f64.powi(2) + 0.2_f64.powi(2))).abs() < 1e-12);
    }
}

#[test]
fn a_plant_that_does_not_fit_is_refused_before_anything_moves() {
    let error = |result: Result<ProcessPlant, PlantError>| result.err().unwrap().to_string();
    let other = error(start("--joints lift reach grip"));
    assert!(
        other.contains("has the joints lift, reach, grip where lift, reach, turn"),
        "{other}"
    );
    let fewer = error(start("--joints lift reach"));
    assert!(
        fewer.contains("where lift, reach, turn are needed"),
        "{fewer}"
    );
    let quick = Patience {
        greeting: Duration::from_millis(300),
        ..Patience::default()
    };
    let silent = error(start_with("sleep 60", quick));
    assert!(
        silent.contains("silent for 0.3 s, at the greeting"),
        "{silent}"
    );
    let missing = error(start_with("/nowhere/plant", Patience::default()));
    assert!(
        missing.contains("has ended at the greeting, with exit status: 127"),
        "{missing}"
    );
    let talks = error(start_with("echo hello", Patience::default()));
    assert!(
        talks.contains("\"hello\"") && talks.contains("docs/process_driver.md"),
        "{talks}"
    );
    let none = error(start_with("  ", Patience::default()));
    assert!(none.contains("no program is named"), "{none}");
}

#[test]
fn a_plant_that_is_silent_ends_or_tells_no_numbers_is_no_longer_believed() {
    let quick = Patience {
        step: Duration::from_millis(300),
        ..Patience::default()
    };
    let (words, health) = told("--fault silent --at 0.003", quick);
    assert!(
        words.contains("silent for 0.3 s, at 0.003 s of its time"),
        "{words}"
    );
    assert!(health.faults.has(Fault::MeasurementSilent) && health.level == Level::ERROR);
    assert!(
        health.message.as_str().contains("silent for 0.3 s"),
        "{}",
        health.message.as_str()
    );
    let (words, health) = told("--fault exit --at 0.002", Patience::default());
    assert!(
        words.contains("ended at 0.002 s of its time, with exit status: 3"),
        "{words}"
    );
    assert!(health.faults.has(Fault::MeasurementSilent));
    let (words, health) = told("--fault nan --at 0.004", Patience::default());
    assert!(
        words.contains("NaN for position 1, at 0.004 s of its time"),
        "{words}"
    );
    assert!(health.faults.has(Fault::MeasurementInvalid));
}

#[test]
fn of_an_arm_that_is_not_believed_nothing_is_published() {
    let mut node = ArmNode::new(Box::new(start("--fault nan --at 0.005").unwrap())).unwrap();
    let begin = Time::from_nanos(1_700_000_000_000_000_000);
    for step in 0..10 {
        let mut output = ArmOutput::default();
        let now = begin.plus_nanos(step * 1_000_000);
        node.step(now, &ArmInput::default(), &mut output);
        assert_eq!(output.measured_js.is_some(), step < 5, "{step}");
        assert_eq!(output.health().level == Level::ERROR, step >= 5);
    }
    assert!(node.failure().unwrap().contains("NaN"));
}

/// A session of the shipped scenario whose arm is another program.
fn session(options: &str) -> (tempfile::TempDir, Result<(), RunError>, Vec<u8>) {
    let loaded = scenario(1, false);
    let folder = tempfile::tempdir().expect("a session with a plant");
    let mut context = SessionContext::in_virtual_time(loaded);
    context.driver = Some(format!("process:{}", command(options)));
    context.bag = Some(folder.path().join("bag"));
    let graph = session_graph(ferntast_drivers::rows());
    let mut session = LockstepSession::new(&graph, &context).expect("a session with a plant");
    session.run(2.0);
    let end = session.finish();
    let file = std::fs::read_dir(folder.path().join("bag")).expect("a session with a plant");
    let mut files = file.map(|entry| entry.expect("a session with a plant").path());
    let recording = files.find(|path| path.extension().is_some_and(|own| own == "mcap"));
    let bytes =
        std::fs::read(recording.expect("a session with a plant")).expect("a session with a plant");
    (folder, end, bytes)
}

#[test]
fn a_session_with_it_gives_the_same_bytes_again_and_ends_where_it_fails() {
    let (_one, end, first) = session("");
    end.unwrap();
    let (_two, end, second) = session("");
    end.unwrap();
    assert!(first == second && first.len() > 100_000);
    // Virtual time waits for one that is slow.
    let (_slow, end, slow) = session("--fault slow --at 0.5");
    end.unwrap();
    assert!(first == slow);
    let (_three, end, short) = session("--fault exit --at 0.5");
    let words = end.unwrap_err().to_string();
    assert!(
        words.contains("has ended at 0.500 s of its time"),
        "{words}"
    );
    assert!(short.len() < first.len());
}

/// Half a radian from one millisecond to the next: the drives let go.
#[test]
fn an_arm_that_jumps_is_not_driven_on() {
    let context = {
        let mut context = SessionContext::in_virtual_time(scenario(1, false));
        context.driver = Some(format!("process:{}", command("--fault jump --at 0.5")));
        context
    };
    let graph = session_graph(ferntast_drivers::rows());
    let mut session = LockstepSession::new(&graph, &context).expect("a session with a plant");
    let bus = session.bus().clone();
    let mut states = bus
        .subscriber(topics::FOLLOWER_OPERATING_STATE, Depth::Newest)
        .expect("a topic");
    session.run(0.4);
    let state = states.newest(session.now()).expect("a state").message.state;
    assert_eq!(state, OperatingState::ENABLED);
    session.run(0.3);
    let state = states.newest(session.now()).expect("a state").message.state;
    assert_eq!(state, OperatingState::FAULT);
    session.finish().unwrap();
}

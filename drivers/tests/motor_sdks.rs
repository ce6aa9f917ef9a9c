//! Motors on a serial bus, refereed by their makers' own SDKs: on the same emulated bus each reads
//! what the other wrote, and ours sends nothing that the SDK would write otherwise.

#[path = "../../tests/shared/motor_bus.rs"]
mod motor_bus;

use std::{
    env,
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread::sleep,
    time::Duration,
};

use ferntast_drivers::{
    dynamixel::Dynamixel,
    feetech::Feetech,
    motors::{
        MotorError,
        family::{Drive, Family, Missed},
        section::Section,
    },
};
use ferntast_msgs::sample::JointNames;
use motor_bus::MotorBus;
use serde_json::{Value, json};

const IDS: [u8; 2] = [1, 2];

/// Waits until no shaft turns any more: what is read then stays as it is.
fn await_rest(bus: &mut MotorBus) {
    let mut positions = || {
        bus.motors()
            .iter()
            .map(|motor| motor["position"].clone())
            .collect::<Vec<_>>()
    };
    let mut last = positions();
    for _ in 0..500 {
        sleep(Duration::from_millis(20));
        let now = positions();
        if now == last {
            return;
        }
        last = now;
    }
    panic!("motors that are off go on turning: {last:?}");
}

fn section(bus: &MotorBus, model: &str) -> Section {
    let motor = |id: u8| {
        json!({"id": id, "joint": format!("joint_{id}"), "model": model, "zero": 2048,
            "torque_constant": 1.0, "resistance": 2.0, "current_limit": 1.0})
    };
    let section = json!({"port": bus.port, "motor": IDS.map(motor)});
    let section: Section = serde_json::from_value(section).expect("a section");
    let joints = JointNames::new(["joint_1", "joint_2"]).expect("names");
    section.in_order_of(&joints).expect("a section")
}

/// Some of everything that a session has the motors do.
fn run(mut family: impl Family) {
    let mut states = family.start().expect("motors");
    let mut drive = |drive: &Drive, times: usize| {
        for _ in 0..times {
            // An answer that a busy machine holds up is no matter.
            if let Err(Missed::Error(error)) = family.step(drive, &mut states) {
                panic!("{error}");
            }
            sleep(Duration::from_millis(1));
        }
    };
    drive(&Drive::Off, 5);
    for step in 0..100 {
        let mut currents = [0.0; 8];
        currents[0] = 0.4 * (0.2 * f64::from(step)).sin();
        currents[1] = -0.01 * f64::from(step);
        drive(&Drive::Currents(currents), 1);
    }
    drive(&Drive::Hold, 20);
    drive(&Drive::Off, 3);
    family.release();
    sleep(Duration::from_millis(20));
}

/// What the SDKs' program answers to `asked`.
fn ask_sdk(asked: &Value) -> Value {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let python = env::var_os("FERNTAST_PYTHON");
    let python = python.map_or_else(|| root.join(".venv/bin/python"), PathBuf::from);
    let mut child = Command::new(python)
        .arg(root.join("tests/python/peers/motor_sdk.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python with the makers' SDKs: './tests/run' makes it, or set FERNTAST_PYTHON");
    let mut input = child.stdin.take().expect("a pipe");
    write!(input, "{asked}").expect("python reads");
    drop(input);
    let output = child.wait_with_output().expect("python ends");
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn sdk(family: &str, bus: &MotorBus, operations: Value) -> Vec<Value> {
    let asked =
        json!({"family": family, "port": bus.port, "baud": 1_000_000, "operations": operations});
    let told = ask_sdk(&asked);
    told["results"].as_array().expect("results").clone()
}

/// Has the SDK write all again that came in so far.
fn written_again(family: &str, log: &Path) -> Value {
    let told = ask_sdk(&json!({"family": family, "log": log}));
    assert_eq!(
        told["wrong"],
        json!([]),
        "only registers that are documented"
    );
    assert_eq!(told["different"], json!([]), "the same bytes");
    told
}

#[test]
fn dynamixel_motors_get_what_the_makers_sdk_would_send() {
    let mut bus = MotorBus::start("dynamixel", &json!([{"id": 1}, {"id": 2}]), &[]);
    let open = |bus: &MotorBus| Dynamixel::open(&section(bus, "XM430-W350"));
    run(open(&bus).expect("a port"));
    await_rest(&mut bus);
    let told = written_again("dynamixel", &bus.log());
    for kind in [
        "ping",
        "read",
        "write",
        "sync_read",
        "fast_sync_read",
        "sync_write",
    ] {
        assert!(told["kinds"][kind].as_u64() > Some(0), "{told:#}");
    }
    println!("{told}");

    // The SDK reads what we wrote: mode 5, no delay, the last goals, the drives off.
    let read = sdk(
        "dynamixel",
        &bus,
        json!([
            ["ping", 1],
            ["read", 1, 11, 1],
            ["read", 2, 9, 1],
            ["read", 1, 64, 1],
            ["read", 2, 102, 2],
            ["sync_read", [1, 2], 126, 10],
            ["fast_sync_read", [1, 2], 126, 10],
        ]),
    );
    assert_eq!(read[0], json!([1020, 0, 0]));
    assert_eq!(
        read[1..4],
        [json!([[5], 0, 0]), json!([[0], 0, 0]), json!([[0], 0, 0])]
    );
    // Held, with the limit of 1 A in units of 2.69 mA, rounded down.
    assert_eq!(read[4], json!([[371 & 0xFF, 371 >> 8], 0, 0]));
    // Position now, both ways.
    assert_eq!(
        read[5][0][1].as_array().map(|own| own[6..].to_vec()),
        read[6][0][1].as_array().map(|own| own[6..].to_vec())
    );

    // We read what the SDK writes: a mode of its own is set right again, a limit is respected.
    sdk(
        "dynamixel",
        &bus,
        json!([["write", 1, 11, [3]], ["write", 2, 38, [100, 0]]]),
    );
    let refused = open(&bus).expect("a port").start().expect_err("a limit");
    assert!(matches!(refused, MotorError::Setting { .. }), "{refused}");
    assert!(refused.to_string().contains("0.269 A"), "{refused}");
    let read = sdk(
        "dynamixel",
        &bus,
        json!([["write", 2, 38, [0x74, 4]], ["read", 1, 11, 1]]),
    );
    assert_eq!(read[1], json!([[5], 0, 0]));
    await_rest(&mut bus);
    let mut family = open(&bus).expect("a port");
    let states = family.start().expect("motors");
    for (place, motor) in bus.motors().iter().enumerate() {
        let own = motor["position"].as_f64().expect("a number");
        assert!((states[place].position - own).abs() < 1.0);
        assert!((states[place].voltage - 12.0).abs() < 0.01 && states[place].temperature == 30.0);
    }
}

#[test]
fn feetech_motors_get_what_the_makers_sdk_would_send() {
    let mut bus = MotorBus::start("feetech", &json!([{"id": 1, "mode": 1}, {"id": 2}]), &[]);
    let open = |bus: &MotorBus| Feetech::open(&section(bus, "STS3215"));
    run(open(&bus).expect("a port"));
    let told = written_again("feetech", &bus.log());
    for kind in ["ping", "read", "write", "sync_read", "sync_write"] {
        assert!(told["kinds"][kind].as_u64() > Some(0), "{told:#}");
    }
    println!("{told}");

    // Position mode, no delay, protected again, the drive off; 1 A of 2 Ohm at 7.4 V.
    let read = sdk(
        "feetech",
        &bus,
        json!([
            ["ping", 1],
            ["read", 1, 33, 1],
            ["read", 2, 7, 1],
            ["read", 1, 55, 1],
            ["read", 1, 40, 1],
            ["read", 1, 48, 2],
            ["sync_read", [1, 2], 56, 15],
        ]),
    );
    assert_eq!(read[0], json!([777, 0, 0]));
    assert_eq!(
        read[1..4],
        [json!([[0], 0, 0]), json!([[0], 0, 0]), json!([[1], 0, 0])]
    );
    assert_eq!(
        read[4..6],
        [json!([[0], 0, 0]), json!([[270 & 0xFF, 270 >> 8], 0, 0])]
    );

    // The SDK moves a motor, we see it there.
    let moved = json!([["write", 1, 40, [1]], ["sync_write", 42, 2, {"1": [0, 9]}]]);
    sdk("feetech", &bus, moved);
    sleep(Duration::from_millis(600));
    await_rest(&mut bus);
    let states = open(&bus).expect("a port").start().expect("motors");
    assert!(
        (states[0].position - 2304.0).abs() < 40.0,
        "{:?}",
        states[0]
    );
    assert!((states[0].position - bus.number(0, "position")).abs() < 1.5);
}

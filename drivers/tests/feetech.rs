//! Feetech motors against emulated ones: driven by voltage, limited, and standing where the
//! program dies.

#[path = "../../tests/shared/motor_bus.rs"]
mod motor_bus;

use std::{thread::sleep, time::Duration};

use ferntast_drivers::{
    feetech::Feetech,
    motors::{
        MotorError,
        family::{Drive, Family, Missed, MotorState, States},
        section::Section,
    },
};
use ferntast_msgs::sample::JointNames;
use motor_bus::MotorBus;
use serde_json::{Value, json};

const CURRENT_LIMIT: f64 = 1.0;
const RESISTANCE: f64 = 2.0;
const SUPPLY: f64 = 7.4;

fn section(bus: &MotorBus, changes: &Value) -> Section {
    let mut motor = json!({"id": 1, "joint": "elbow", "model": "STS3215", "zero": 2048, "torque_constant": 0.8,
        "resistance": RESISTANCE, "current_limit": CURRENT_LIMIT});
    for (key, value) in changes.as_object().expect("changes") {
        motor[key] = value.clone();
    }
    let section = json!({"port": bus.port, "motor": [motor]});
    let section: Section = serde_json::from_value(section).expect("a section");
    section
        .in_order_of(&JointNames::new(["elbow"]).expect("a name"))
        .expect("a section")
}

fn started(bus: &MotorBus, changes: &Value) -> Result<(Feetech, States), MotorError> {
    let mut family = Feetech::open(&section(bus, changes))?;
    let states = family.start()?;
    Ok((family, states))
}

/// An answer that a busy machine holds up is no matter.
fn heard(step: Result<(), Missed>) {
    if let Err(Missed::Error(error)) = step {
        panic!("{error}");
    }
}

fn drive(
    family: &mut Feetech,
    states: &mut States,
    cycles: usize,
    mut current: impl FnMut(&MotorState) -> f64,
) {
    for _ in 0..cycles {
        let mut currents = [0.0; 8];
        currents[0] = current(&states[0]);
        heard(family.step(&Drive::Currents(currents), states));
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_voltage_gives_the_current_that_is_wanted() {
    let mut bus = MotorBus::start("feetech", &json!([{"id": 1, "inertia": 0.05}]), &[]);
    let (mut family, mut states) = started(&bus, &json!({})).unwrap();
    drive(&mut family, &mut states, 60, |_| 0.4);
    let mut currents = Vec::new();
    for _ in 0..50 {
        drive(&mut family, &mut states, 1, |_| 0.4);
        currents.push(states[0].current);
    }
    let mean = currents.iter().sum::<f64>() / 50.0;
    // A count of the goal is 0.03 A; cycles lag behind the speed.
    assert!((mean - 0.4).abs() < 0.15, "{mean} A for 0.4 A");
    assert!(states[0].velocity > 0.2);

    // A position is held by a servo around that.
    let pull = |state: &MotorState| {
        let off = (2500.0 - state.position) * std::f64::consts::TAU / 4096.0;
        4.0 * off - 0.6 * state.velocity
    };
    drive(&mut family, &mut states, 700, pull);
    let off = bus.number(0, "position") - 2500.0;
    assert!(off.abs() < 40.0, "{off} counts off");

    // Duty by no more than what gives the limit at standstill.
    drive(&mut family, &mut states, 50, |_| -50.0);
    let most = bus.number(0, "most");
    let allowed = RESISTANCE * CURRENT_LIMIT / SUPPLY;
    assert!(
        most <= allowed && most > 0.95 * allowed,
        "{most} of {allowed}"
    );
    family.release();
    sleep(Duration::from_millis(20));
    assert_eq!(bus.motors()[0]["on"], json!(false));
}

/// There is no watchdog: what stands in for it is that the goal is near.
#[test]
fn a_motor_whose_program_dies_stands_after_some_degrees() {
    let mut bus = MotorBus::start("feetech", &json!([{"id": 1}]), &[]);
    let (mut family, mut states) = started(&bus, &json!({})).unwrap();
    drive(&mut family, &mut states, 100, |_| 0.8);
    let before = states[0];
    assert!(before.velocity > 0.5, "{before:?}");
    sleep(Duration::from_millis(600));
    let way = (bus.number(0, "position") - before.position) * 360.0 / 4096.0;
    let velocity = bus.number(0, "velocity");
    assert!((0.0..10.0).contains(&way), "{way} degrees");
    assert!(velocity.abs() < 0.1, "{velocity} rad/s");
    assert_eq!(
        bus.motors()[0]["on"],
        json!(true),
        "it holds what it carries"
    );
    // A program that begins again does not let it fall.
    drop(family);
    let (mut family, mut states) = started(&bus, &json!({})).unwrap();
    heard(family.step(&Drive::Off, &mut states));
    assert_eq!(bus.motors()[0]["on"], json!(true));
    drive(&mut family, &mut states, 10, |_| 0.0);
}

#[test]
fn what_is_wrong_is_told() {
    let cases = [
        (
            json!([{"id": 1, "model": 2825}]),
            json!({}),
            "is STS3250, the arm's file says STS3215",
        ),
        (
            json!([{"id": 1, "hardware": 32}]),
            json!({}),
            "motor 1 (elbow) on /dev/pts/",
        ),
        (
            json!([{"id": 1, "hardware": 32}]),
            json!({}),
            "overloaded for too long",
        ),
        (
            json!([{"id": 1, "p_gain": 0}]),
            json!({}),
            "set it to 16 or more",
        ),
        (
            json!([{"id": 1}]),
            json!({"model": "SCS0009"}),
            "known are STS3215, STS3250",
        ),
        (
            json!([{"id": 1}]),
            json!({"resistance": null}),
            "give its resistance",
        ),
        (json!([{"id": 2}]), json!({}), "no motor answers"),
    ];
    for (motors, changes, words) in cases {
        let bus = MotorBus::start("feetech", &motors, &[]);
        let told = started(&bus, &changes).err().expect("refused").to_string();
        assert!(told.contains(words), "{told}");
    }
}

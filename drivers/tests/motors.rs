//! Motors on a serial bus against an emulated one: they move as they are told, in the units and
//! senses of the arm's file, and whatever is wrong with them is told in words.

#[path = "../../tests/shared/motor_bus.rs"]
mod motor_bus;

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread::sleep,
    time::{Duration, Instant},
};

use ferntast_config::serial::load_serial;
use ferntast_drivers::{
    Driver, DriverCommand, Reading,
    dynamixel::Dynamixel,
    motors::{
        MotorArm, MotorError,
        error::Lost,
        family::{Drive, Family, Missed, States},
        section::Section,
    },
};
use ferntast_model::Joints;
use ferntast_msgs::sample::{Fault, JointNames, Level};
use ferntast_nodes::node::NodeHealth;
use motor_bus::MotorBus;
use serde_json::{Value, json};

const TORQUE_CONSTANT: f64 = 1.78;

fn joints() -> JointNames {
    JointNames::new(["base", "elbow"]).expect("names")
}

/// Two XM430-W350 in the other order, the second against its joint and with a gear.
fn section(port: &str, changes: Value) -> Section {
    let mut elbow = json!({"id": 7, "joint": "elbow", "model": "XM430-W350-T", "direction": -1, "zero": 1024,
        "gear": 2.0, "torque_constant": TORQUE_CONSTANT, "current_limit": 0.5});
    for (key, value) in changes.as_object().expect("a section") {
        elbow[key] = value.clone();
    }
    let base = json!({"id": 3, "joint": "base", "model": "XM430-W350", "zero": 2048,
        "torque_constant": TORQUE_CONSTANT, "current_limit": 1.0});
    let section = json!({"port": port, "baud": 4_000_000, "motor": [elbow, base]});
    let section: Section = serde_json::from_value(section).expect("a section");
    section.in_order_of(&joints()).expect("a section")
}

fn bus(options: &[&str]) -> MotorBus {
    let motors = json!([{"id": 3, "inertia": 0.05}, {"id": 7, "inertia": 0.0125}]);
    MotorBus::start("dynamixel", &motors, options)
}

fn start(section: &Section) -> Result<MotorArm, MotorError> {
    MotorArm::start(joints(), section.clone(), Dynamixel::open(section)?)
}

/// Steps `arm` for `seconds` at 1 kHz, with torques by the newest reading.
fn drive(
    arm: &mut MotorArm,
    seconds: f64,
    mut torque: impl FnMut(&Reading) -> [f64; 2],
) -> (Option<Reading>, NodeHealth, usize) {
    let begin = Instant::now();
    let (mut newest, mut readings, mut last) = (None, 0, NodeHealth::default());
    while begin.elapsed().as_secs_f64() < seconds {
        let mut health = NodeHealth::default();
        let torque = newest.as_ref().map_or([0.0; 2], &mut torque);
        let command = DriverCommand {
            torque: Joints::from(torque),
            elapsed: Some(1e-3),
        };
        arm.write(&command, &mut health);
        if let Some(reading) = arm.read(&mut health) {
            readings += 1;
            newest = Some(reading);
        }
        last = health;
        sleep(Duration::from_millis(1));
    }
    (newest, last, readings)
}

fn pull(reading: &Reading, goal: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|joint| {
        6.0 * (goal[joint] - reading.position[joint]) - 0.5 * reading.velocity[joint]
    })
}

#[test]
fn joints_go_where_they_are_pulled_whatever_their_motors_sense_and_gear() {
    for options in [&[][..], &["--old-firmware"]] {
        let mut bus = bus(options);
        let section = section(&bus.port, json!({}));
        let mut arm = start(&section).unwrap();
        // 3.14 rad of the encoders are zero of the first, and minus π/4 of the second.
        let (reading, ..) = drive(&mut arm, 0.1, |_| [0.0; 2]);
        let at = reading.expect("a reading").position;
        assert!(
            at[0].abs() < 2e-3 && (at[1] + std::f64::consts::FRAC_PI_4).abs() < 2e-3,
            "{at:?}"
        );
        assert!(
            !bus.motors()[0]["on"].as_bool().unwrap(),
            "nobody has enabled it"
        );

        arm.enable(true);
        // A weight that it has to carry.
        bus.ask(&json!({"do": "push", "id": 7, "torque": 0.15}));
        let goal = [0.4, -0.5];
        let (reading, health, readings) = drive(&mut arm, 1.5, |reading| pull(reading, goal));
        let reading = reading.expect("a reading");
        println!("{readings} readings; {}", health.message);
        for (goal, position) in goal.iter().zip(reading.position.iter()) {
            let off = position - goal;
            assert!(off.abs() < 0.08, "{off} rad off {goal}");
        }
        assert_eq!(health.level, Level::OK);
        // What the emulator itself says.
        let counts = [0, 1].map(|place| bus.number(place, "position"));
        let own = [
            (counts[0] - 2048.0) * std::f64::consts::TAU / 4096.0,
            (counts[1] - 1024.0) * std::f64::consts::TAU / 4096.0 / -2.0,
        ];
        for (own, told) in own.iter().zip(reading.position.iter()) {
            assert!((own - told).abs() < 0.02, "{own} and {told} rad");
        }
        // A weight that is carried is felt as a torque.
        let torque = reading.motor_torque.unwrap()[1].abs();
        let current = bus.number(1, "current").abs();
        assert!(
            (torque - 2.0 * TORQUE_CONSTANT * current).abs() < 0.15,
            "{torque} Nm of {current} A"
        );
        assert!(readings > 300, "{readings} readings");
        assert!((30.0..31.0).contains(&reading.temperature.unwrap()[0]));
        drop(arm);
        sleep(Duration::from_millis(20));
        assert!(
            bus.motors().iter().all(|motor| motor["on"] == json!(false)),
            "let go at the end"
        );
    }
}

#[test]
fn no_current_is_above_its_limit_and_what_is_wanted_flows() {
    let mut bus = bus(&[]);
    let section = section(&bus.port, json!({}));
    let mut arm = start(&section).unwrap();
    arm.enable(true);
    // Far below the limit: exactly that, as long as the joint turns freely.
    drive(&mut arm, 0.3, |_| [0.3, 0.0]);
    let wanted = 0.3 / TORQUE_CONSTANT;
    let flows = bus.number(0, "current");
    assert!((flows - wanted).abs() < 0.003, "{flows} A for {wanted} A");
    let (_, health, _) = drive(&mut arm, 0.3, |_| [50.0, -50.0]);
    assert!(health.faults.has(Fault::EffortLimited));
    let most = [0, 1].map(|place| bus.number(place, "most"));
    assert!(most[0] <= 1.0 && most[0] > 0.98, "{most:?}");
    assert!(most[1] <= 0.5 && most[1] > 0.49, "{most:?}");
    let (_, health, _) = drive(&mut arm, 0.02, |_| [f64::NAN, 0.0]);
    assert!(health.faults.has(Fault::CommandInvalid));
}

#[test]
fn an_arm_whose_servo_is_silent_is_held() {
    let mut bus = bus(&[]);
    let section = section(&bus.port, json!({}));
    let mut arm = start(&section).unwrap();
    arm.enable(true);
    drive(&mut arm, 0.1, |reading| pull(reading, [0.0, -0.78]));
    arm.enable(false);
    drive(&mut arm, 0.1, |_| [0.0; 2]);
    let before = bus.number(0, "position");
    bus.ask(&json!({"do": "push", "id": 3, "torque": 0.6}));
    drive(&mut arm, 0.3, |_| [0.0; 2]);
    let way = (bus.number(0, "position") - before) * 360.0 / 4096.0;
    // 0.6 Nm are 0.34 A, which the gain asks for 1.8 degrees away.
    assert!((0.3..4.5).contains(&way), "{way} degrees");
}

#[test]
fn a_motor_that_does_not_hear_that_it_is_switched_on_is_told_again() {
    for times in [1, 5] {
        let mut bus = bus(&[]);
        let mut arm = start(&section(&bus.port, json!({}))).unwrap();
        bus.ask(&json!({"do": "unheard", "id": 7, "times": times}));
        arm.enable(true);
        drive(&mut arm, 0.2, |_| [0.0; 2]);
        assert_eq!(arm.failure(), None, "{times}");
        assert!(bus.motors().iter().all(|motor| motor["on"] == json!(true)));
    }
}

/// Motors that answer or not, and what they were told when.
struct Answering {
    answers: Arc<AtomicBool>,
    told: Arc<Mutex<Vec<(Instant, Drive)>>>,
}

impl Family for Answering {
    const GIVES_TORQUE: bool = true;

    fn start(&mut self) -> Result<States, MotorError> {
        Ok(States::default())
    }

    fn step(&mut self, drive: &Drive, _states: &mut States) -> Result<(), Missed> {
        self.told
            .lock()
            .expect("no test panicked")
            .push((Instant::now(), *drive));
        match self.answers.load(Ordering::Acquire) {
            true => Ok(()),
            false => Err(Missed::Motor(0, Lost::Silent)),
        }
    }

    fn release(&mut self) {}

    fn silent(&mut self) -> Vec<usize> {
        Vec::new()
    }

    fn damaged(&self) -> u32 {
        0
    }
}

/// The servo gives no torque once it has heard nothing for 20 ms: before that they are held.
#[test]
fn motors_that_do_not_answer_are_held_until_they_do() {
    let (answers, told) = (Arc::new(AtomicBool::new(true)), Arc::default());
    let family = Answering {
        answers: Arc::clone(&answers),
        told: Arc::clone(&told),
    };
    let mut arm = MotorArm::start(joints(), section("none", json!({})), family).unwrap();
    arm.enable(true);
    drive(&mut arm, 0.05, |_| [0.1, 0.0]);
    let before = Instant::now();
    answers.store(false, Ordering::Release);
    let after = Instant::now();
    drive(&mut arm, 0.08, |_| [0.0; 2]);
    let again = Instant::now();
    answers.store(true, Ordering::Release);
    let heard = Instant::now();
    drive(&mut arm, 0.05, |_| [0.1, 0.0]);
    assert_eq!(arm.failure(), None, "it is not lost yet");
    let end = Instant::now();
    drop(arm);

    let told = told.lock().unwrap();
    let between = |from: Instant, to: Instant| {
        let own = told.iter().filter(move |(at, _)| (from..to).contains(at));
        own.map(|(_, drive)| *drive)
    };
    let is_held = |drive: Drive| drive == Drive::Hold;
    let ms = Duration::from_millis;
    assert!(between(after + ms(13), again).all(is_held));
    assert!(between(after + ms(13), again).count() > 10);
    assert!(
        !between(before, before + ms(5)).any(is_held),
        "one lost answer"
    );
    // The cycle in which they answer again is begun before that is known.
    assert!(!between(heard + ms(10), end).any(is_held));
}

#[test]
fn motors_that_hear_nothing_stop_and_follow_again() {
    let mut bus = bus(&[]);
    let mut section = section(&bus.port, json!({}));
    section.watchdog = 0.06;
    let mut family = Dynamixel::open(&section).unwrap();
    let mut states: States = family.start().unwrap();
    let mut currents = [0.0; 8];
    currents[0] = 0.4;
    let step = |family: &mut Dynamixel, states: &mut States, times: usize| {
        for _ in 0..times {
            // An answer that a busy machine holds up is no matter.
            if let Err(Missed::Error(error)) = family.step(&Drive::Currents(currents), states) {
                panic!("{error}");
            }
            sleep(Duration::from_millis(2));
        }
    };
    step(&mut family, &mut states, 60);
    assert!(bus.number(0, "velocity") > 0.5);
    let before = bus.number(0, "trips");
    // As if the program had died.
    sleep(Duration::from_millis(400));
    let (trips, velocity) = (bus.number(0, "trips"), bus.number(0, "velocity"));
    assert!(
        trips > before && velocity.abs() < 0.1,
        "{trips} trips, {velocity} rad/s"
    );
    step(&mut family, &mut states, 100);
    assert!(bus.number(0, "velocity") > 0.5, "it follows again");
    family.release();
    sleep(Duration::from_millis(20));
    assert_eq!(bus.motors()[0]["on"], json!(false));
}

#[test]
fn motors_that_do_not_fit_are_refused_before_anything_moves() {
    let told = |motors: Value, changes: Value| {
        let mut bus = MotorBus::start("dynamixel", &motors, &[]);
        let refused = start(&section(&bus.port, changes)).err().expect("refused");
        assert!(bus.motors().iter().all(|motor| motor["on"] == json!(false)));
        refused.to_string()
    };
    let both = |second: Value| json!([{"id": 3}, second]);
    let cases = [
        (
            both(json!({"id": 8})),
            json!({}),
            "motor 7 (elbow) on /dev/pts/",
        ),
        (
            both(json!({"id": 8})),
            json!({}),
            "does not answer, others do",
        ),
        (
            json!([{"id": 1}]),
            json!({}),
            "no motor answers on /dev/pts/",
        ),
        (
            json!([{"id": 1}]),
            json!({}),
            "at 4000000 baud (asked for [3, 7]); switch on their power",
        ),
        (
            both(json!({"id": 7, "model": 1130})),
            json!({}),
            "is XM540-W150, the arm's file says XM430-W350-T",
        ),
        (
            both(json!({"id": 7, "hardware": 4})),
            json!({}),
            "overheated",
        ),
        (
            both(json!({"id": 7})),
            json!({"model": "XL430-W250"}),
            "cannot limit its current, or is not known; known are",
        ),
        (
            both(json!({"id": 7, "current_limit": 100})),
            json!({}),
            "more than is set in it, 0.269 A",
        ),
        (
            both(json!({"id": 7, "p_gain": 20})),
            json!({}),
            "set it to 70 or more",
        ),
    ];
    for (motors, changes, words) in cases {
        let told = told(motors, changes);
        assert!(told.contains(words), "{told}");
    }
    let nowhere = start(&section("/dev/ttyNOWHERE", json!({})))
        .err()
        .unwrap()
        .to_string();
    assert!(
        nowhere.contains("/dev/ttyNOWHERE cannot be opened") && nowhere.contains("plugged in"),
        "{nowhere}"
    );
    let bus = bus(&[]);
    let own = section(&bus.port, json!({}));
    let _first = start(&own).unwrap();
    let taken = start(&own).err().unwrap().to_string();
    assert!(taken.contains("in use by another program"), "{taken}");
}

#[test]
fn what_goes_wrong_on_the_way_is_told_and_the_others_are_held() {
    let cases = [
        (
            json!({"do": "mute", "id": 7}),
            "motor 7 (elbow) on /dev/pts/",
        ),
        (json!({"do": "mute"}), "was their power switched off?"),
        (
            json!({"do": "break", "id": 7, "bits": 4}),
            "motor 7 (elbow)",
        ),
        (
            json!({"do": "break", "id": 7, "bits": 4}),
            "overheated; the arm is held",
        ),
        (
            json!({"do": "damage", "answers": 1_000_000}),
            "damaged); check power and cable",
        ),
        (
            json!({"do": "switch_off", "id": 7}),
            "off by itself (was its power interrupted?)",
        ),
        (json!({"do": "close"}), "has gone away"),
    ];
    for (trouble, words) in cases {
        let mut bus = bus(&[]);
        let mut arm = start(&section(&bus.port, json!({}))).unwrap();
        arm.enable(true);
        drive(&mut arm, 0.1, |_| [0.0; 2]);
        bus.ask(&trouble);
        let (_, health, _) = drive(&mut arm, 0.6, |_| [0.2, 0.0]);
        let told = arm
            .failure()
            .unwrap_or_else(|| panic!("nothing is told of {trouble}"));
        assert!(told.contains(words), "{told}");
        assert!(health.faults.has(Fault::MeasurementSilent) && health.level == Level::ERROR);
        if trouble["do"] != "close" {
            assert_eq!(bus.motors()[0]["on"], json!(true), "the other is held");
            let before = bus.number(0, "position");
            sleep(Duration::from_millis(200));
            let way = bus.number(0, "position") - before;
            assert!(way.abs() < 100.0, "{way} counts after {trouble}");
        }
    }
    // A few damaged answers are nothing that ends a session.
    let mut bus = bus(&[]);
    let mut arm = start(&section(&bus.port, json!({}))).unwrap();
    arm.enable(true);
    drive(&mut arm, 0.1, |_| [0.0; 2]);
    bus.ask(&json!({"do": "damage", "answers": 3}));
    let (_, health, _) = drive(&mut arm, 0.3, |_| [0.0; 2]);
    assert_eq!(arm.failure(), None);
    assert!(health.lost >= 2, "{} cycles", health.lost);
}

#[test]
fn a_section_that_does_not_fit_the_arm_is_told() {
    let motor = |id: u8, joint: &str| json!({"id": id, "joint": joint, "model": "XM430-W350", "zero": 0, "torque_constant": 1.0, "current_limit": 1.0});
    let told = |section: Value| {
        let section: Section = serde_json::from_value(section).unwrap();
        section.in_order_of(&joints()).unwrap_err()
    };
    let of = |motors: Value| told(json!({"port": "p", "motor": motors}));
    assert_eq!(
        of(json!([motor(1, "base")])),
        "joint \"elbow\" has no motor"
    );
    let other = of(json!([motor(1, "base"), motor(2, "wrist")]));
    assert!(
        other.contains("motor 2 turns \"wrist\", which is no joint of the arm"),
        "{other}"
    );
    assert!(of(json!([motor(1, "base"), motor(1, "elbow")])).contains("two motors have the id 1"));
    assert!(
        of(json!([
            motor(1, "base"),
            motor(2, "base"),
            motor(3, "elbow")
        ]))
        .contains("1 and 2 both turn")
    );
    let mut wrong = motor(2, "elbow");
    wrong["direction"] = json!(0);
    assert!(of(json!([motor(1, "base"), wrong])).contains("direction is 1 or -1"));
}

/// The example of the manual is read, with its units turned; an arm without such a section is
/// told where it goes.
#[test]
fn the_manuals_arm_of_x_series_motors_is_read() {
    let manual = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/motors.md");
    let manual = std::fs::read_to_string(manual).unwrap();
    let mut blocks = manual
        .split("```toml\n")
        .skip(1)
        .filter_map(|own| own.split("```").next());
    let example = blocks
        .find(|own| own.contains("[driver.dynamixel]"))
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let link = |name: &str| {
        format!(
            "<link name='{name}'><inertial><origin xyz='0.1 0 0'/><mass value='0.2'/>\
             <inertia ixx='1e-4' iyy='1e-4' izz='1e-4' ixy='0' ixz='0' iyz='0'/></inertial></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/>\
             <origin xyz='0.2 0 0'/><axis xyz='0 0 1'/>\
             <limit lower='-2' upper='2' effort='5' velocity='3'/></joint>"
        )
    };
    let urdf = ["base", "upper", "lower", "tip"].map(link).concat()
        + &joint("shoulder", "base", "upper")
        + &joint("elbow", "upper", "lower")
        + "<joint name='end' type='fixed'><parent link='lower'/><child link='tip'/><origin xyz='0.2 0 0'/></joint>";
    let urdf = format!("<robot name='my_arm'>{urdf}</robot>");
    std::fs::write(folder.path().join("my_arm.urdf"), urdf).unwrap();
    let load = |text: &str| {
        let path = folder.path().join("my_arm.toml");
        std::fs::write(&path, text).unwrap();
        let loaded = load_serial(path.to_str().unwrap());
        loaded.unwrap_or_else(|error| panic!("{error}")).unwrap()
    };
    let joints = JointNames::new(["shoulder", "elbow"]).unwrap();
    let section = Section::of("dynamixel", &load(example), &joints).unwrap();
    assert_eq!((section.baud, section.watchdog), (4_000_000, 0.1));
    let shoulder = &section.motor[0];
    // A turn of the motor, against the joint, which turns half as far.
    let half = shoulder.position(2048.0 - 4096.0);
    assert!((half - std::f64::consts::PI).abs() < 1e-12, "{half}");
    assert!((shoulder.torque(-1.0) - 4.8).abs() < 1e-12);
    assert!((shoulder.current(shoulder.torque(0.3)) - 0.3).abs() < 1e-12);
    assert!((shoulder.velocity(-1.0) - 0.5).abs() < 1e-12);

    let arm = example.split("[driver.dynamixel]").next().unwrap();
    let none = Section::of("dynamixel", &load(arm), &joints)
        .unwrap_err()
        .to_string();
    assert!(
        none.contains("write one with the port and a [[driver.dynamixel.motor]] for each joint"),
        "{none}"
    );
    let unknown = example.replace("baud =", "baudrate =");
    let unknown = Section::of("dynamixel", &load(&unknown), &joints)
        .unwrap_err()
        .to_string();
    assert!(
        unknown.contains("[driver.dynamixel]: unknown field `baudrate`"),
        "{unknown}"
    );
}

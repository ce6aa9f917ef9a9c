//! An arm that is right, and what is told of it with one thing wrong at a time.

use std::{
    any::Any,
    f64::consts::{FRAC_PI_2, FRAC_PI_4},
};

use ferntast_config::load_scenario;
use ferntast_model::{JointCount, Joints};
use ferntast_msgs::Time;
use ferntast_nodes::{node::NodeHealth, process::SessionContext};

use super::*;
use crate::{
    choice::Choice,
    driver::{DriverCommand, Reading},
    serial_arm::SimulatedSerialArm,
    simulated::load_arm,
    weight::Weight,
};

fn session() -> SessionContext {
    let mut loaded = load_scenario("rokviss", load_arm).unwrap();
    loaded.set_arm("panda", load_arm).unwrap();
    SessionContext::in_virtual_time(loaded)
}

const HOME: [f64; 7] = [
    0.0,
    -FRAC_PI_4,
    0.0,
    -3.0 * FRAC_PI_4,
    0.0,
    FRAC_PI_2,
    FRAC_PI_4,
];

/// Five seconds of the arm, read every 2 ms; by `motion` \[rad\] every joint goes to and fro.
fn record(motion: f64, spoil: impl Fn(&mut Seen)) -> Record {
    let count = JointCount::new(7).unwrap();
    let expected = Expected::of(&session()).unwrap();
    let seen = (0..2500).map(|step| {
        let at = f64::from(step) * 0.002;
        let turn = 1.5 * at;
        let position = Joints::from_fn(count, |joint| HOME[joint] + motion * turn.sin());
        let noise = 0.01 * f64::from(step % 7 - 3);
        let mut seen = Seen {
            at,
            stamp: Some(at - 3600.0),
            delay: Some(3600.0),
            reading: Reading {
                position,
                velocity: Joints::filled(count, motion * 1.5 * turn.cos()),
                joint_torque: Some(expected.weight.at(&position).map(|own| own + noise)),
                motor_torque: None,
                temperature: None,
            },
        };
        spoil(&mut seen);
        seen
    });
    Record {
        seen: seen.collect(),
        seconds: 5.0,
        ..Record::default()
    }
}

fn judged(record: &Record) -> Report {
    judge(&Expected::of(&session()).unwrap(), record, "panda", "test")
}

/// What is wrong or doubtful, with the joint.
fn found(record: &Record) -> Vec<(&'static str, Option<String>)> {
    let findings = judged(record).findings.into_iter();
    let told = findings.filter(|own| own.severity != Severity::Open);
    told.map(|own| (own.what, own.joint)).collect()
}

fn of(what: &'static str, joint: usize) -> Vec<(&'static str, Option<String>)> {
    vec![(what, Some(format!("panda_joint{joint}")))]
}

#[test]
fn an_arm_that_is_right_is_found_right() {
    let report = judged(&record(0.1, |_| ()));
    assert!(report.ok && report.findings.is_empty(), "{report}");
    assert!((report.timing.rate_hz - 500.0).abs() < 1.0);
    let change = report.joints[3].change_per_velocity.unwrap();
    assert!((change - 1.0).abs() < 0.01, "{change}");
    let json = serde_json::to_value(&report).unwrap();
    for key in [
        "rate_hz",
        "longest_gap_ms",
        "stamp_jitter_ms",
        "delay_p99_ms",
        "joints",
        "ok",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
}

#[test]
fn what_only_motion_shows_is_open_at_rest() {
    let report = judged(&record(0.0, |_| ()));
    assert!(report.ok, "{report}");
    let open: Vec<&str> = report.findings.iter().map(|own| own.what).collect();
    assert_eq!(open, ["velocity"; 7]);
}

#[test]
fn a_velocity_that_does_not_go_with_the_position_is_told() {
    type Spoil = fn(&mut Seen);
    let cases: [(Spoil, &str); 5] = [
        (|seen| seen.reading.velocity[2] = 0.0, "velocity_zero"),
        (|seen| seen.reading.velocity[2] *= -1.0, "velocity_sign"),
        (|seen| seen.reading.velocity[2] *= 2.0, "velocity_scale"),
        (|seen| seen.reading.velocity[2] *= 57.3, "position_stuck"),
        (|seen| seen.reading.position[2] = 0.0, "position_stuck"),
    ];
    for (spoil, what) in cases {
        let told = found(&record(0.1, spoil));
        assert_eq!(told, of(what, 3), "{what}");
    }
}

#[test]
fn a_torque_is_held_against_the_weight() {
    type Spoil = fn(&mut Joints<f64>);
    let cases: [(Spoil, &str); 4] = [
        (|torque| torque[3] *= -1.0, "torque_sign"),
        (|torque| torque[3] = 0.001, "torque_without_weight"),
        (|torque| torque[3] *= 1.5, "torque_weight"),
        (|torque| torque[3] *= 1000.0, "torque_weight"),
    ];
    for (spoil, what) in cases {
        let spoiled = record(0.0, |seen| {
            if let Some(torque) = &mut seen.reading.joint_torque {
                spoil(torque);
            }
        });
        assert_eq!(found(&spoiled), of(what, 4), "{what}");
    }
    let stuck = record(0.1, |seen| {
        if let Some(torque) = &mut seen.reading.joint_torque {
            torque[6] = 0.0;
        }
    });
    assert_eq!(found(&stuck), of("torque_stuck", 7));
    let none = record(0.1, |seen| seen.reading.joint_torque = None);
    assert_eq!(found(&none), [("torque_missing", None)]);
}

#[test]
fn degrees_and_places_out_of_range_are_told_apart() {
    let degrees = record(0.1, |seen| {
        seen.reading.position = seen.reading.position.map(|own| own.to_degrees());
        seen.reading.velocity = seen.reading.velocity.map(|own| own.to_degrees());
    });
    let report = judged(&degrees);
    let worst: Vec<&Finding> = report
        .findings
        .iter()
        .filter(|own| own.what == "position_range")
        .collect();
    assert!(worst.len() >= 4, "{report}");
    assert!(worst.iter().all(|own| own.words.contains("in degrees")));
    let turned = record(0.0, |seen| seen.reading.position[3] += 4.0);
    let report = judged(&turned);
    let mut findings = report.findings.iter();
    assert!(
        findings.any(|own| own.words.contains("its zero, its sign")),
        "{report}"
    );
    assert!(!report.ok);
}

#[test]
fn times_are_told() {
    let mut slow = record(0.1, |_| ());
    let mut place = 0;
    slow.seen.retain(|_| {
        place += 1;
        place % 10 == 0
    });
    let told: Vec<&str> = found(&slow).iter().map(|own| own.0).collect();
    assert!(told.contains(&"rate"), "{told:?}");

    let mut gap = record(0.1, |_| ());
    gap.seen.drain(1000..1050);
    assert_eq!(found(&gap)[0].0, "gap");

    let late = record(0.1, |seen| {
        if seen.at % 1.0 < 0.05 {
            seen.delay = seen.delay.map(|own| own + 0.04);
        }
    });
    let told: Vec<&str> = found(&late).iter().map(|own| own.0).collect();
    assert!(told.contains(&"age"), "{told:?}");

    let silent = Record {
        seconds: 5.0,
        words: [("/joint_states lacks joint panda_joint1".to_owned(), 4.9)].into(),
        ..Record::default()
    };
    let report = judged(&silent);
    let told: Vec<&str> = report.findings.iter().map(|own| own.what).collect();
    assert_eq!(told, ["driver", "silent"]);
    assert!(
        report.findings[0]
            .words
            .contains("lacks joint panda_joint1")
    );
}

/// The simulated arm, moved in virtual time by a key that is held as `held` says; `wire` is
/// what becomes of torques on the way to the motors.
fn moved(held: impl Fn(f64) -> bool, wire: impl Fn(&mut Joints<f64>)) -> (Moved, Record, f64) {
    let session = session();
    let loaded = &session.loaded;
    let mut arm = Choice::Simulated.driver(&session, false).unwrap();
    let mut mover =
        Mover::new(&loaded.arm.model, session.joints(), &loaded.scenario.servo).unwrap();
    let count = JointCount::new(7).unwrap();
    let weight = Weight::new(&loaded.arm.model, count);
    let mut record = Record::default();
    let mut torque = Joints::filled(count, 0.0);
    let mut braked = None;
    let mut farthest = 0.0_f64;
    for step in 0..120_000_i64 {
        let now = Time::from_nanos(1_700_000_000_000_000_000 + step * 1_000_000);
        let at = step as f64 * 1e-3;
        let mut health = NodeHealth::default();
        let command = DriverCommand {
            torque,
            elapsed: Some(1e-3),
        };
        arm.write(&command, &mut health);
        let reading = arm.read(&mut health).unwrap();
        record.seen.push(Seen {
            at,
            stamp: None,
            delay: None,
            reading,
        });
        record.seconds = at;
        let drive = mover.step(now, 1e-3, Some(&reading), held(at));
        torque = drive.torque;
        wire(&mut torque);
        if drive.enabled {
            braked = None;
        } else {
            // Its brakes.
            let place = *braked.get_or_insert(reading.position);
            let carried = weight.at(&reading.position);
            torque = Joints::from_fn(count, |joint| {
                let gone = reading.position[joint] - place[joint];
                carried[joint] - 1000.0 * gone - 10.0 * reading.velocity[joint]
            });
        }
        let any: &dyn Any = &*arm;
        let truth = any
            .downcast_ref::<SimulatedSerialArm>()
            .unwrap()
            .arm()
            .truth();
        for (joint, home) in HOME.iter().enumerate() {
            farthest = farthest.max((truth.position[joint] - home).abs());
        }
        if mover.progress() == Progress::Over {
            break;
        }
    }
    (mover.into_moved(), record, farthest)
}

#[test]
fn every_joint_goes_out_and_back_while_the_key_is_held() {
    let (moved, record, farthest) = moved(|_| true, |_| ());
    assert_eq!(moved.findings, []);
    assert_eq!(moved.joints.len(), 7);
    for followed in &moved.followed {
        assert!((0.9..1.1).contains(followed), "{:?}", moved.followed);
    }
    assert!((0.025..0.04).contains(&farthest), "{farthest} rad");
    let report = judged(&record);
    assert!(report.ok, "{report}");
    assert!(
        report
            .joints
            .iter()
            .all(|own| own.change_per_velocity.is_some()),
        "{report}"
    );
}

#[test]
fn released_it_stands_at_once_and_goes_on_when_held_again() {
    let held = |at: f64| !(9.0..11.0).contains(&at);
    let (moved, _, _) = moved(held, |_| ());
    assert_eq!(moved.findings, []);
    assert_eq!(moved.joints.len(), 7);
    assert_eq!(moved.stopped_ms.len(), 1, "{:?}", moved.stopped_ms);
    // With the 60 ms after which a key counts as released that is within 100 ms.
    assert!(moved.stopped_ms[0] <= 35.0, "{:?}", moved.stopped_ms);
}

#[test]
fn released_for_good_it_ends() {
    let (moved, record, _) = moved(|at| at < 9.0, |_| ());
    assert_eq!(moved.joints.len(), 1);
    assert_eq!(moved.findings[0].what, "released");
    assert_eq!(moved.findings[0].joint.as_deref(), Some("panda_joint2"));
    assert!(record.seconds < 19.5, "{} s", record.seconds);
}

#[test]
fn nothing_is_moved_before_the_key_is_held() {
    let (moved, _, farthest) = moved(|_| false, |_| ());
    assert_eq!(moved.joints.len(), 0);
    assert!(farthest < 1e-3, "{farthest} rad");
}

/// A joint whose motor turns the other way runs away from what it is told: it is not let far.
#[test]
fn a_wrong_sign_ends_it_before_the_arm_goes_far() {
    let (moved, _, farthest) = moved(|_| true, |torque| torque[2] *= -1.0);
    let words: Vec<&str> = moved.findings.iter().map(|own| own.what).collect();
    assert!(
        words.contains(&"motion_sign") || words.contains(&"servo"),
        "{words:?}"
    );
    assert!(farthest < 0.15, "{farthest} rad");
}

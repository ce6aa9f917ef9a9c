//! A second arm as the hand: the force on its tip by MuJoCo's own truth, in virtual time and live.

use std::fs;

use ferntast_msgs::{Time, topics};
use ferntast_tests::{
    PATIENCE, Session, await_armed, messages, number, process_driver, recording, run, start,
};

/// When virtual time begins, in the scenario that runs: 2005-03-24 10:00 UTC.
const START: Time = Time::from_nanos(1_111_658_400_000_000_000);
/// When the hand of `mujoco_leader.py` presses and stays there \[s\].
const PRESSES: std::ops::Range<f64> = 3.5..5.0;

/// A hand holds the tip of a UR5 in MuJoCo, presses a panda on its table, and the force that it has
/// to hold against is the one that the master asks for.
#[test]
fn the_force_on_a_leader_arms_tip_is_the_one_that_is_asked_for() {
    let session = Session::new();
    let driver = process_driver("mujoco_leader.py", "--truth hand.csv");
    let arguments = [
        "lockstep",
        "--arm",
        "panda",
        "--hand",
        "leader",
        "--arm-leader",
        "ur5",
        "--driver-leader",
        &driver,
        "--duration",
        "9",
        "--record",
        "run",
        "--json",
    ];
    let told = run(&session, &arguments).success().json();
    assert_eq!(told["states"]["follower"]["final"], "ENABLED", "{told:#}");
    assert!(number(&told, "contact.time_s") > 2.0, "{told:#}");
    assert!(number(&told, "tip.drift_mm") < 1.0, "{told:#}");

    let text = fs::read_to_string(session.folder().join("hand.csv")).expect("what is true");
    let rows = text.lines().map(|line| {
        let numbers = line.split(',').map(|own| own.parse().expect("a number"));
        numbers.collect::<Vec<f64>>()
    });
    let truth: Vec<Vec<f64>> = rows.collect();
    let bag = session.folder().join("run");
    let forces = messages(&bag, topics::LEADER_SERVO_CF);
    let mean = |all: Vec<[f64; 3]>| -> [f64; 3] {
        let count = all.len() as f64;
        assert!(count > 500.0);
        std::array::from_fn(|axis| all.iter().map(|own| own[axis]).sum::<f64>() / count)
    };
    let asked = mean(
        forces
            .iter()
            .filter(|own| PRESSES.contains(&own.message.stamp.seconds_since(START)))
            .map(|own| own.message.force)
            .collect(),
    );
    let held = mean(
        truth
            .iter()
            .filter(|own| PRESSES.contains(&own[0]))
            .map(|own| [own[1], own[2], own[3]])
            .collect(),
    );
    let length = |own: [f64; 3]| own.iter().map(|value| value * value).sum::<f64>().sqrt();
    let off = length(std::array::from_fn(|axis| asked[axis] + held[axis]));
    println!("asked for {asked:?} N, held against with {held:?} N: {off:.4} N off");
    assert!((0.5..10.0).contains(&asked[2]), "{asked:?}");
    assert!(off < 0.05 * length(asked), "{off} N of {asked:?}");

    // Before that nothing presses, and the arm weighs nothing.
    let free = mean(
        truth
            .iter()
            .filter(|own| (0.2..1.0).contains(&own[0]))
            .map(|own| [own[1], own[2], own[3]])
            .collect(),
    );
    assert!(length(free) < 0.02, "{free:?}");

    // The hand is MuJoCo's tip.
    let poses = messages(&bag, topics::LEADER_MEASURED_CP);
    let deepest = poses.iter().map(|own| own.message.position[2]);
    let lowest = truth.iter().map(|own| own[6] - truth[0][6]);
    let (deepest, lowest) = (deepest.fold(0.0, f64::min), lowest.fold(0.0, f64::min));
    assert!((deepest - lowest).abs() < 1e-4, "{deepest} m, {lowest} m");
    assert!(lowest < -0.028, "{lowest} m");
}

/// The same without MuJoCo, in real time with all processes: a simulated SO-101 in a scripted hand.
#[test]
fn a_leader_arm_drives_a_session_and_feels_the_table() {
    let session = Session::new();
    let arguments = [
        "--arm",
        "panda",
        "--hand",
        "leader",
        "--arm-leader",
        "so101",
    ];
    let mut process = start(&session, &arguments);
    await_armed(&session, &mut process);
    ferntast_tests::keep_enabled(&session, {
        let begin = std::time::Instant::now();
        move || begin.elapsed().as_secs_f64() < 12.0
    });
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    assert!(number(&summary, "contact.time_s") > 1.0, "{summary:#}");
    assert!(number(&summary, "leader.peak_force_N") > 0.5, "{summary:#}");
    assert!(
        number(&summary, "nodes.leader.rate_hz") > 500.0,
        "{summary:#}"
    );
    let bag = recording(&session);
    let authority = messages(&bag, topics::LEADER_AUTHORITY);
    assert!(authority.iter().any(|own| own.message.holder > 1));
}

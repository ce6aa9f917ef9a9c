//! Recordings of our own in which a joint stands still: the others are opened all the same.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use ferntast_bag::{BagOptions, BagWriter};
use ferntast_lab::work::{open, trends};
use ferntast_msgs::{
    Time,
    sample::{JointNames, JointSample},
    topics,
};

const ARM: &str = include_str!("../../config/arms/rokviss.toml");

/// A recording of 20 s in which those joints move that are told to.
fn recording(folder: &Path, name: &str, moves: [bool; 2]) -> PathBuf {
    let arm: toml::Table = ARM.parse().unwrap();
    let record = [
        ("mode", "lockstep"),
        ("arm", &serde_json::to_string(&arm).unwrap()),
    ];
    let record = record.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let options = BagOptions {
        custom: [("ferntast".to_owned(), record.into())].into(),
        ..BagOptions::default()
    };
    let path = folder.join(name);
    let mut writer = BagWriter::create(&path, options).unwrap();
    let measured = writer.topic(topics::FOLLOWER_MEASURED_JS).unwrap();
    let motor = writer.topic(topics::FOLLOWER_MOTOR_JS).unwrap();
    for n in 0..4000 {
        let t = f64::from(n) * 5e-3;
        let stamp = Time::from_nanos(1_700_000_000_000_000_000 + i64::from(n) * 5_000_000);
        let mut state = JointSample::zero(JointNames::numbered(2), stamp);
        let mut torque = state;
        for (joint, moves) in moves.into_iter().enumerate() {
            let (wave, speed) = match moves {
                true => ((1.3 * t).sin(), 1.3 * (1.3 * t).cos()),
                false => (0.0, 0.0),
            };
            state.position[joint] = std::f64::consts::FRAC_PI_2 + 0.5 * wave;
            state.effort[joint] = 2.0 * wave;
            torque.effort[joint] = 10.0 * speed.signum() + 40.0 * speed + 0.1 * (37.0 * t).sin();
        }
        writer.write(measured, stamp, stamp, &state).unwrap();
        writer.write(motor, stamp, stamp, &torque).unwrap();
    }
    writer.finish().unwrap();
    path
}

#[test]
fn a_joint_that_stands_still_is_told_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), "first", [true, false]);
    let opened = open(&path).unwrap();
    let titles: Vec<&str> = opened
        .iter()
        .map(|own| own.experiment.title.as_str())
        .collect();
    assert_eq!(titles, ["joint_1"]);
    let notes = opened[0].notes.join("\n");
    assert!(notes.contains("joint_2 stands still in"), "{notes}");

    let both = recording(folder.path(), "both", [true, true]);
    assert_eq!(open(&both).unwrap().len(), 2);

    let none = recording(folder.path(), "none", [false, false]);
    let message = open(&none).unwrap_err().to_string();
    assert!(
        message.starts_with("joint_1: signals.position is 1.57"),
        "{message}"
    );
}

#[test]
fn a_trend_is_of_the_joints_that_move_in_all_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, moves| open(&recording(folder.path(), name, moves)).unwrap();
    let (first, both) = (of("a/run", [false, true]), of("b/run", [true, true]));
    let found = trends(&[first, both], false, &mut |_| ()).unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].title, "joint_2");
    let names: Vec<&str> = found[0]
        .points
        .iter()
        .map(|own| own.name.as_str())
        .collect();
    assert_eq!(names, ["a/run", "b/run"]);
    let notes = found[0].notes.join("\n");
    assert!(
        notes.contains("joint_1 moves in 1 of the 2 recordings"),
        "{notes}"
    );

    let (one, two) = (of("one", [true, false]), of("two", [false, true]));
    let message = trends(&[one, two], false, &mut |_| ())
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("no joint moves in all of the recordings"),
        "{message}"
    );
}

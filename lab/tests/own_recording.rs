//! A recording of ferntast's own stands for an experiment file.

#![allow(clippy::unwrap_used)]

use std::{collections::BTreeMap, fs, path::Path};

use ferntast_identification::{Inertia, Term};
use ferntast_lab::experiment::{Experiment, ExperimentError};
use mcap::{Writer, records::Metadata};

const ARM: &str = include_str!("../../config/arms/rokviss.toml");

fn open(arm: Option<&str>) -> Result<Vec<Experiment>, ExperimentError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut writer = Writer::new(fs::File::create(&path).unwrap()).unwrap();
    let schema = writer
        .add_schema(
            "sensor_msgs/msg/Temperature",
            "ros2msg",
            b"float64 temperature\n",
        )
        .unwrap();
    writer
        .add_channel(
            schema,
            "/follower/joint_1/temperature",
            "cdr",
            &BTreeMap::new(),
        )
        .unwrap();
    if let Some(arm) = arm {
        let metadata = [("mode", "lockstep"), ("arm", arm)];
        let metadata = metadata.map(|(key, value)| (key.to_owned(), value.to_owned()));
        let name = "ferntast".to_owned();
        let metadata = metadata.into();
        writer.write_metadata(&Metadata { name, metadata }).unwrap();
    }
    writer.finish().unwrap();
    Experiment::open(&path, Path::new("/nowhere"))
}

#[test]
fn topics_and_model_are_those_of_the_session_joint_by_joint() {
    let arm: toml::Table = ARM.parse().unwrap();
    let arm = serde_json::to_string(&arm).unwrap();
    let experiments = open(Some(&arm)).unwrap();
    assert_eq!(experiments.len(), 2);
    let (first, second) = (&experiments[0], &experiments[1]);
    assert_eq!(
        (first.title.as_str(), second.title.as_str()),
        ("joint_1", "joint_2")
    );
    assert_eq!(second.signals.position, "/follower/measured_js.position[1]");
    assert_eq!(
        second.signals.joint_torque.as_deref(),
        Some("/follower/measured_js.effort[1]")
    );
    assert_eq!(second.signals.motor_torque, "/follower/motor_js.effort[1]");
    // The recording has the temperature of joint 1 only.
    let temperature = first.signals.temperature.as_deref();
    assert_eq!(
        temperature,
        Some("/follower/joint_1/temperature.temperature")
    );
    assert_eq!(second.signals.temperature, None);
    assert_eq!(first.model.inertia, Inertia::Given(0.5));
    assert_eq!(first.model.gear_ratio, Some(160.0));
    let names: Vec<&str> = first.model.effects.iter().map(Term::name).collect();
    let expected = [
        "coulomb",
        "load_coulomb",
        "viscous",
        "quadratic_viscous",
        "cubic_viscous",
    ];
    assert_eq!(names, expected);
}

#[test]
fn a_recording_that_is_not_ours_needs_an_experiment_file() {
    let message = open(None).unwrap_err().to_string();
    assert!(
        message.contains("was not recorded by ferntast"),
        "{message}"
    );
    assert!(
        message.contains("numbers that it has: /follower/joint_1/temperature.temperature"),
        "{message}"
    );
    for (arm, words) in [
        ("{", "arm: "),
        ("{}", "arm.joint: "),
        ("{\"joint\": []}", "its arm has no joints"),
        (
            "{\"joint\": [{\"motor_inertia\": 1}]}",
            "arm.joint: missing field",
        ),
    ] {
        let message = open(Some(arm)).unwrap_err().to_string();
        assert!(
            message.contains(words) && message.contains("record \"ferntast\""),
            "{message}"
        );
    }
}

//! The recordings in `FERNTAST_DATA` (else `../shared/data` beside the
//! project), by the experiment files that come with them and with the project.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use ferntast_lab::{
    experiment::Experiment,
    recording::{Loaded, load},
};

fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap()
}

fn data() -> PathBuf {
    let path = std::env::var_os("FERNTAST_DATA")
        .map_or_else(|| root().join("../shared/data"), PathBuf::from);
    assert!(
        path.is_dir(),
        "no recordings in {}: set FERNTAST_DATA to the folder that has them",
        path.display()
    );
    path
}

fn read(path: &Path) -> Loaded {
    load(&Experiment::read(path, &data()).unwrap()).unwrap()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
#[ignore = "needs outside recordings: emps"]
fn emps_is_two_runs_at_a_kilohertz() {
    let loaded = read(&root().join("config/experiments/emps.toml"));
    let (fitted, held_out) = (&loaded.dataset.sessions[0], &loaded.dataset.held_out[0]);
    for session in [fitted, held_out] {
        assert_eq!(session.len(), 24_841);
        assert!((session.period - 1e-3).abs() < 1e-7, "{}", session.period);
    }
    assert_eq!(
        (loaded.dataset.sessions.len(), loaded.dataset.held_out.len()),
        (1, 1)
    );
    assert_eq!(fitted.position[0], 7.45e-06);
    assert_eq!(fitted.motor_torque[0], 89.234_432_2);
}

#[test]
#[ignore = "needs outside recordings: xl330"]
fn xl330_is_sixteen_runs_made_even() {
    let loaded = read(&root().join("config/experiments/xl330.toml"));
    let sessions = &loaded.dataset.sessions;
    assert_eq!(sessions.len(), 16, "{:?}", loaded.notes);
    for pair in sessions.windows(2) {
        let end = pair[0].start + pair[0].len() as f64 * pair[0].period;
        assert!(pair[1].start >= end - 1e-6);
    }
    for session in sessions {
        let rate = 1.0 / session.period;
        assert!(
            (180.0..253.0).contains(&rate),
            "{rate} Hz in {}",
            session.name
        );
        assert_eq!(session.extra["supply"].len(), session.len());
        assert!(
            session
                .temperature
                .as_ref()
                .unwrap()
                .iter()
                .all(|t| (20.0..60.0).contains(t))
        );
    }
}

#[test]
#[ignore = "needs outside recordings: hidden"]
fn hidden_recordings_are_six_sessions_with_days_between() {
    let folder = data().join("hidden");
    let mut files: Vec<PathBuf> = folder
        .read_dir()
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    files.sort();
    assert!(!files.is_empty());
    for file in files {
        let loaded = read(&file);
        let sessions = &loaded.dataset.sessions;
        assert_eq!(sessions.len(), 6, "{}", file.display());
        for session in sessions {
            assert!((session.period - 0.012).abs() < 1e-6, "{}", session.period);
            let torque = session.joint_torque.as_ref().unwrap();
            assert_eq!(torque.len(), session.len());
            assert!(rms(torque) > 0.1 && rms(&session.motor_torque) > rms(torque) * 0.1);
        }
        assert!(
            sessions
                .windows(2)
                .all(|pair| pair[1].start - pair[0].start > 3600.0)
        );
    }
}

/// Figures by the Python package `rosbags` from `none-100.mcap`.
#[test]
#[ignore = "needs outside recordings: hidden"]
fn what_is_read_is_what_rosbags_reads() {
    let loaded = read(&data().join("hidden/none-100.toml"));
    let sessions = &loaded.dataset.sessions;
    let all = |channel: fn(&ferntast_identification::RecordedSession) -> &[f64]| -> f64 {
        sessions.iter().flat_map(channel).sum()
    };
    let samples: usize = sessions.iter().map(|session| session.len()).sum();
    assert_eq!(samples, ROSBAGS.0);
    assert!((all(|s| &s.position) - ROSBAGS.1).abs() < 1e-6);
    assert!((all(|s| &s.motor_torque) - ROSBAGS.2).abs() < 1e-5);
    assert!((all(|s| s.joint_torque.as_deref().unwrap_or_default()) - ROSBAGS.3).abs() < 1e-5);
}

/// Samples; sums of position, motor torque and joint torque.
const ROSBAGS: (usize, f64, f64, f64) = (47098, 8780.856424, 264951.7766632559, 269728.0036752664);

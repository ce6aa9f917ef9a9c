//! The flexible joint of the second paper: what its bench does, the regressions find.

use ferntast_benches::flexible_joint_bench::{
    FlexibleJointParameters, FlexibleJointRecording, FlexibleJointRun, LOG_PERIOD, record,
};
use ferntast_identification::experiments::flexible_joint::{
    FlexibleJointSignals, Inertias, OnLine, PARAMETERS, Row, off_line, on_line, rows,
};
use ferntast_model::recursive_least_squares::Forgetting;

const SCALES: [[f64; 2]; 3] = [[1e5, 1e9], [1e3, 1e2], [1e3, 1e2]];
const NOISE: [f64; 3] = [1.0, 0.3, 1.0];
const VARIABLE: Forgetting = Forgetting::Variable {
    memory: 3000.0,
    least: 0.98,
};

fn rows_of(recording: &FlexibleJointRecording, truth: &FlexibleJointParameters) -> [Vec<Row>; 3] {
    let signals = FlexibleJointSignals {
        period: LOG_PERIOD,
        motor_position: &recording.motor_position,
        position: &recording.position,
        motor_torque: &recording.motor_torque,
        joint_torque: &recording.joint_torque,
        brake_torque: &recording.brake_torque,
    };
    let inertias = Inertias {
        motor: truth.motor_inertia,
        load: truth.load_inertia,
    };
    rows(&signals, inertias)
}

fn run(duration: f64) -> FlexibleJointRun {
    FlexibleJointRun {
        seed: 20_100,
        duration,
        rest: None,
        change: None,
    }
}

fn true_values(truth: &FlexibleJointParameters) -> [[f64; 2]; 3] {
    [
        [truth.k1, truth.k2],
        [truth.b_in, truth.b_in_dry],
        [truth.b_out, truth.b_out_coulomb],
    ]
}

/// With an even gear and a steady brake the truth comes out.
#[test]
fn off_line_finds_what_was_put_in() {
    let truth = FlexibleJointParameters {
        gear_weakness: 0.0,
        brake_fluctuation: 0.0,
        ..FlexibleJointParameters::default()
    };
    let rows = rows_of(&record(&truth, &run(120.0)), &truth);
    for (rows, expected) in rows.iter().zip(true_values(&truth)) {
        let found = off_line(rows).unwrap();
        for (found, expected) in found.iter().zip(expected) {
            let share = found.value / expected;
            assert!((0.985..1.015).contains(&share), "{found:?} {expected}");
        }
    }
}

/// With weakness and fluctuation the values on line settle at those off line.
#[test]
fn on_line_settles_at_off_line() {
    let truth = FlexibleJointParameters::default();
    let rows = rows_of(&record(&truth, &run(240.0)), &truth);
    for i in 0..3 {
        let batch = off_line(&rows[i]).unwrap();
        let track = on_line(&rows[i], SCALES[i], NOISE[i], VARIABLE).unwrap();
        for (k, off_line) in batch.iter().enumerate() {
            let (mean, spread) = track.steady(k, 80.0).unwrap();
            let share = mean / off_line.value;
            let fluctuation = spread / off_line.value;
            let converged = track.convergence_time(k, *off_line);
            println!(
                "{:8} off line {:12.4} ± {:9.4}; on line {share:.4}, fluctuation {fluctuation:.4}, from {converged:?} s",
                PARAMETERS[2 * i + k].0,
                off_line.value,
                off_line.std_error
            );
            assert!((0.93..1.07).contains(&share), "{share}");
            assert!((1e-5..0.15).contains(&fluctuation), "{fluctuation}");
        }
    }
}

/// Ten minutes at rest, then on: plain forgetting has wound up.
#[test]
fn rest_is_survived() {
    let truth = FlexibleJointParameters::default();
    let run = FlexibleJointRun {
        rest: Some([60.0, 660.0]),
        ..run(720.0)
    };
    let rows = rows_of(&record(&truth, &run), &truth);
    let track = |forgetting| on_line(&rows[0], SCALES[0], NOISE[0], forgetting).unwrap();
    let plain = track(Forgetting::Exponential { factor: 0.999 });
    let most = |track: &OnLine| track.wind_up(0, 0.0).max(track.wind_up(1, 0.0));
    assert!(most(&plain) > 1e3, "{}", most(&plain));
    let variable = track(VARIABLE);
    assert!(most(&variable) <= 1.0 + 1e-9, "{}", most(&variable));
    let batch = off_line(&rows[0]).unwrap();
    let after = variable
        .track
        .iter()
        .filter(|track| track.time > 655.0)
        .map(|track| (track.values[0] / batch[0].value - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(after < 0.15, "{after}");
}

/// b_in grows by a half after two minutes; the estimate is there half a minute later.
#[test]
fn a_change_is_followed() {
    let truth = FlexibleJointParameters::default();
    let run = FlexibleJointRun {
        change: Some((120.0, 1.5)),
        ..run(240.0)
    };
    let rows = rows_of(&record(&truth, &run), &truth);
    let track = on_line(&rows[1], SCALES[1], NOISE[1], VARIABLE).unwrap();
    let (before, _) = track.steady(0, 100.0).unwrap();
    let at = |time: f64| {
        let found = track.track.iter().find(|track| track.time >= time);
        found.unwrap().values[0] / truth.b_in
    };
    assert!(before > 0.0);
    assert!((0.95..1.05).contains(&at(119.0)), "{}", at(119.0));
    assert!((1.42..1.58).contains(&at(150.0)), "{}", at(150.0));
}

#[test]
fn rows_that_tell_nothing_give_none() {
    let row = Row {
        time: 0.0,
        phi: [1.0, 1.0],
        measured: 2.0,
    };
    assert_eq!(off_line(&[row; 50]), None);
    assert_eq!(off_line(&[]), None);
}

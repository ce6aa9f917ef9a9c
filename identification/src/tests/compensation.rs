//! Effects that act on channels, large enough that their columns alone do not suffice.

use super::recordings::{JointState, model, plain, recording};
use crate::{Addition, Dataset, RecordedSession, Term, Verdict, add, compare, diagnose};

const BELIEVED: [&str; 2] = ["coulomb", "viscous"];

fn added(data: &Dataset, effect: &str) -> Addition {
    add(data, &model(&BELIEVED), &Term::Catalogue(effect.into())).unwrap()
}

/// How much more is left on rows held out than where nothing is missing.
fn over_plain(addition: &Addition, plain: &Dataset) -> f64 {
    let reached = compare(plain, &model(&BELIEVED)).unwrap().rms.held_out;
    addition.held_out_after / reached
}

/// Every other channel begins `late` samples after the position does.
fn with_late_position(mut data: Dataset, late: usize) -> Dataset {
    for session in &mut data.sessions {
        session.position.truncate(session.position.len() - late);
        session.motor_torque.drain(..late);
        for channel in [&mut session.joint_torque, &mut session.temperature] {
            channel.as_mut().unwrap().drain(..late);
        }
    }
    data
}

#[test]
fn a_channel_that_is_far_too_late_is_taken_back_as_a_whole() {
    let data = recording(4, plain);
    let found = added(&with_late_position(data.clone(), 9), "channel_delay");
    let delay = &found.parameters["delay"];
    assert!((0.0897..0.0903).contains(&delay.value), "{delay:?}");
    assert!(found.held_out_before > 3.0 * found.held_out_after);
    let over = over_plain(&found, &data);
    assert!((0.98..1.02).contains(&over), "{over}");
}

/// The motor torque by a clock of its own: what it says at t was true at t (1 − `drift`).
fn with_drifting_torque(mut data: Dataset, drift: f64) -> Dataset {
    for session in &mut data.sessions {
        let torque = &session.motor_torque;
        let last = torque.len() - 2;
        let read = (0..torque.len()).map(|at| {
            let place = at as f64 * (1.0 - drift);
            let before = (place as usize).min(last);
            torque[before] + (place - before as f64) * (torque[before + 1] - torque[before])
        });
        session.motor_torque = read.collect();
    }
    data
}

#[test]
fn a_channel_of_another_clock_is_named_and_taken_back() {
    let data = recording(9, plain);
    // 50 ms at the end of a session, either way.
    for drift in [-0.00125, 0.00125] {
        let drifting = with_drifting_torque(data.clone(), drift);
        let diagnosis = diagnose(&drifting, &model(&BELIEVED), &mut |_| ()).unwrap();
        assert_eq!(diagnosis.verdict, Verdict::Missing);
        assert_eq!(diagnosis.candidates[0].effect, "clock_drift", "{drift}");
        let found = added(&drifting, "clock_drift");
        let (fitted, channel) = (&found.parameters["drift"], &found.parameters["channel"]);
        let off = (fitted.value / drift - 1.0).abs();
        assert!(off < 0.02 && channel.value == 0.0, "{fitted:?} {channel:?}");
        let over = over_plain(&found, &data);
        assert!((0.97..1.03).contains(&over), "{over}");
    }
    // One that is late by the same all the time is that.
    let late = with_late_position(data, 5);
    let diagnosis = diagnose(&late, &model(&BELIEVED), &mut |_| ()).unwrap();
    assert_eq!(diagnosis.candidates[0].effect, "channel_delay");
}

/// Clocks go on where nothing is recorded.
#[test]
fn a_clock_drifts_through_the_pieces_of_a_recording() {
    let drifting = with_drifting_torque(recording(9, plain), 0.00125);
    let pieces = |session: &RecordedSession| {
        let half = session.len() / 2;
        [0..half, half..session.len()].map(|own| {
            let before = own.start as f64 * session.period;
            let of = |channel: &Vec<f64>| channel[own.clone()].to_vec();
            RecordedSession {
                start: session.start + before,
                into_recording: before,
                position: of(&session.position),
                motor_torque: of(&session.motor_torque),
                joint_torque: session.joint_torque.as_ref().map(of),
                temperature: session.temperature.as_ref().map(of),
                ..session.clone()
            }
        })
    };
    let mut cut = drifting.clone();
    cut.sessions = drifting.sessions.iter().flat_map(pieces).collect();
    let drift = added(&cut, "clock_drift").parameters["drift"].value;
    assert!((0.98..1.02).contains(&(drift / 0.00125)), "{drift}");
}

/// δ \[rad\] of K δ + K₃ δ³ = τ, halved into.
fn twist(torque: f64, stiffness: f64, cubic: f64) -> f64 {
    let (mut low, mut high) = (-0.2, 0.2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match stiffness * middle + cubic * f64::powi(middle, 3) < torque {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

#[test]
fn a_joint_that_winds_up_and_stiffens_gives_its_stiffness() {
    let friction = |s: &JointState| 5.0 * s.qd.signum() + 60.0 * s.qd;
    let rigid = recording(6, friction);
    let mut data = rigid.clone();
    for session in &mut data.sessions {
        for (at, position) in session.position.iter_mut().enumerate() {
            let load = 25.0 * f64::max(*position - 0.1, 0.0) + 3.0 * (0.009 * at as f64).sin();
            *position -= twist(load, 150.0, 4e4);
        }
    }
    let found = added(&data, "elasticity");
    let inverse = found.parameters["inverse_K"].value;
    assert!((0.9..1.1).contains(&(inverse * 150.0)), "{inverse}");
    let stiff = found.parameters["tau_s"].value;
    let expected = 150.0 * f64::sqrt(150.0 / 4e4);
    assert!((0.7..1.4).contains(&(stiff / expected)), "{stiff}");
    // The torque sensor's noise comes in with the twist.
    let over = over_plain(&found, &rigid);
    assert!((0.98..1.10).contains(&over), "{over}");
    let before = found.held_out_before / found.held_out_after;
    assert!(before > 1.5, "{before}");
}

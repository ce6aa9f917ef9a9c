//! No name that does not help.

use super::recordings::{JointState, model, plain, recording};
use crate::comparison::HeldOutBy;
use crate::numerics::statistics::quantile_or_zero;
use crate::{Dataset, Diagnosis, Term, add, compare, diagnose};

const BELIEVED: [&str; 2] = ["coulomb", "viscous"];

fn ask(data: &Dataset) -> Diagnosis {
    diagnose(data, &model(&BELIEVED), &mut |_| ()).unwrap()
}

fn rippled(size: f64) -> impl Fn(&JointState) -> f64 {
    move |s| plain(s) + size * (77.0 * s.q).sin()
}

#[test]
fn what_is_promised_is_what_adding_gives() {
    let slow = |s: &JointState| plain(s) + 1.5 * (-(s.qd / 0.05).powi(2)).exp() * s.qd.signum();
    let mut named = 0;
    for data in [recording(3, slow), recording(4, |s| plain(s) + 0.4 * s.qdd)] {
        for candidate in ask(&data).candidates {
            let term = Term::Catalogue(candidate.effect.clone());
            let added = add(&data, &model(&BELIEVED), &term).unwrap();
            assert_eq!(candidate.held_out_before, added.held_out_before, "{term:?}");
            assert_eq!(candidate.held_out_after, added.held_out_after, "{term:?}");
            assert!(added.lowers_error && added.held_out_after < added.held_out_before);
            let fallen = 1.0 - (added.held_out_after / added.held_out_before).powi(2);
            assert!((candidate.share - fallen).abs() < 1e-9, "{candidate:?}");
            named += 1;
        }
    }
    assert!(named >= 2);
}

/// Five sessions have a ripple, and the recording that is held out has its opposite.
#[test]
fn what_worsens_a_recording_left_out_is_no_name() {
    let mut data = recording(3, rippled(0.8));
    let opposite = recording(3, rippled(-0.8)).sessions.remove(5);
    let own = data.sessions.pop().unwrap();
    data.held_out = vec![own];
    assert_eq!(ask(&data).candidates[0].effect, "ripple");
    data.held_out = vec![opposite];
    assert!(
        ask(&data)
            .candidates
            .iter()
            .all(|own| own.effect != "ripple")
    );
    let added = add(&data, &model(&BELIEVED), &Term::Catalogue("ripple".into())).unwrap();
    assert!(!added.lowers_error && added.held_out_after > added.held_out_before);
}

#[test]
fn two_sessions_predict_each_other_unless_one_is_short() {
    let mut data = recording(5, plain);
    data.sessions.truncate(2);
    let by = |data: &Dataset| compare(data, &model(&BELIEVED)).unwrap().held_out_by;
    assert_eq!(by(&data), HeldOutBy::Sessions);
    let second = &mut data.sessions[1];
    second.position.truncate(600);
    second.motor_torque.truncate(600);
    for channel in [&mut second.joint_torque, &mut second.temperature] {
        channel.as_mut().unwrap().truncate(600);
    }
    assert_eq!(by(&data), HeldOutBy::Blocks);
    data.sessions.truncate(1);
    assert_eq!(by(&data), HeldOutBy::Blocks);
}

/// The sensor's range ends where a share of the samples lies beyond.
fn clipped(share: f64) -> (Dataset, f64) {
    let mut data = recording(6, plain);
    let torques = data.sessions.iter().flat_map(|s| &s.motor_torque);
    let mut sizes: Vec<f64> = torques.map(|torque| torque.abs()).collect();
    let limit = quantile_or_zero(&mut sizes, 1.0 - share);
    for session in &mut data.sessions {
        for torque in &mut session.motor_torque {
            *torque = torque.clamp(-limit, limit);
        }
    }
    (data, limit)
}

#[test]
fn a_range_that_ends_is_named_by_what_it_does_below_its_end() {
    let (data, limit) = clipped(0.06);
    let diagnosis = ask(&data);
    let first = &diagnosis.candidates[0];
    assert_eq!(first.effect, "current_saturation");
    let found = &first.parameters;
    assert!(
        (found["L"].value / limit - 1.0).abs() < 0.03,
        "{found:?} {limit}"
    );
    assert_eq!(found["place"].value, 1.0);
    let term = Term::Catalogue(first.effect.clone());
    let added = add(&data, &model(&BELIEVED), &term).unwrap();
    assert!(
        (0.6..0.97).contains(&added.judged_share),
        "{}",
        added.judged_share
    );
}

#[test]
fn a_limit_that_much_lies_beyond_is_no_limit() {
    let (data, _) = clipped(0.5);
    let named = ask(&data).candidates;
    assert!(
        named.iter().all(|own| own.effect != "current_saturation"),
        "{named:?}"
    );
}

//! Formulas for what no effect of the catalogue explains.

use std::collections::BTreeMap;

use super::recordings::{JointState, model, plain, recording};
use crate::{CustomEffect, Dataset, Discovery, Term, Verdict, add, discover};

const BELIEVED: [&str; 2] = ["coulomb", "viscous"];

fn found(data: &Dataset) -> Discovery {
    discover(data, &model(&BELIEVED), 1, &mut |_| ()).unwrap()
}

fn with(data: &Dataset, expression: &str) -> crate::Addition {
    let effect = Term::Custom(CustomEffect {
        name: "accepted".into(),
        expression: expression.into(),
        bounds: BTreeMap::new(),
    });
    add(data, &model(&BELIEVED), &effect).unwrap()
}

/// Where a spring is wound up, friction that saturates with speed: a law of two
/// signals that is in no catalogue, written with functions that are not searched.
fn wound(s: &JointState) -> f64 {
    let levelling = s.qd / (0.08 + s.qd.abs());
    plain(s) + 0.09 * levelling * s.tau * s.tau.abs()
}

#[test]
fn a_law_outside_the_catalogue_becomes_a_formula_as_good_as_it() {
    let mut data = recording(5, wound);
    let discovery = found(&data);
    assert_eq!(discovery.verdict, Verdict::Unexplained);
    let first = discovery.formulas.first().unwrap();
    assert!(first.p_value <= 0.01 && first.held_out_after < 0.7 * first.held_out_before);
    // What is printed is accepted as it is, and gives what was promised.
    let accepted = with(&data, &first.expression);
    assert_eq!(accepted.held_out_after, first.held_out_after);
    assert_eq!(accepted.held_out_before, first.held_out_before);
    // So do the others, and their units work out.
    for formula in &discovery.formulas {
        let error = with(&data, &formula.expression).held_out_after;
        assert_eq!(error, formula.held_out_after, "{}", formula.expression);
        for (name, own) in &formula.parameters {
            assert!(own.std_error.is_some_and(f64::is_finite), "{name}");
            assert!(!own.unit.is_empty(), "{name}");
            assert!(formula.form.contains(name.as_str()), "{name}");
        }
    }
    // The same seed, the same answer.
    assert_eq!(found(&data), discovery);
    // The law itself, as a signal, does not leave much less.
    for session in &mut data.sessions {
        let torques = law_of(session);
        session.extra.insert("law".into(), torques);
    }
    let true_error = with(&data, "share*law").held_out_after;
    let ratio = first.held_out_after / true_error;
    assert!(ratio < 1.1, "{}: {ratio}", first.expression);
}

/// The law's torque from what was measured.
fn law_of(session: &crate::RecordedSession) -> Vec<f64> {
    let torques = session.joint_torque.clone().unwrap_or_default();
    let speeds: Vec<f64> = (0..session.len())
        .map(|at| {
            let last = session.len() - 1;
            let (from, to) = (at.saturating_sub(4), (at + 4).min(last));
            (session.position[to] - session.position[from]) / ((to - from) as f64 * session.period)
        })
        .collect();
    let each = torques.iter().zip(speeds);
    each.map(|(tau, qd)| 0.09 * qd / (0.08 + qd.abs()) * tau * tau.abs())
        .collect()
}

#[test]
fn nothing_is_proposed_where_nothing_is_left() {
    let discovery = found(&recording(6, plain));
    assert_eq!(discovery.verdict, Verdict::Complete);
    assert!(discovery.formulas.is_empty() && discovery.tried == 0);
}

/// Chance pays for all that was searched: put to the search although nothing is left.
#[test]
fn the_search_itself_finds_nothing_in_noise() {
    let mut alarms = 0;
    for seed in 11..19 {
        let data = recording(seed, plain);
        alarms += usize::from(super::super::discovery::finds_anything(
            &data,
            &model(&BELIEVED),
        ));
    }
    assert!(alarms <= 1, "{alarms} of 8");
}

#[test]
fn what_the_catalogue_has_is_not_given_as_a_formula() {
    let discovery = found(&recording(7, |s| {
        plain(s) + 0.25 * s.tau.abs() * s.qd.signum()
    }));
    assert_eq!(discovery.verdict, Verdict::Missing);
    assert_eq!(discovery.named[0].effect, "load_coulomb");
    assert!(discovery.formulas.is_empty(), "{:?}", discovery.formulas);
}

//! Formulas of the user's own: as the load, and with names that are misspelt.

use std::collections::BTreeMap;

use super::recordings::{JointState, model, plain, recording};
use crate::{
    CustomEffect, Dataset, ExpressionError, Inertia, ModelSpec, PrepareError, Term, compare,
    diagnose,
};

fn formula(expression: &str) -> Term {
    Term::Custom(CustomEffect {
        name: "own".into(),
        expression: expression.into(),
        bounds: BTreeMap::new(),
    })
}

/// A weight on a joint without a torque sensor, and friction that grows with it.
fn weighed() -> Dataset {
    let weight = |s: &JointState| 12.0 * (4.0 * s.q).sin() + 9.0 * (4.0 * s.q).cos();
    let mut data = recording(4, |s| {
        plain(s) - s.tau + weight(s) + 0.25 * weight(s).abs() * s.qd.signum()
    });
    for session in &mut data.sessions {
        session.joint_torque = None;
    }
    data
}

fn believed(expression: &str) -> ModelSpec {
    let mut spec = model(&["coulomb", "viscous"]);
    spec.inertia = Inertia::Given(0.0);
    spec.effects.push(formula(expression));
    spec
}

#[test]
fn friction_by_load_goes_with_a_load_by_formula() {
    let data = weighed();
    let by = |expression: &str| {
        let diagnosis = diagnose(&data, &believed(expression), &mut |_| ()).unwrap();
        diagnosis
            .candidates
            .into_iter()
            .map(|own| own.effect)
            .collect::<Vec<_>>()
    };
    let named = by("a*sin(4*q) + b*cos(4*q) + j*qdd");
    assert_eq!(
        named.first().map(String::as_str),
        Some("load_coulomb"),
        "{named:?}"
    );
    // What reads the velocity is friction, and no load.
    let named = by("a*sin(4*q) + b*cos(4*q) + j*qdd + c*qd*abs(qd)");
    assert!(!named.contains(&"load_coulomb".to_owned()), "{named:?}");
}

#[test]
fn a_misspelt_signal_is_told_with_the_signals_that_there_are() {
    let mut data = recording(1, plain);
    for session in &mut data.sessions {
        session
            .extra
            .insert("q_next".into(), session.position.clone());
    }
    let refused = |expression: &str| {
        let mut spec = model(&["coulomb", "viscous"]);
        spec.effects.push(formula(expression));
        match compare(&data, &spec) {
            Err(PrepareError::Expression(error)) => error,
            other => panic!("{other:?}"),
        }
    };
    let error = refused("a*cos(q_nxt) + b*q");
    let text = error.to_string();
    assert!(
        text.contains("a, q_nxt") && text.contains("q_next"),
        "{text}"
    );
    assert!(!text.contains("b,") && !text.contains(", b "), "{text}");
    let ExpressionError::NotLinear { parameters, .. } = error else {
        panic!("{text}");
    };
    assert_eq!(parameters, ["a", "q_nxt"]);
    // Names that signals have elsewhere are never parameters.
    for name in ["F_N", "velocity", "rd"] {
        let error = refused(&format!("a*q + {name}"));
        let is_missing =
            matches!(&error, ExpressionError::MissingSignal { signal, .. } if signal == name);
        assert!(is_missing, "{error}");
    }
}

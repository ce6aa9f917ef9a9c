//! What is said of the samples used, of parameters and of the filter.

use std::collections::BTreeMap;

use super::recordings::{INERTIA, JointState, model, plain, recording};
use crate::comparison::{Comparison, Reason};
use crate::data::{CustomEffect, Dataset, Inertia, ModelSpec, Term};
use crate::{StatedFilter, Verdict, compare, diagnose, diagnose_at_cutoffs};

fn bump(s: &JointState) -> f64 {
    plain(s) + 1.5 * (-(s.qd / 0.05).powi(2)).exp() * s.qd.signum()
}

fn compared(data: &Dataset, model: &ModelSpec) -> Comparison {
    compare(data, model).unwrap()
}

#[test]
fn every_sample_has_one_reason() {
    let mut data = recording(3, plain);
    data.held_out = data.sessions.split_off(4);
    let used = compared(&data, &model(&["coulomb", "viscous"])).used;
    assert_eq!(used.samples, 6 * 4000);
    assert_eq!(used.by_reason.values().sum::<usize>(), used.samples);
    let of = |reason: Reason| used.by_reason.get(&reason).copied().unwrap_or(0);
    // Two of six sessions are held out, and as much of them is left out.
    let (fitted, validation) = (of(Reason::Fitted) as f64, of(Reason::Validation) as f64);
    assert!((1.7..2.3).contains(&(fitted / validation)), "{used:?}");
    assert_eq!(used.share, (fitted + validation) / used.samples as f64);
    assert!(of(Reason::Slow) > 0 && of(Reason::AfterReversal) > 0 && of(Reason::FilterEdges) > 0);
    let [low, high] = used.speed_range.unwrap();
    // Amplitudes times rates: 0.085 + 0.1 + 0.1 rad/s.
    assert!(
        low >= used.least_speed && (0.2..0.32).contains(&high),
        "{low} {high}"
    );
}

#[test]
fn stated_filters_are_told_with_what_they_leave_out() {
    let mut data = recording(3, plain);
    data.filter = Some(StatedFilter {
        butterworth_hz: 20.0,
        decimation: 2,
        least_speed: 0.1,
    });
    let found = compared(&data, &model(&["coulomb", "viscous"]));
    let used = &found.used;
    assert_eq!(used.by_reason.values().sum::<usize>(), used.samples);
    assert!(used.by_reason[&Reason::Slow] > 0 && used.by_reason[&Reason::Fitted] > 0);
    assert!(used.speed_range.unwrap()[0] >= 0.1 && used.cutoff_hz <= 20.0);
    assert!(used.cutoff_reason.contains("as stated"), "{used:?}");
    // What is slow is drawn as not used.
    let series = &found.series[0];
    let slow = series.velocity.iter().zip(&series.used);
    assert!(slow.filter(|(v, used)| v.abs() < 0.05 && **used).count() < 10);
}

/// Temperatures of these recordings are out of order with their dates, until they are sorted.
#[test]
fn temperature_that_rises_with_the_date_is_said_of_comparison_and_diagnosis() {
    let believed = model(&["coulomb", "viscous"]);
    let mut data = recording(3, plain);
    assert_eq!(compared(&data, &believed).varies_together, []);
    let mut temperatures: Vec<_> = (data.sessions.iter_mut())
        .map(|session| session.temperature.take().unwrap())
        .collect();
    temperatures.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for (session, own) in data.sessions.iter_mut().zip(temperatures) {
        session.temperature = Some(own);
    }
    let found = compared(&data, &believed).varies_together;
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].signals, ["temperature", "date"]);
    assert!(
        found[0].correlation > 0.95 && found[0].sessions == 6,
        "{found:?}"
    );
    let told = diagnose(&data, &believed, &mut |_| ()).unwrap();
    assert_eq!(told.varies_together, found);
}

/// The same column twice: only the sum of both coefficients is determined.
#[test]
fn terms_that_cannot_be_told_apart_are_flagged_as_a_pair() {
    let mut believed = model(&["coulomb", "viscous"]);
    believed.effects.push(Term::Custom(CustomEffect {
        name: "film".to_owned(),
        expression: "c*qd".to_owned(),
        bounds: BTreeMap::new(),
    }));
    let found = compared(&recording(3, plain), &believed).soundness;
    let [pair] = found.inseparable.as_slice() else {
        panic!("{found:?}")
    };
    let mut names = pair.parameters.clone();
    names.sort();
    assert_eq!(names, ["b1", "c"]);
    assert!(pair.correlation < -0.95, "{pair:?}");
    let alone = compared(&recording(3, plain), &model(&["coulomb", "viscous"]));
    assert_eq!(alone.soundness.inseparable, []);
    assert!(found.condition > 100.0 * alone.soundness.condition);
}

#[test]
fn what_no_physics_allows_is_told_with_its_bound() {
    let data = recording(3, |s| 5.0 * s.qd.signum() - 20.0 * s.qd);
    let found = compared(&data, &model(&["coulomb", "viscous"])).soundness;
    let [own] = found.implausible.as_slice() else {
        panic!("{found:?}")
    };
    assert_eq!((own.parameter.as_str(), own.bound), ("b1", Some(0.0)));
    assert!((-21.0..-19.0).contains(&own.value), "{own:?}");
    let mut believed = model(&["coulomb", "viscous"]);
    believed.inertia = Inertia::Fit;
    let mut data = recording(3, plain);
    for session in &mut data.sessions {
        // Turned torque turns every sign.
        session.motor_torque.iter_mut().for_each(|own| *own *= -1.0);
        let load = session.joint_torque.iter_mut().flatten();
        load.for_each(|own| *own *= -1.0);
    }
    let found = compared(&data, &believed).soundness.implausible;
    let named: Vec<&str> = found.iter().map(|own| own.parameter.as_str()).collect();
    assert_eq!(named, ["inertia", "b0", "b1"]);
    assert!((found[0].value + INERTIA).abs() < 0.1);
}

/// A speed that is searched has an error, and one that is not known makes the size of
/// the bump less certain.
#[test]
fn searched_values_have_errors_of_their_own() {
    let within = (0..12).filter(|seed| {
        let found = compared(
            &recording(*seed, bump),
            &model(&["coulomb", "viscous", "stribeck"]),
        );
        let holds = |name: &str, truth: f64| {
            let [low, high] = found.parameters[name].interval_95.unwrap();
            assert!(high - low < 0.5 * truth, "{name}: {low} {high}");
            (low..=high).contains(&truth)
        };
        holds("vs", 0.05) && holds("bs", 1.5)
    });
    // Both of 95 %, in twelve: more than two misses once in 40 times.
    assert!(within.count() >= 9);
}

#[test]
fn the_verdict_is_asked_for_at_two_other_cut_offs() {
    let data = recording(3, bump);
    let found = diagnose_at_cutoffs(&data, &model(&["coulomb", "viscous"]), &mut |_| ()).unwrap();
    let others = &found.verdict_at_other_cutoffs;
    assert_eq!(others.len(), 2);
    for (own, factor) in others.iter().zip([0.5, 1.5]) {
        let ratio = own.cutoff_hz / found.used.cutoff_hz;
        assert!((ratio / factor - 1.0).abs() < 0.05, "{ratio} for {factor}");
        assert_eq!(own.verdict, Some(Verdict::Missing), "{own:?}");
        assert!(own.agrees, "{own:?}");
    }
    assert_eq!(found.cutoff_warning(), None);
    let mut other = found.clone();
    other.verdict_at_other_cutoffs[0].agrees = false;
    let warning = other.cutoff_warning().unwrap();
    assert!(warning.contains("depends on the filter"), "{warning}");
}

/// What is claimed is claimed of the samples used.
#[test]
fn a_complete_model_is_complete_in_the_samples_used() {
    let found = diagnose(
        &recording(4, plain),
        &model(&["coulomb", "viscous"]),
        &mut |_| (),
    )
    .unwrap();
    assert_eq!(found.verdict, Verdict::Complete);
    let percent = found.used.share * 100.0;
    assert!(
        found
            .claim()
            .contains(&format!("{percent:.0} % of the samples used")),
        "{}",
        found.claim()
    );
    assert!(!found.runners_up.is_empty() && found.helps_in_part.is_empty());
}

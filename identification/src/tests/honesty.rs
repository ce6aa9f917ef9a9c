//! What is said of the samples used, of parameters and of the filter.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::recordings::{self, INERTIA, JointState, model, plain, recording};
use crate::comparison::{Comparison, Reason};
use crate::data::{CustomEffect, Dataset, Inertia, ModelSpec, RecordedSession, Term};
use crate::{PrepareError, StatedFilter, Verdict, compare, diagnose, diagnose_at_cutoffs};

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

/// Coulomb friction of 1 Nm and viscous friction of 0.5 Nm s under a slow motion, 0.3 kg m²;
/// `noise` is that of the position \[rad\] and of the torque \[Nm\].
fn slow_motion(seed: u64, rate: f64, seconds: f64, noise: [f64; 2]) -> RecordedSession {
    let mut draw = recordings::noise(2 * seed + 1);
    let mut session = RecordedSession {
        name: format!("{rate} Hz, {seed}"),
        period: 1.0 / rate,
        ..RecordedSession::default()
    };
    for at in 0..(seconds * rate) as usize {
        let t = at as f64 / rate;
        let (mut q, mut qd, mut qdd) = (0.0, 0.0, 0.0);
        for (amplitude, hertz) in [(1.0, 0.21), (0.5, 0.37)] {
            let turn = TAU * hertz;
            let (sine, cosine) = (turn * t + 0.7).sin_cos();
            q += amplitude * sine;
            qd += amplitude * turn * cosine;
            qdd -= amplitude * turn * turn * sine;
        }
        session.position.push(q + noise[0] * draw());
        let torque = 0.3 * qdd + qd.signum() + 0.5 * qd;
        session.motor_torque.push(torque + noise[1] * draw());
    }
    session
}

fn of_sessions(sessions: Vec<RecordedSession>) -> Dataset {
    Dataset {
        sessions,
        ..Dataset::default()
    }
}

fn with_inertia(inertia: Inertia, effects: &[&str]) -> ModelSpec {
    ModelSpec {
        inertia,
        ..model(effects)
    }
}

/// With the same filters for both, so many samples wide, the acceleration of the faster one is
/// mostly noise, and the inertia an eighth too small.
#[test]
fn recordings_of_two_rates_are_taken_at_the_slower() {
    let of = |rate: f64, seed: u64| slow_motion(seed, rate, 40.0, [1e-5, 0.02]);
    let believed = with_inertia(Inertia::Fit, &["coulomb", "viscous"]);
    for rates in [[100.0, 1000.0], [1000.0, 100.0]] {
        let data = of_sessions(vec![of(rates[0], 1), of(rates[1], 2)]);
        let found = compared(&data, &believed);
        for (name, truth) in [("inertia", 0.3), ("b0", 1.0), ("b1", 0.5)] {
            let value = found.parameters[name].value;
            assert!(
                (value / truth - 1.0).abs() < 0.02,
                "{name} {value} {rates:?}"
            );
        }
        let used = &found.used;
        assert_eq!(used.by_reason.values().sum::<usize>(), 44_000);
        assert!(used.cutoff_reason.contains("at about 100 Hz"), "{used:?}");
        // The same for a recording that is only predicted.
        let mut data = of_sessions(vec![of(rates[0], 1)]);
        data.held_out = vec![of(rates[1], 2)];
        let inertia = compared(&data, &believed).parameters["inertia"].value;
        assert!((inertia / 0.3 - 1.0).abs() < 0.02, "{inertia} {rates:?}");
        // A stated filter counts samples.
        data.filter = Some(StatedFilter {
            butterworth_hz: 10.0,
            decimation: 5,
            least_speed: 0.1,
        });
        let refused = compare(&data, &believed).unwrap_err().to_string();
        for part in ["100 Hz, ", "1000 Hz, ", "leave [filter] out"] {
            assert!(refused.contains(part), "{refused}");
        }
    }
    // Rates that are as good as the same are left as they are.
    let alike = of_sessions(vec![of(250.0, 1), of(190.0, 2)]);
    let reason = compared(&alike, &believed).used.cutoff_reason;
    assert!(!reason.contains("slowest"), "{reason}");
}

/// A filter of 5 Hz looks half a second to either side.
#[test]
fn stated_filters_leave_out_what_looks_beyond_the_ends() {
    let believed = with_inertia(Inertia::Fit, &["coulomb", "viscous"]);
    let mut data = of_sessions(vec![slow_motion(1, 1000.0, 4.0, [0.0; 2])]);
    data.filter = Some(StatedFilter {
        butterworth_hz: 5.0,
        decimation: 10,
        least_speed: 0.0,
    });
    let found = compared(&data, &believed);
    for (name, truth) in [("inertia", 0.3), ("b0", 1.0), ("b1", 0.5)] {
        let value = found.parameters[name].value;
        assert!((value / truth - 1.0).abs() < 2e-3, "{name} {value}");
    }
    assert!(found.rms.train < 2e-3, "{:?}", found.rms);
    let edges = found.used.by_reason[&Reason::FilterEdges];
    assert!((1000..1500).contains(&edges), "{edges}");
    // Where nothing else is left, that is said.
    data.sessions = vec![slow_motion(1, 1000.0, 1.2, [0.0; 2])];
    let refused = compare(&data, &believed).unwrap_err();
    assert!(
        matches!(refused, PrepareError::NothingExcited { .. }),
        "{refused}"
    );
}

/// Three blocks of time leave an error two degrees of freedom, and its interval is as wide as
/// that needs.
#[test]
fn a_very_short_session_has_an_error_that_holds_the_truth() {
    let believed = with_inertia(Inertia::Given(0.3), &["coulomb"]);
    let trials: u64 = 200;
    let holds = (0..trials).filter(|seed| {
        let mut session = slow_motion(*seed, 100.0, 1.8, [1e-5, 0.02]);
        // Half a second times the speed is viscous friction, which the model does not have.
        let slope = session.position.windows(2).map(|w| (w[1] - w[0]) * 100.0);
        let slope: Vec<f64> = slope.collect();
        let both = session.motor_torque.iter_mut().zip(slope);
        both.for_each(|(torque, speed)| *torque -= 0.5 * speed);
        let found = compared(&of_sessions(vec![session]), &believed);
        assert!((25..40).contains(&found.used.rows), "{}", found.used.rows);
        let own = &found.parameters["b0"];
        let (error, freedom) = (own.std_error.unwrap(), own.freedom.unwrap());
        assert!(error > 0.0 && error < 0.05 && freedom <= 2.0, "{own:?}");
        assert!(found.rms.held_out > found.rms.train, "{:?}", found.rms);
        let [low, high] = own.interval_95.unwrap();
        (low..high).contains(&1.0)
    });
    let share = holds.count() as f64 / trials as f64;
    assert!((0.9..0.995).contains(&share), "{share}");
}

/// What recordings that are held out err by is no variation between those that are fitted.
#[test]
fn variation_between_sessions_is_the_same_in_comparison_and_diagnosis() {
    let believed = model(&["coulomb", "viscous"]);
    let mut data = recording(3, plain);
    let alone = compared(&data, &believed).noise;
    data.held_out = recording(4, |s| 2.0 * plain(s)).sessions;
    let found = compared(&data, &believed).noise;
    assert_eq!(found, alone);
    assert_eq!(
        diagnose(&data, &believed, &mut |_| ()).unwrap().noise,
        alone
    );
    // Friction of about 8 Nm that is scattered by 1 % between sessions.
    let sessions = alone.sessions.unwrap();
    assert!((0.03..0.2).contains(&sessions), "{sessions}");
}

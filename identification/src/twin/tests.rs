use proptest::prelude::*;

use super::*;
use crate::Verdict;
use crate::design::SessionDesign;
use crate::preparation::prepare;
use crate::tests::recordings::{JointState, model, plain, recording};

const MEMORY: f64 = 20.0;
const MODEL: &[&str] = &["coulomb", "viscous"];

fn twin(dataset: &Dataset) -> Twin {
    Twin::new(dataset, &model(MODEL), MEMORY).unwrap()
}

/// The samples of a recording, sessions a minute apart.
fn samples(dataset: &Dataset) -> Vec<TwinSample> {
    let mut start = 0.0;
    let mut all = Vec::new();
    for session in &dataset.sessions {
        for at in 0..session.len() {
            all.push(TwinSample {
                time: start + at as f64 * session.period,
                position: session.position[at],
                motor_torque: session.motor_torque[at],
                joint_torque: session.joint_torque.as_ref().map(|s| s[at]),
                temperature: session.temperature.as_ref().map(|s| s[at]),
            });
        }
        start += 60.0 + session.len() as f64 * session.period;
    }
    all
}

fn feed(twin: &mut Twin, samples: &[TwinSample]) -> Vec<TwinOutput> {
    let mut outputs = Vec::new();
    for sample in samples {
        twin.push(sample, &mut outputs);
    }
    outputs
}

/// Rows on line are the lab's rows, to the last digits.
#[test]
fn rows_are_those_of_the_lab() {
    let data = recording(5, plain);
    let prepared = prepare(&data, &model(MODEL)).unwrap();
    let off_line = fit(&prepared, &Design::new(&prepared)).coefficients;
    let mut twin = twin(&data);
    let outputs = feed(&mut twin, &samples(&data));
    let mut compared = 0;
    let session_length = data.sessions[0].len() as f64 * data.sessions[0].period + 60.0;
    for (k, signals) in prepared.sessions.iter().enumerate() {
        let rows = SessionDesign::new(&prepared, signals, &signals.rows, 1);
        for (i, at) in signals.rows.iter().enumerate() {
            let time = k as f64 * session_length + signals.time(*at);
            let Some(output) = outputs.iter().find(|o| (o.time - time).abs() < 1e-6) else {
                // The lab also has rows to the very end of a session.
                assert!(signals.points.len() - at < 100);
                continue;
            };
            let modelled: f64 = rows.base.iter().zip(&off_line).map(|(c, t)| c[i] * t).sum();
            let residual = rows.measured[i] - modelled;
            assert!(output.slides);
            assert!((output.measured - output.predicted - residual).abs() < 1e-7);
            compared += 1;
        }
    }
    let slides = outputs.iter().filter(|o| o.slides).count();
    // No row that the lab leaves out slides.
    assert!(compared > 1000 && slides == compared, "{compared} {slides}");
}

#[test]
fn a_right_model_stays_within_its_band_and_is_complete() {
    let mut twin = twin(&recording(6, plain));
    feed(&mut twin, &samples(&recording(7, plain)));
    assert!(!twin.out_of_band());
    assert_eq!(twin.change(), None);
    assert_eq!(twin.assess().unwrap().verdict, Verdict::Complete);
    for parameter in twin.parameters() {
        let way = (parameter.value - parameter.off_line).abs();
        assert!(way < 6.0 * parameter.std_error + 0.03 * parameter.off_line.abs());
        assert!(parameter.excitation > 0.99);
    }
}

#[test]
fn a_missing_effect_is_named_after_enough_data() {
    let stribeck = |s: &JointState| plain(s) + 1.5 * (-(s.qd / 0.05).powi(2)).exp() * s.qd.signum();
    let mut twin = twin(&recording(6, plain));
    feed(&mut twin, &samples(&recording(7, stribeck)));
    let diagnosis = twin.assess().unwrap();
    assert_eq!(diagnosis.verdict, Verdict::Missing);
    assert_eq!(diagnosis.candidates[0].effect, "stribeck");
    let signals = &diagnosis.residual_depends_on[0].signals;
    assert!(signals.iter().any(|s| s == "velocity"), "{signals:?}");
}

/// Adds `amount(time since the start)` × q̇, numerically, to the motor torque.
fn with_viscous(samples: &mut [TwinSample], amount: impl Fn(f64) -> f64) {
    let start = samples[0].time;
    let slope: Vec<f64> = samples
        .windows(2)
        .map(|w| (w[1].position - w[0].position) / (w[1].time - w[0].time))
        .collect();
    for (sample, slope) in samples.iter_mut().zip(slope) {
        if slope.abs() < 10.0 {
            sample.motor_torque += amount(sample.time - start) * slope;
        }
    }
}

#[test]
fn a_step_is_told_from_drift_and_the_parameter_named() {
    let data = recording(6, plain);
    let viscous = twin(&data)
        .parameters()
        .iter()
        .position(|p| p.name == "b1")
        .unwrap();
    for (kind, amount) in [
        (
            ChangeKind::Step,
            (|t| if t > 150.0 { 12.0 } else { 0.0 }) as fn(f64) -> f64,
        ),
        (ChangeKind::Drift, |t| {
            12.0 * (t / 500.0_f64).clamp(0.0, 1.0)
        }),
    ] {
        let mut twin = twin(&data);
        let mut changed = samples(&recording(8, plain));
        with_viscous(&mut changed, amount);
        feed(&mut twin, &changed);
        let change = twin.change().unwrap();
        assert_eq!(change.parameter, twin.parameters()[viscous].name);
        assert_eq!(change.kind, kind, "{change:?}");
        assert!(
            (9.0..15.0).contains(&(change.now - change.before)),
            "{change:?}"
        );
        assert!(twin.out_of_band());
    }
}

#[test]
fn the_same_samples_give_the_same_bytes() {
    let (data, other) = (recording(6, plain), samples(&recording(7, plain)));
    let (mut a, mut b) = (twin(&data), twin(&data));
    assert_eq!(feed(&mut a, &other), feed(&mut b, &other));
    assert_eq!(a.parameters(), b.parameters());
}

#[test]
fn bad_samples_are_flagged_and_survived() {
    let data = recording(6, plain);
    let mut twin = twin(&data);
    let good = samples(&recording(7, plain));
    let mut outputs = Vec::new();
    feed(&mut twin, &good[..3000]);
    let last = good[2999];
    let mut flag = |sample: TwinSample| twin.push(&sample, &mut outputs);
    let nan = TwinSample {
        position: f64::NAN,
        ..last
    };
    assert_eq!(flag(nan), Some(Flag::NotFinite));
    assert_eq!(flag(last), Some(Flag::TimeBackwards));
    let jump = TwinSample {
        time: last.time + 3600.0,
        ..last
    };
    assert_eq!(flag(jump), Some(Flag::Gap));
    // An encoder that hangs while the motor works.
    let mut stuck = None;
    for i in 1..400 {
        let time = jump.time + 0.01 * f64::from(i);
        let motor_torque = 60.0 * (0.05 * f64::from(i)).sin();
        stuck = flag(TwinSample {
            time,
            motor_torque,
            ..last
        })
        .or(stuck);
    }
    assert_eq!(stuck, Some(Flag::PositionStuck));
    // An hour at rest with noise on the torque tells nothing and breaks nothing.
    let before = twin.parameters();
    for i in 0..36_000 {
        let noise = 0.1 * f64::from((i * 7919) % 13);
        let sample = TwinSample {
            time: last.time + 8000.0 + 0.1 * f64::from(i),
            motor_torque: last.motor_torque + noise,
            ..last
        };
        assert_ne!(twin.push(&sample, &mut outputs), Some(Flag::PositionStuck));
    }
    assert_eq!(twin.parameters(), before);
    // And on it goes.
    let later: Vec<TwinSample> = good
        .iter()
        .map(|sample| TwinSample {
            time: sample.time + 20_000.0,
            ..*sample
        })
        .collect();
    let after = feed(&mut twin, &later);
    assert!(after.len() > 1000 && !twin.out_of_band());
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let data = recording(6, plain);
    let model = model(&["coulomb", "viscous", "channel_delay"]);
    match Twin::new(&data, &model, MEMORY) {
        Err(error) => assert!(error.to_string().contains("channel_delay"), "{error}"),
        Ok(_) => panic!("channel_delay looks ahead"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// Numbers of any size at any times: whatever is told is finite.
    #[test]
    fn told_is_only_what_is_finite(
        numbers in prop::collection::vec((-0.2..0.7_f64, any::<f64>(), any::<f64>(), -1e3..1e3_f64), 600),
    ) {
        let data = recording(6, plain);
        let mut twin = twin(&data);
        let mut outputs = Vec::new();
        let mut time = 0.0;
        for (step, position, torque, load) in numbers {
            time += step * 0.1;
            twin.push(
                &TwinSample {
                    time,
                    position: position.clamp(-1e6, 1e6),
                    motor_torque: torque.clamp(-1e6, 1e6),
                    joint_torque: Some(load),
                    temperature: None,
                },
                &mut outputs,
            );
        }
        for parameter in twin.parameters() {
            prop_assert!(parameter.value.is_finite() && parameter.std_error.is_finite());
        }
        prop_assert!(twin.residual_rms().is_finite());
        prop_assert!(outputs.iter().all(|o| o.predicted.is_finite() && o.followed.is_finite()));
    }
}

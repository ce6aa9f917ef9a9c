//! Encoders that are coarse beside the noise of the torque: what remains is J times the noise of q̈.

use std::f64::consts::TAU;

use super::recordings::{self, model};
use crate::data::{Dataset, Inertia, ModelSpec, RecordedSession};
use crate::{Diagnosis, Verdict, diagnose, discover};

const RATE: f64 = 500.0;

/// 0.3 kg m² with Coulomb friction of 1 Nm, which grows with the position by `slope` \[Nm/rad\], and
/// viscous friction of 0.5 Nm s in smooth motion, on an encoder of so many bits a turn; the torque is
/// told `late` \[samples\].
fn session(seed: u64, bits: i32, late: usize, slope: f64) -> RecordedSession {
    let mut draw = recordings::noise(2 * seed + 1);
    let mut phases = [0.0; 3];
    phases.fill_with(|| TAU * draw());
    let step = TAU / 2_f64.powi(bits);
    let mut session = RecordedSession {
        name: format!("{bits} bits, {seed}"),
        period: 1.0 / RATE,
        ..RecordedSession::default()
    };
    for at in 0..(30.0 * RATE) as usize {
        let at_time = |t: f64| {
            let waves = [(0.9, 0.21), (0.5, 0.37), (0.1, 1.3)];
            let each = waves.iter().zip(phases);
            each.fold([0.0; 3], |[q, qd, qdd], ((amplitude, hertz), phase)| {
                let turn = TAU * hertz;
                let (sine, cosine) = (turn * t + phase).sin_cos();
                [
                    q + amplitude * sine,
                    qd + amplitude * turn * cosine,
                    qdd - amplitude * turn * turn * sine,
                ]
            })
        };
        let [q, ..] = at_time(at as f64 / RATE);
        session.position.push((q / step).round() * step);
        let [q, qd, qdd] = at_time((at as f64 - late as f64) / RATE);
        let torque = 0.3 * qdd + (1.0 + slope * q) * qd.signum() + 0.5 * qd;
        session.motor_torque.push(torque + 0.02 * draw());
    }
    session
}

fn recording(seed: u64, bits: i32, late: usize, slope: f64) -> Dataset {
    let sessions = (0..4).map(|own| session(10 * seed + own, bits, late, slope));
    Dataset {
        sessions: sessions.collect(),
        ..Dataset::default()
    }
}

fn believed() -> ModelSpec {
    ModelSpec {
        inertia: Inertia::Fit,
        ..model(&["coulomb", "viscous"])
    }
}

fn asked(seed: u64, bits: i32, late: usize) -> Diagnosis {
    let data = recording(seed, bits, late, 0.0);
    diagnose(&data, &believed(), &mut |_| ()).unwrap()
}

#[test]
fn noise_of_the_acceleration_has_no_name() {
    for bits in [14, 15, 16, 17] {
        for seed in 0..2 {
            let found = asked(seed, bits, 0);
            let names: Vec<_> = found.candidates.iter().map(|own| &own.effect).collect();
            let maps: Vec<_> = found
                .residual_depends_on
                .iter()
                .map(|own| &own.signals)
                .collect();
            assert_eq!(
                found.verdict,
                Verdict::Complete,
                "{bits} bits, {seed}: {names:?} {maps:?}"
            );
        }
    }
}

#[test]
fn a_torque_that_is_late_is_named_on_a_coarse_encoder() {
    for bits in [14, 16] {
        let found = asked(5, bits, 5);
        let first = found.candidates.first().expect("a name");
        assert_eq!(first.effect, "channel_delay", "{bits} bits");
        let delay = &first.parameters["delay"];
        assert!(
            (delay.value - 0.010).abs() < 0.001,
            "{bits} bits: {delay:?}"
        );
    }
}

#[test]
fn a_formula_has_no_term_for_it() {
    let data = recording(3, 14, 0, 0.3);
    let found = discover(&data, &believed(), 1, &mut |_| ()).unwrap();
    let first = found.formulas.first().expect("a formula");
    assert_eq!(first.expression, "c1*sign(qd)*q", "{first:#?}");
    let slope = &first.parameters["c1"];
    let error = slope.std_error.expect("an error");
    assert!(
        (slope.value - 0.3).abs() < 4.0 * error && error < 0.02,
        "{slope:?}"
    );
}

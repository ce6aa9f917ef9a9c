//! Effects of which there is more than one, or that one term does not describe.

use super::recordings::{self, JointState, model, plain, recording};
use crate::{Dataset, Verdict, compare, diagnose};

/// What is named step by step, the last verdict, and the error on data held out that is left.
fn complete(data: &Dataset) -> (Vec<String>, Verdict, f64) {
    let mut effects = vec!["coulomb".to_owned(), "viscous".to_owned()];
    loop {
        let names: Vec<&str> = effects.iter().map(String::as_str).collect();
        let found = diagnose(data, &model(&names), &mut |_| ()).unwrap();
        match found.candidates.first() {
            Some(first) if effects.len() < 8 => effects.push(first.effect.clone()),
            _ => return (effects.split_off(2), found.verdict, found.rms.held_out),
        }
    }
}

/// The error on data held out with these effects.
fn left_with(data: &Dataset, effects: &[&str]) -> f64 {
    compare(data, &model(effects)).unwrap().rms.held_out
}

/// The error with nothing hidden, which is noise and what differs between sessions.
fn noise(seed: u64) -> f64 {
    left_with(&recording(seed, plain), &["coulomb", "viscous"])
}

fn waves(s: &JointState, all: &[[f64; 2]]) -> f64 {
    let each = all.iter().map(|[size, k]| size * (k * s.q + size).sin());
    each.sum()
}

#[test]
fn harmonics_of_a_gear_are_found_one_after_the_other() {
    let one = recording(3, |s| plain(s) + waves(s, &[[0.8, 160.0]]));
    let (names, verdict, left) = complete(&one);
    assert_eq!(
        (names, verdict),
        (vec!["ripple".to_owned()], Verdict::Complete)
    );
    assert!((0.9..1.1).contains(&(left / noise(3))), "{left}");
    let three = [[0.8, 160.0], [0.6, 320.0], [0.5, 77.0]];
    let (names, verdict, left) = complete(&recording(3, |s| plain(s) + waves(s, &three)));
    assert_eq!(names, ["ripple", "ripple_2", "ripple_3"]);
    assert_eq!(verdict, Verdict::Complete);
    assert!((0.9..1.15).contains(&(left / noise(3))), "{left}");
}

/// One of them leaves what has not its shape, so that it is no explanation alone.
#[test]
fn two_dents_are_found_one_after_the_other() {
    let dent = |s: &JointState, size: f64, place: f64| {
        size * (-((s.q - place) / 0.02).powi(2)).exp() * s.qd.signum()
    };
    let data = recording(15, |s| plain(s) + dent(s, 2.0, 0.3) + dent(s, 1.5, 0.1));
    let (names, verdict, left) = complete(&data);
    assert_eq!(names, ["local_friction", "local_friction_2"]);
    assert_eq!(verdict, Verdict::Complete);
    assert!((0.9..1.15).contains(&(left / noise(15))), "{left}");
    // A step of friction is not made of dents.
    let step = recording(15, |s| plain(s) + f64::from(s.q > 0.2) * s.qd.signum());
    let (names, verdict, _) = complete(&step);
    assert_eq!((names, verdict), (Vec::new(), Verdict::Unexplained));
}

/// Over 31 K the viscosity falls to a fifth, exponentially. What orders above the second would
/// add is as large as the noise.
#[test]
fn a_viscosity_that_falls_exponentially_has_a_curve_over_temperature() {
    let oil = |s: &JointState| 12.0 * ((-(s.temperature - 11.0) / 20.0).exp() - 1.0) * s.qd;
    let straight = |s: &JointState| -0.6 * (s.temperature - 11.0) * s.qd;
    let data = recording(12, |s| plain(s) + oil(s));
    let (names, verdict, left) = complete(&data);
    assert_eq!(names, ["temperature_viscous", "temperature_viscous_curve"]);
    assert_eq!(verdict, Verdict::Complete);
    let before = left_with(&data, &["coulomb", "viscous", "temperature_viscous"]);
    assert!(left < 0.5 * before, "{left} for {before}");
    assert!((0.9..2.2).contains(&(left / noise(12))), "{left}");
    let (names, verdict, _) = complete(&recording(12, |s| plain(s) + straight(s)));
    assert_eq!(
        (names, verdict),
        (vec!["temperature_viscous".to_owned()], Verdict::Complete)
    );
}

/// Within a session it changes by less than a degree, and is read in whole ones.
#[test]
fn a_temperature_in_whole_degrees_shows_what_changes_with_it() {
    let mut data = recording(13, |s| {
        plain(s) + 0.06 * (s.temperature - 11.0) * s.qd.signum()
    });
    for session in &mut data.sessions {
        let all = session.temperature.iter_mut().flatten();
        for (at, own) in all.enumerate() {
            // What it is warmed by does nothing to friction.
            *own = (*own + 0.9 * at as f64 / 4000.0).round();
        }
    }
    let (names, verdict, _) = complete(&data);
    assert_eq!(
        (names, verdict),
        (vec!["temperature_coulomb".to_owned()], Verdict::Complete)
    );
}

/// A structure that rings at 3.1 Hz, in no step with the motion, and as loud as the noise.
#[test]
fn what_swings_with_time_is_told_with_its_period() {
    let mut data = recording(14, plain);
    for (number, session) in data.sessions.iter_mut().enumerate() {
        for (at, torque) in session.motor_torque.iter_mut().enumerate() {
            let time = at as f64 * session.period;
            *torque += 0.3 * (std::f64::consts::TAU * 3.1 * time + number as f64).sin();
        }
    }
    let found = diagnose(&data, &model(&["coulomb", "viscous"]), &mut |_| ()).unwrap();
    assert_eq!(found.verdict, Verdict::Unexplained);
    let [own] = found.residual_depends_on.as_slice() else {
        panic!("{:?}", found.residual_depends_on);
    };
    assert_eq!(own.signals, ["time"]);
    let period = own.period_s.unwrap();
    assert!((period * 3.1 - 1.0).abs() < 2e-3, "{period}");
    assert!(own.on().contains("period of 0.322"), "{}", own.on());
}

/// A structure that is struck again and again, and rings at 2.5 Hz for a second or two after each blow:
/// in step with nothing. As much noise is nothing.
#[test]
fn what_rings_anew_after_each_blow_is_told_by_its_own_past() {
    let mut ringing = recording(14, plain);
    let mut noisy = ringing.clone();
    let mut chance = recordings::noise(99);
    let omega = std::f64::consts::TAU * 2.5;
    let mut square = 0.0;
    for session in &mut ringing.sessions {
        let (mut x, mut v) = (0.0, 0.0);
        for torque in &mut session.motor_torque {
            let blow = chance();
            v += match blow.abs() > 2.4 {
                true => 0.4 * omega * blow.signum(),
                false => 0.0,
            };
            v -= session.period * omega * (omega * x + 0.1 * v);
            x += session.period * v;
            square += x * x / (6.0 * 4000.0);
            *torque += x;
        }
    }
    for torque in noisy.sessions.iter_mut().flat_map(|s| &mut s.motor_torque) {
        *torque += square.sqrt() * chance();
    }
    let asked = |data| diagnose(data, &model(&["coulomb", "viscous"]), &mut |_| ()).unwrap();
    assert_eq!(asked(&noisy).verdict, Verdict::Complete);
    let found = asked(&ringing);
    assert_eq!(found.verdict, Verdict::Unexplained);
    let [own] = found.residual_depends_on.as_slice() else {
        panic!("{:?}", found.residual_depends_on);
    };
    assert_eq!(own.signals, ["own_past"]);
    assert!((0.3..0.95).contains(&own.strength), "{}", own.strength);
    let period = own.period_s.unwrap();
    assert!((0.9..1.1).contains(&(period * 2.5)), "{period}");
    assert!(
        own.on().starts_with("its own past, which swings"),
        "{}",
        own.on()
    );
}

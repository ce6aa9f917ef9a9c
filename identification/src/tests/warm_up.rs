//! A joint that warms up while nobody measures its temperature.

use super::recordings::{INERTIA, model, noise};
use crate::{Dataset, Diagnosis, RecordedSession, Term, Verdict, add, data::JointType, diagnose};

/// Time constant \[s\] of the heat, and by how much friction falls.
const TIME_CONSTANT: f64 = 80.0;
const FALL: f64 = 6.0;
const PERIOD: f64 = 0.02;

/// A session of `seconds` at 50 Hz, free of load, whose viscous friction falls by [`FALL`] as the joint
/// is heated: evenly, or as its hand-made speed says (`at_work`; it rests every other half minute).
fn recording(seconds: u32, falls: f64, at_work: bool) -> Dataset {
    let mut noise = noise(11);
    let mut session = RecordedSession {
        name: "from cold".to_owned(),
        period: PERIOD,
        ..RecordedSession::default()
    };
    let (mut q, mut warmth) = (0.0, 0.0);
    for at in 0..seconds * 50 {
        let time = f64::from(at) * PERIOD;
        let is_still = at_work && (time / 30.0) as u32 % 2 == 1;
        let (mut qd, mut qdd) = (0.0, 0.0);
        // Each begins and ends a half minute with no speed.
        for (speed, turns) in [(0.5, 4.0), (0.3, 11.0)] {
            let rate = std::f64::consts::TAU * turns / 30.0;
            if !is_still {
                qd += speed * (rate * time).sin();
                qdd += speed * rate * (rate * time).cos();
            }
        }
        let friction = (5.0 + (20.0 - falls * warmth) * qd.abs()) * qd.signum();
        let friction = if qd == 0.0 { 0.0 } else { friction };
        let heating = if at_work { friction * qd / 4.0 } else { 1.0 };
        warmth += (heating - warmth) * PERIOD / TIME_CONSTANT;
        session.position.push(q + 4e-6 * noise());
        let torque = INERTIA * qdd + friction + 0.05 * noise();
        session.motor_torque.push(torque);
        q += qd * PERIOD + 0.5 * qdd * PERIOD * PERIOD;
    }
    Dataset {
        sessions: vec![session],
        held_out: Vec::new(),
        joint: JointType::Revolute,
        filter: None,
    }
}

fn ask(data: &Dataset) -> Diagnosis {
    diagnose(data, &model(&["coulomb", "viscous"]), &mut |_| ()).unwrap()
}

#[test]
fn it_is_named_with_its_time_constant_and_leaves_nothing() {
    for at_work in [false, true] {
        let data = recording(300, FALL, at_work);
        let told = ask(&data);
        assert_eq!(told.verdict, Verdict::Missing, "{told:#?}");
        let first = &told.candidates[0];
        assert_eq!(first.effect, "warm_up_viscous");
        let value = |name: &str| first.parameters[name].value;
        let constant = value("tw");
        assert!((constant / TIME_CONSTANT - 1.0).abs() < 0.15, "{constant}");
        // At work the scale P0 is a mean power, of which 4 W are a part.
        assert_eq!(value("P0") > 0.0, at_work);
        let per_four_watt = if at_work { 4.0 / value("P0") } else { 1.0 };
        let fall = value("bwv") * per_four_watt;
        assert!((fall / FALL - 1.0).abs() < 0.1, "{fall}");
        let term = Term::Catalogue("warm_up_viscous".to_owned());
        let added = add(&data, &model(&["coulomb", "viscous"]), &term).unwrap();
        assert!(
            added.held_out_after < 0.5 * added.held_out_before,
            "{added:?}"
        );
        let known = model(&["coulomb", "viscous", "warm_up_viscous"]);
        let left = diagnose(&data, &known, &mut |_| ()).unwrap();
        assert_eq!(left.verdict, Verdict::Complete, "{left:#?}");
    }
}

#[test]
fn a_joint_that_stays_as_it_is_does_not_warm_up() {
    assert_eq!(ask(&recording(300, 0.0, true)).verdict, Verdict::Complete);
}

/// Friction that rises is something else, and stays without a name.
#[test]
fn a_joint_that_gets_stiffer_does_not_warm_up() {
    let told = ask(&recording(300, -FALL, false));
    assert_eq!(told.verdict, Verdict::Unexplained, "{told:#?}");
    assert!(told.candidates.is_empty());
}

#[test]
fn less_than_a_minute_and_a_measured_temperature_are_told() {
    let short = ask(&recording(50, FALL, false));
    let why = short.not_tested.why_not_tested.iter();
    let mut why = why.filter(|line| line.starts_with("warm_up_coulomb, warm_up_viscous: "));
    assert!(why.next().is_some_and(|line| line.contains("minute")));
    let mut warm = recording(300, FALL, false);
    let count = warm.sessions[0].position.len();
    let temperature = (0..count).map(|at| 20.0 + 8.0 * at as f64 / count as f64);
    warm.sessions[0].temperature = Some(temperature.collect());
    let told = ask(&warm);
    let names = told.candidates.iter().map(|own| own.effect.as_str());
    assert!(names.into_iter().all(|name| !name.starts_with("warm_up")));
}

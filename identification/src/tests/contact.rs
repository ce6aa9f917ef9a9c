//! The engine as a whole on contacts whose answer is written down by hand.

use super::{named, recordings::noise};
use crate::data::{CustomEffect, Dataset, Inertia, JointType, ModelSpec, RecordedSession, Term};
use crate::{Diagnosis, PrepareError, Subject, Verdict, add, compare, diagnose};

/// State of a contact that the F_T of a test is a function of; SI, time in days.
struct ContactState {
    place: f64,
    velocity: f64,
    normal: f64,
    days: f64,
}

impl ContactState {
    fn coulomb(&self, coefficient: f64) -> f64 {
        coefficient * self.normal * self.velocity.signum()
    }
}

/// Eight sessions of 45 s: sines along an edge under three normal forces.
fn recording(force: impl Fn(&ContactState) -> f64) -> Dataset {
    let mut noise = noise(7);
    let sessions = (0..8_u32).map(|k| {
        let days = 31.0 * f64::from(k);
        let scatter = 1.0 + 0.01 * noise();
        let mut session = RecordedSession {
            name: format!("session {}", k + 1),
            start: days * 86_400.0,
            period: 0.012,
            normal_force: Some(Vec::new()),
            ..RecordedSession::default()
        };
        for i in 0..3750 {
            let t = f64::from(i) * 0.012;
            let (mut place, mut velocity) = (0.0, 0.0);
            for (amplitude, rate) in [(0.02, 2.5 + 0.07 * f64::from(k)), (0.015, 0.6)] {
                let (sine, cosine) = (rate * t + 0.4 * f64::from(k)).sin_cos();
                place += amplitude * sine;
                velocity += amplitude * rate * cosine;
            }
            let normal = [6.0, 14.0, 26.0][(t / 15.0) as usize] * (1.0 + 0.03 * (3.1 * t).sin());
            let here = ContactState {
                place,
                velocity,
                normal,
                days,
            };
            session.position.push(place + 2e-6 * noise());
            let measured = scatter * force(&here) + 0.1 * noise();
            session.motor_torque.push(measured);
            let normals = session.normal_force.get_or_insert_default();
            normals.push(normal + 0.1 * noise());
        }
        session
    });
    Dataset {
        sessions: sessions.collect(),
        joint: JointType::Contact,
        ..Dataset::default()
    }
}

fn model(effects: &[&str]) -> ModelSpec {
    let effects = effects.iter();
    ModelSpec {
        inertia: Inertia::Given(0.0),
        gear_ratio: None,
        effects: effects
            .map(|id| Term::Catalogue((*id).to_owned()))
            .collect(),
    }
}

fn ask(effects: &[&str], force: impl Fn(&ContactState) -> f64) -> Diagnosis {
    diagnose(&recording(force), &model(effects), &mut |_| ()).unwrap()
}

#[test]
fn what_is_missing_is_named_with_its_numbers() {
    let plain = |s: &ContactState| s.coulomb(0.3);
    let coulomb = ask(&[], plain);
    assert_eq!(named(&coulomb), "contact_coulomb");
    let b0t = &coulomb.candidates[0].parameters["b0T"];
    assert!((b0t.value - 0.3).abs() < 0.01, "{b0t:?}");
    assert_eq!(ask(&["contact_coulomb"], plain).verdict, Verdict::Complete);

    let viscous = ask(&["contact_coulomb"], |s| plain(s) + 15.0 * s.velocity);
    assert_eq!(named(&viscous), "contact_viscous");
    assert_eq!(viscous.candidates[0].parameters["c"].unit, "N s/m");

    let falling = |s: &ContactState| s.coulomb(0.06 * (-(s.velocity / 0.008).powi(2)).exp());
    let stribeck = ask(&["contact_coulomb"], |s| plain(s) + falling(s));
    assert_eq!(named(&stribeck), "contact_stribeck");
    let vs = stribeck.candidates[0].parameters["vs"].value;
    assert!((0.0065..0.0095).contains(&vs), "{vs}");

    let stretch = |s: &ContactState| match (0.004..0.016).contains(&s.place) {
        true => s.coulomb(-0.06),
        false => 0.0,
    };
    let spot = ask(&["contact_coulomb"], |s| plain(s) + stretch(s));
    assert_eq!(named(&spot), "contact_spot");
    let place = &spot.candidates[0].parameters["rl"];
    assert!((place.value - 0.01).abs() < 0.002 && place.unit == "m");

    let worn = |s: &ContactState| s.coulomb(0.15 * (1.0 - (-s.days / 120.0).exp()));
    let wear = ask(&["contact_coulomb"], |s| plain(s) + worn(s));
    assert_eq!(named(&wear), "contact_wear");
    let days = &wear.candidates[0].parameters["tw"];
    assert!((80.0..180.0).contains(&days.value) && days.unit == "d");
}

/// The paper's Fig. 16, in the rows near rest: the motors move back, the tip rests.
#[test]
fn a_tip_that_rests_until_it_has_wound_up_is_seen_however_little_it_is() {
    for stiffness in [2e4, 1e5] {
        let mut data = recording(|_| 0.0);
        for session in &mut data.sessions {
            let normal = session.normal_force.clone().unwrap_or_default();
            let mut tip = session.position[0];
            for (at, noisy) in session.motor_torque.iter_mut().enumerate() {
                // Written as where the tip is, not as what the spring holds.
                let (place, most) = (session.position[at], 0.3 * normal[at]);
                let slack = most / stiffness;
                tip = tip.clamp(place - slack, place + slack);
                *noisy += stiffness * (place - tip);
            }
        }
        let spec = model(&["contact_coulomb"]);
        let diagnosis = diagnose(&data, &spec, &mut |_| ()).unwrap();
        assert_eq!(named(&diagnosis), "contact_compliance");
        let found = &diagnosis.candidates[0];
        assert!(found.held_out_after < 0.3 * found.held_out_before);
        let k = &found.parameters["k"];
        assert!((k.value / stiffness - 1.0).abs() < 0.1, "{k:?}");
        assert_eq!(k.unit, "N/m");

        let added = add(
            &data,
            &spec,
            &Term::Catalogue("contact_compliance".to_owned()),
        )
        .unwrap();
        assert!((added.held_out_before - found.held_out_before).abs() < 1e-9);
        assert!((added.held_out_after / found.held_out_after - 1.0).abs() < 0.1);
        let after = diagnose(&data, &added.model, &mut |_| ()).unwrap();
        assert_eq!(after.verdict, Verdict::Complete);
    }
}

#[test]
fn what_the_catalogue_lacks_has_signals_in_the_words_of_a_contact() {
    let hertz = |s: &ContactState| 3.0 * (s.normal / 14.0).powf(0.6) * s.velocity.signum();
    let diagnosis = ask(&["contact_coulomb"], hertz);
    assert_eq!(diagnosis.verdict, Verdict::Unexplained);
    assert!(diagnosis.candidates.is_empty());
    let first = &diagnosis.residual_depends_on[0].signals;
    assert!(first.contains(&"normal_force".to_owned()), "{first:?}");
}

#[test]
fn maps_and_units_are_those_of_a_contact() {
    let data = recording(|s| s.coulomb(0.3));
    let comparison = compare(&data, &model(&["contact_coulomb"])).unwrap();
    let maps: Vec<(&str, &str)> = comparison
        .residual_maps
        .iter()
        .map(|map| (map.signal.as_str(), map.unit.as_str()))
        .collect();
    for wanted in [
        ("tip_velocity", "m/s"),
        ("place", "m"),
        ("normal_force", "N"),
        ("time", "s"),
        ("date", "d"),
    ] {
        assert!(maps.contains(&wanted), "{wanted:?} in {maps:?}");
    }
    assert_eq!(comparison.parameters["b0T"].unit, "1");
    assert!(comparison.simulation.is_none());
    assert!(comparison.rms.held_out < 0.12);
}

#[test]
fn a_formula_takes_part_in_the_names_of_a_contact() {
    let mut spec = model(&["contact_coulomb"]);
    let data = recording(|s| s.coulomb(0.3) + 2.0 * s.normal * s.velocity);
    let film = |expression: &str| {
        Term::Custom(CustomEffect {
            name: "film".to_owned(),
            expression: expression.to_owned(),
            bounds: std::collections::BTreeMap::new(),
        })
    };
    let added = add(&data, &spec, &film("a*F_N*rd")).unwrap();
    let a = added.parameters["a"].value;
    assert!((a - 2.0).abs() < 0.1 && added.held_out_after < 0.5 * added.held_out_before);
    // Names of a joint's signals are free here, and so parameters.
    spec.effects.push(film("tau*F_N*rd"));
    assert!(
        compare(&data, &spec)
            .unwrap()
            .parameters
            .contains_key("tau")
    );
}

#[test]
fn what_cannot_be_is_refused_in_the_words_of_a_contact() {
    let good = recording(|s| s.coulomb(0.3));
    let refused = |data: &Dataset, spec: &ModelSpec| compare(data, spec).unwrap_err();
    assert_eq!(
        refused(&good, &model(&["coulomb"])),
        PrepareError::OtherSubject {
            id: "coulomb".to_owned(),
            of: Subject::Joint,
            recorded: Subject::Contact,
        }
    );
    let unknown = refused(&good, &model(&["contact_magic"])).to_string();
    assert!(unknown.contains("contact_spot") && !unknown.contains("backlash"));
    let alone = refused(&good, &model(&["contact_compliance"])).to_string();
    assert!(alone.contains("contact_coulomb"), "{alone}");
    let heavy = ModelSpec {
        inertia: Inertia::Fit,
        ..model(&["contact_coulomb"])
    };
    assert_eq!(refused(&good, &heavy), PrepareError::InertiaOfContact);

    let with = |change: fn(&mut RecordedSession)| {
        let mut data = good.clone();
        data.sessions.iter_mut().for_each(change);
        refused(&data, &model(&["contact_coulomb"]))
    };
    assert_eq!(with(|s| s.normal_force = None), PrepareError::NoNormalForce);
    let flipped = with(|s| {
        let forces = s.normal_force.iter_mut().flatten();
        forces.for_each(|force| *force = -*force);
    });
    assert_eq!(flipped, PrepareError::NeverTouched);
    let still = with(|s| s.motor_torque.fill(1.0)).to_string();
    assert!(still.contains("tangential_force"), "{still}");
    let still = with(|s| s.position.fill(1.0)).to_string();
    assert!(still.contains("place"), "{still}");
}

//! Friction fed forward, taken over and given back.

use ferntast_model::friction::FrictionParameters;

use super::*;
use proptest::prelude::*;

const CONFIGURED: [(&str, &str, f64); 5] = [
    ("coulomb", "b_0", 12.372),
    ("load_coulomb", "b_0T", 0.146),
    ("viscous", "b_1", 163.301),
    ("quadratic_viscous", "b_2", -578.954),
    ("cubic_viscous", "b_3", 547.449),
];
const NAMES: [&str; 5] = ["b0", "b0T", "b1", "b2", "b3"];

fn feed_forward() -> FeedForward {
    let effects = CONFIGURED
        .iter()
        .map(|(effect, name, value)| ((*effect).to_owned(), [((*name).to_owned(), *value)].into()))
        .collect();
    let mut joint = crate::servo::tests::joint();
    joint.friction = FrictionParameters {
        speed_range: [0.0175, 0.698],
        effects,
    };
    FeedForward::new(&joint, TakeOverConfig::default()).unwrap()
}

fn found(factor: f64) -> [FoundParameter<'static>; 5] {
    std::array::from_fn(|i| FoundParameter {
        name: NAMES[i],
        value: factor * CONFIGURED[i].2,
        std_error: 0.01 * CONFIGURED[i].2.abs(),
        excitation: 0.99,
    })
}

fn settle(own: &mut FeedForward) {
    for _ in 0..2_010 {
        own.step(1e-3);
    }
}

#[test]
fn what_was_found_is_used_and_given_back_without_a_jump() {
    let mut own = feed_forward();
    let torque = |own: &FeedForward| own.torque(0.0, 0.3, 5.0).sliding;
    let configured = torque(&own);
    assert_eq!(own.take_over(&found(1.3)).unwrap().count, 5);
    assert!(own.is_taken_over() && own.is_on_the_way());
    let mut last = torque(&own);
    assert_eq!(last, configured);
    for step in 0..4_000 {
        if step == 900 {
            // Back before it is there.
            own.give_back();
        }
        own.step(1e-3);
        let now = torque(&own);
        // 30 % of some 16 Nm in two seconds.
        assert!((now - last).abs() < 0.01, "{now} after {last}");
        last = now;
    }
    assert_eq!(last, configured);
    own.take_over(&found(1.3)).unwrap();
    settle(&mut own);
    assert!((torque(&own) / configured - 1.3).abs() < 1e-12);
    assert!(!own.is_on_the_way());
    own.give_back();
    settle(&mut own);
    assert_eq!(torque(&own), configured);
    assert!(own.parameters().all(|one| one.value == one.configured));
}

#[test]
fn only_what_is_certain_is_taken_over() {
    let mut own = feed_forward();
    let mut some = found(1.2);
    some[1].excitation = 0.5;
    some[2].std_error = 0.2 * some[2].value;
    some[3].std_error = f64::NAN;
    some[4].value = f64::INFINITY;
    assert_eq!(own.take_over(&some).unwrap().count, 1);
    let targets: Vec<f64> = own.parameters().map(|one| one.target).collect();
    assert_eq!(targets[0], 1.2 * CONFIGURED[0].2);
    for i in 1..5 {
        assert_eq!(targets[i], CONFIGURED[i].2);
    }
    let before = own.clone();
    for all in [&mut some[..], &mut []] {
        for one in all.iter_mut() {
            one.excitation = 0.0;
        }
        assert_eq!(own.take_over(all), Err(TakeOverRefusal::NothingCertain));
    }
    assert!(own.parameters().eq(before.parameters()));
}

#[test]
fn what_is_too_far_away_is_refused_as_a_whole_and_by_name() {
    let mut own = feed_forward();
    let mut far = found(1.2);
    far[2].value = 1.6 * CONFIGURED[2].2;
    far[2].std_error = 0.0;
    match own.take_over(&far) {
        Err(refusal @ TakeOverRefusal::Parameter { name: "b_1", .. }) => {
            let words = refusal.to_string();
            let expected = "b_1 = 261.28 Nm s/rad is outside 81.65 … 244.95: [servo.take_over] parameter_share";
            assert_eq!(words, expected);
        }
        other => panic!("{other:?}"),
    }
    // Each within its bounds, together too much: less of what slows down.
    let mut together = found(1.0);
    together[2].value = 1.45 * CONFIGURED[2].2;
    together[3].value = 0.55 * CONFIGURED[3].2;
    let error = own.take_over(&together).unwrap_err();
    assert!(matches!(error, TakeOverRefusal::Torque { .. }), "{error}");
    assert!(error.to_string().contains("rad/s"));
    assert!(!own.is_taken_over() && !own.is_on_the_way());
}

fn certain(name: &str, value: f64) -> FoundParameter<'_> {
    FoundParameter {
        name,
        value,
        std_error: 0.0,
        excitation: 1.0,
    }
}

#[test]
fn an_effect_that_is_not_configured_comes_up_and_goes_again() {
    let mut own = feed_forward();
    let configured: Vec<_> = own.parameters().collect();
    let before = own.torque(0.0, 0.03, 0.0);
    let bump = [certain("bs", 4.0), certain("vs", 0.03)];
    assert_eq!(own.take_over(&bump).unwrap().count, 1);
    settle(&mut own);
    let with = own.torque(0.0, 0.03, 0.0);
    assert!((with.sliding - before.sliding - 4.0 * (-1.0_f64).exp()).abs() < 1e-12);
    assert_eq!(own.parameters().last().map(|one| one.value), Some(0.03));
    // Another shape is led over from the old one without a jump.
    own.take_over(&[certain("bs", 4.0), certain("vs", 0.05)])
        .unwrap();
    assert!((own.torque(0.0, 0.03, 0.0).sliding - with.sliding).abs() < 1e-12);
    assert_eq!(own.parameters().count(), configured.len() + 4);
    settle(&mut own);
    assert_eq!(own.parameters().count(), configured.len() + 2);
    own.give_back();
    settle(&mut own);
    assert_eq!(own.torque(0.0, 0.03, 0.0), before);
    assert!(own.parameters().eq(configured));
}

#[test]
fn a_spring_is_fed_forward_at_rest_too_and_a_weight_too_heavy_is_refused() {
    let mut own = feed_forward();
    own.take_over(&[certain("kc", 2.0), certain("k0", 0.5)])
        .unwrap();
    settle(&mut own);
    let standing = own.torque(0.4, 0.0, 0.0).standing;
    assert!((standing - 1.3).abs() < 1e-12, "{standing}");
    let heavy = own.take_over(&[certain("g_s", 30.0), certain("g_c", 0.0)]);
    assert!(
        matches!(heavy, Err(TakeOverRefusal::Torque { .. })),
        "{heavy:?}"
    );
    assert_eq!(own.torque(0.4, 0.0, 0.0).standing, standing);
}

#[test]
fn what_cannot_be_fed_forward_is_left_out_with_a_reason() {
    let mut own = feed_forward();
    let date = Err(TakeOverRefusal::NothingStatic(LeftOut::Unknown(
        Signal::Date,
    )));
    assert_eq!(own.take_over(&[certain("kw", 0.1)]), date);
    let delay = Err(TakeOverRefusal::NothingStatic(LeftOut::NotStatic));
    assert_eq!(own.take_over(&[certain("delay", 0.1)]), delay);
    let warmth = [certain("kT", 0.1), certain("T0", 10.0), certain("b0", 12.0)];
    let taken = own.take_over(&warmth).unwrap();
    let unknown = LeftOut::Unknown(Signal::Temperature);
    assert_eq!((taken.count, taken.left_out), (1, Some(("kT", unknown))));
    let bare = own.take_over(&[certain("bs", 3.0)]);
    assert_eq!(bare, Err(TakeOverRefusal::NothingStatic(LeftOut::NoShape)));
}

#[test]
fn temperature_counts_within_a_reach() {
    let mut own = feed_forward();
    own.set_temperature(15.0);
    let warmth = [certain("kT", 0.1), certain("T0", 10.0)];
    assert_eq!(own.take_over(&warmth).unwrap().count, 1);
    settle(&mut own);
    let at = |own: &mut FeedForward, temperature: f64| {
        own.set_temperature(temperature);
        own.torque(0.0, 0.1, 0.0).sliding
    };
    let reference = at(&mut own, 10.0);
    assert!((at(&mut own, 15.0) - reference - 0.5).abs() < 1e-12);
    assert!((at(&mut own, 90.0) - reference - 1.5).abs() < 1e-12);
}

/// Found at up to 0.1 rad/s, with a polynomial that runs away beyond: what is fed forward there
/// is what is configured and the difference that was seen last, led over without a jump.
#[test]
fn beyond_the_speeds_seen_the_difference_stays() {
    let mut own = feed_forward();
    let configured = own.clone();
    let mut far = found(1.2).to_vec();
    far[3].value = 0.6 * CONFIGURED[3].2;
    far[4].value = 1.5 * CONFIGURED[4].2;
    let refused = own.take_over(&far).unwrap_err();
    assert!(
        matches!(refused, TakeOverRefusal::Torque { .. }),
        "{refused}"
    );
    far.push(certain(FASTEST_SEEN, 0.1));
    assert_eq!(own.take_over(&far).unwrap().count, 5);
    settle(&mut own);
    assert_eq!(own.parameters().last().map(|one| one.value), Some(0.1));
    let difference = |own: &FeedForward, speed: f64| {
        let torque = |of: &FeedForward| of.torque(0.0, speed, 5.0).sliding;
        torque(own) - torque(&configured)
    };
    let seen = difference(&own, 0.1);
    assert!(seen > 5.0, "{seen} Nm");
    for (speed, sign) in [(0.2, 1.0), (0.5, 1.0), (0.9, 1.0), (-0.5, -1.0)] {
        assert!(
            (difference(&own, speed) - sign * seen).abs() < 1e-9,
            "{speed}"
        );
    }
    assert!(difference(&own, 0.07) < seen);
    // On to what was seen at other speeds, and back, without a jump at any speed.
    let speeds = [0.05, 0.2, 0.6];
    let mut last = speeds.map(|speed| difference(&own, speed));
    far[5].value = 0.15;
    far[3].value = 0.95 * CONFIGURED[3].2;
    far[4].value = 1.1 * CONFIGURED[4].2;
    own.take_over(&far).unwrap();
    for step in 0..5_000 {
        if step == 2_500 {
            own.give_back();
        }
        own.step(1e-3);
        let now = speeds.map(|speed| difference(&own, speed));
        for (now, last) in now.iter().zip(last) {
            assert!((now - last).abs() < 0.02, "{now} after {last}");
        }
        last = now;
    }
    assert_eq!(last, [0.0; 3]);
    assert!(own.parameters().all(|one| one.name != FASTEST_SEEN));
}

proptest! {
    /// Whatever is found, what is fed forward is finite and against the motion.
    #[test]
    fn friction_stays_friction(
        values in prop::array::uniform5(0.4..1.6_f64),
        errors in prop::array::uniform5(0.0..0.1_f64),
        steps in 0..3_000,
    ) {
        let mut own = feed_forward();
        let all: [FoundParameter<'_>; 5] = std::array::from_fn(|i| FoundParameter {
            value: values[i] * CONFIGURED[i].2,
            std_error: errors[i] * CONFIGURED[i].2.abs(),
            ..found(1.0)[i]
        });
        let _ = own.take_over(&all);
        for _ in 0..steps {
            own.step(1e-3);
        }
        for step in 1..40 {
            let speed = 0.02 * f64::from(step);
            prop_assert!(own.torque(0.0, speed, 0.0).sliding > 0.0);
            prop_assert!(own.torque(0.0, -speed, 0.0).sliding < 0.0);
        }
    }
}

//! The two layers between seeded channels, hands, scales and things to touch, on the whole arm:
//! servo, contact-force estimator and limiter of the hand's force as they ship. What leaves at
//! hand and tip is held against what entered there, by the simulated bodies themselves.

use crate::common::{stiffest, stopping, under_trial};
use crate::random_cases::{failures, report};
use crate::thorough::is_thorough;
use ferntast_control::delay::{InnerLaw, Law, TwoLayer};
use ferntast_control::haptics::MasterConfig;
use ferntast_sim::teleoperation::{ArmUnderTrial, Draw, FollowerModel, Trial};

/// Seeds tried.
const CASES: u64 = 1000;

/// A trial on `arm` with a law that `law` makes of a draw.
fn trial(arm: &ArmUnderTrial, seed: u64, law: impl Fn(&mut Draw) -> Law) -> Trial {
    let follower = FollowerModel::Arm(Box::new(arm.clone()));
    Trial::drawn(seed, follower, Some(MasterConfig::default()), law)
}

/// The layers around `inside`, at scales of their own.
fn two_layer(draw: &mut Draw, inside: InnerLaw, stiffness: f64) -> TwoLayer {
    TwoLayer {
        inside,
        position_scale: draw.between(0.5, 1.5),
        force_scale: draw.between(0.02, 1.0),
        servo_stiffness: stiffness,
        ..TwoLayer::default()
    }
}

/// The arm, and how stiff its servo is at most \[N/m\].
fn stiff_arm() -> (ArmUnderTrial, f64) {
    let arm = under_trial();
    let stiffness = stiffest(&arm);
    (arm, stiffness)
}

/// Whoever claims passivity is tried here.
#[test]
fn who_claims_passivity_gives_out_no_more_than_it_took_in() {
    let laws = Law::all().into_iter().filter(Law::claims_passivity);
    let claims: Vec<_> = laws.map(|law| law.name()).collect();
    assert_eq!(
        claims,
        ["two_layer", "auto"],
        "who claims passivity is to be tried here"
    );
    let (arm, stiffness) = stiff_arm();
    let arms = [stopping(), arm];
    // Each of the four pairs of arm and law has a quarter of the cases.
    report(&failures(CASES, |seed| {
        trial(&arms[(seed % 2) as usize], seed, |draw| {
            let layers = two_layer(draw, InnerLaw::default(), stiffness);
            match seed / 2 % 2 {
                0 => Law::TwoLayer(layers),
                _ => Law::Auto(layers.into()),
            }
        })
    }));
}

/// Bare, each of them makes some joules or some tens of them in some of the cases.
#[test]
fn around_the_other_laws_the_layer_leaves_a_tenth_of_a_joule_of_it() {
    let (arm, stiffness) = stiff_arm();
    for inside in InnerLaw::all() {
        let energy = |seed: u64, bare: bool| {
            let inside = inside.clone();
            let make = |draw: &mut Draw| {
                let layered = Law::TwoLayer(two_layer(draw, inside.clone(), stiffness));
                match bare {
                    true => Law::by_name(inside.name())
                        .expect("every inner law is a law")
                        .between(&layered.mapping()),
                    false => layered,
                }
            };
            let trial = trial(&arm, seed, make);
            trial.run().expect("a valid trial").energy_margin
        };
        let cases = 0..if is_thorough() { 60 } else { 30 };
        let with = cases.clone().map(|seed| energy(seed, false));
        let with = with.fold(0.0, f64::min);
        let told = format!("{}: {with:.3} J", inside.name());
        assert!(with > -0.15, "{told}");
        let much = 5.0 * with.min(-0.02);
        let mut without = cases.map(|seed| energy(seed, true));
        let makes_energy = inside.name() != "model_mediated";
        assert!(
            !makes_energy || without.any(|own| own < much),
            "{told}, bare above {much:.3} J"
        );
        println!("{told}");
    }
}

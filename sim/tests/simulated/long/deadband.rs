//! Links that leave frames out: what is led on in their place makes no energy at hand and tip,
//! and is not felt.

use crate::common::{configured, stiffest, under_trial};
use crate::random_cases::{failures, report};
use ferntast_control::codec::Deadband;
use ferntast_control::delay::{InnerLaw, Law, TwoLayer};
use ferntast_control::haptics::MasterConfig;
use ferntast_sim::teleoperation::{Draw, Environment, FollowerModel, Trial};

/// Seeds tried for each law on the light tip.
const LIGHT: u64 = 120;
/// Seeds tried on the whole arm.
const WHOLE: u64 = 150;

/// What is too small to be sent, from nearly nothing to what is felt.
fn deadband(seed: u64) -> Deadband {
    let mut draw = Draw::of(!seed);
    Deadband {
        force_share: draw.between(0.0, 0.2),
        force_floor: draw.between(0.0, 0.2),
        velocity_share: draw.between(0.0, 0.3),
        velocity_floor: draw.between(0.0, 0.02),
        position_floor: draw.between(0.0, 0.0002),
        energy_floor: draw.between(0.0, 0.005),
        keep_alive: draw.between(0.002, 0.01),
        refresh: draw.between(0.01, 0.5),
        ..Deadband::default()
    }
}

/// Energies are held and positions are led on: by their own books the laws stay as they are.
#[test]
fn a_law_whose_books_say_so_gives_out_no_more_with_any_deadband() {
    for name in ["tdpa", "wave"] {
        report(&failures(LIGHT, |seed| {
            let mut draw = Draw::of(seed);
            let scale = draw.between(0.5, 2.0);
            let law = configured(name, 1.0, &format!("position_scale = {scale}"));
            let link = draw.link(true);
            let environment = Environment::ALL[seed as usize % Environment::ALL.len()];
            Trial {
                hand: draw.hand(),
                deadband: Some(deadband(seed)),
                ..Trial::new(law, link, environment, seed)
            }
        }));
    }
}

/// The tanks of both ends supervise what is led on as they do the delay.
#[test]
fn two_layers_give_out_no_more_than_they_took_in_with_any_deadband() {
    let arm = under_trial();
    let stiffness = stiffest(&arm);
    let law = Law::TwoLayer(TwoLayer {
        inside: InnerLaw::default(),
        servo_stiffness: stiffness,
        ..TwoLayer::default()
    });
    report(&failures(WHOLE, |seed| {
        let follower = FollowerModel::Arm(Box::new(arm.clone()));
        let master = Some(MasterConfig::default());
        Trial {
            deadband: Some(deadband(seed)),
            ..Trial::drawn(seed, follower, master, |draw| draw.scaled(&law))
        }
    }));
}

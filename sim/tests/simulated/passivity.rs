//! Every law between seeded channels, hands and things to touch, with the tip that the laws
//! reckon with: a mass on the servo's spring whose contact force is known at once. What
//! leaves the two-port between hand and tip is never more than what entered it, for each law
//! whose books say so. What that is worth with a whole arm, `true_ports.rs` and `whole_arm.rs`
//! tell.

use crate::common::configured;
use crate::random_cases::{cases, failures, report};
use ferntast_control::delay::{Guarantee, Law};
use ferntast_sim::teleoperation::{Draw, Environment, Trial};

/// Seeds tried for each law.
const CASES: u64 = 120;

fn trial(draw: &mut Draw, law: Law, outages: bool, seed: u64) -> Trial {
    let link = draw.link(outages);
    let environment = Environment::ALL[seed as usize % Environment::ALL.len()];
    let mut trial = Trial::new(law, link, environment, seed);
    if outages && draw.chance(0.3) {
        trial.buffer = draw.between(0.0, 0.05);
    }
    trial.hand = draw.hand();
    trial
}

#[test]
fn a_law_whose_books_say_so_gives_out_no_more_than_it_took_in() {
    let claiming: Vec<&str> = Law::all()
        .iter()
        .filter(|law| law.guarantee() == Guarantee::ByItsBooks)
        .map(Law::name)
        .collect();
    assert!(claiming.contains(&"wave") && claiming.contains(&"tdpa"));
    for name in claiming {
        report(&failures(CASES, |seed| {
            let mut draw = Draw::of(seed);
            let scales = format!("position_scale = {}", draw.between(0.5, 2.0));
            trial(&mut draw, configured(name, 1.0, &scales), true, seed)
        }));
    }
}

#[test]
fn a_law_whose_books_say_so_while_connected_does_so_while_frames_come() {
    let claiming = Law::all();
    let claiming = claiming
        .iter()
        .filter(|law| law.guarantee() == Guarantee::ByItsBooksWhileConnected);
    for law in claiming {
        report(&failures(CASES, |seed| {
            let mut draw = Draw::of(seed);
            trial(&mut draw, configured(law.name(), 1.0, ""), false, seed)
        }));
    }
}

#[test]
fn the_test_can_fail() {
    // Position–force makes energy on a stiff wall, and the test sees it.
    let found = failures(CASES, |seed| {
        let mut draw = Draw::of(seed);
        let law = configured("position_force", 1.0, "");
        trial(&mut draw, law, true, seed)
    });
    assert!(found.len() as u64 > cases(CASES) / 4, "{}", found.len());
}

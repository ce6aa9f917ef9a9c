//! Every law between seeded channels, hands and things to touch, with the tip that the laws
//! reckon with: a mass on the servo's spring whose contact force is known at once. What
//! leaves the two-port between hand and tip is never more than what entered it, for each law
//! whose books say so. What that is worth with a whole arm, `whole_arm.rs` tells.
//!
//! A case comes from its seed alone; a case that fails prints its seed, and
//! `FERNTAST_PASSIVITY_CASES` sets how many seeds are tried.

use ferntast_control::delay::{Guarantee, Law};
use ferntast_emulation::channel::{
    Bandwidth, Blackout, ChannelConfig, Jitter, LinkConfig, Loss, Reordering,
};
use ferntast_emulation::hand::ImpedanceParameters;
use ferntast_model::ParameterError;
use ferntast_sim::teleoperation::{Environment, Outcome, Trial};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{RngCore, SeedableRng};

/// Energy that may leave beyond what entered \[J\], at the hand's scale: the
/// kinetic energy of the arm (0.3 kg at up to 0.3 m/s, 14 mJ) and what one
/// step overdraws before it is paid back.
const BOUND: f64 = 0.02;
/// Seeds tried for each law.
const CASES: u64 = 120;

/// Draws from a seed.
struct Draw(Pcg64Mcg);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    fn channel(&mut self, outages: bool) -> ChannelConfig {
        // To 1 s each way; a third of the channels are short.
        let longest = if self.chance(0.33) { 0.05 } else { 1.0 };
        let most_lost = if outages { 0.5 } else { 0.05 };
        ChannelConfig {
            delay: self.between(0.0, longest),
            jitter: match self.0.next_u64() % 4 {
                0 => None,
                1 => Some(Jitter::Uniform {
                    half_width: self.between(0.0, 0.01),
                }),
                2 => Some(Jitter::Normal {
                    deviation: self.between(0.0, 0.003),
                }),
                _ => Some(Jitter::Exponential {
                    mean: self.between(0.0, 0.002),
                }),
            },
            overtaking: self.chance(0.5),
            loss: match self.0.next_u64() % 3 {
                0 => None,
                1 => Some(Loss::Independent {
                    probability: self.between(0.0, most_lost),
                }),
                _ if outages => Some(Loss::GilbertElliott {
                    good_to_bad: self.between(0.0, 0.05),
                    bad_to_good: self.between(0.05, 0.5),
                    loss_in_good: 0.01,
                    loss_in_bad: 0.9,
                }),
                _ => None,
            },
            reordering: self.chance(0.3).then(|| Reordering {
                probability: self.between(0.0, 0.3),
                hold_back: self.between(0.0, 0.01),
            }),
            duplication: if self.chance(0.3) {
                self.between(0.0, 0.5)
            } else {
                0.0
            },
            bandwidth: self.chance(0.2).then(|| Bandwidth {
                rate: self.between(250e3, 1e6),
                queue: 600,
                overhead: 0,
            }),
            blackout: if outages && self.chance(0.4) {
                vec![Blackout {
                    start: self.between(1.0, 12.0),
                    duration: self.between(0.05, 1.5),
                    period: if self.chance(0.3) { 4.0 } else { 0.0 },
                }]
            } else {
                Vec::new()
            },
        }
    }

    fn trial(&mut self, law: Law, outages: bool, seed: u64) -> Trial {
        let link = LinkConfig {
            up: self.channel(outages),
            down: self.channel(outages),
            ..LinkConfig::default()
        };
        let environment = Environment::ALL[(seed % 5) as usize];
        let mut trial = Trial::new(law, link, environment, seed);
        if outages && self.chance(0.3) {
            trial.buffer = self.between(0.0, 0.05);
        }
        trial.hand = ImpedanceParameters {
            mass: self.between(0.3, 2.0),
            damping: self.between(5.0, 50.0),
            stiffness: self.between(50.0, 1000.0),
        };
        trial
    }
}

/// The law as a configuration would set it.
fn configured(name: &str, keys: &str) -> Law {
    let law: Law = toml::from_str(&format!("kind = \"{name}\"\nforce_scale = 1.0\n{keys}"))
        .expect("keys of the law");
    assert_eq!(law.validate(), Ok(()));
    law
}

fn cases() -> u64 {
    std::env::var("FERNTAST_PASSIVITY_CASES")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(CASES)
}

/// Runs the trial of each seed on both cores; the failures, in words.
fn failures(trial: impl Fn(u64) -> Trial + Sync) -> Vec<String> {
    let judge = |seed: u64| -> Option<String> {
        let trial = trial(seed);
        let result: Result<Outcome, ParameterError> = trial.run();
        let outcome = result.expect("a valid trial");
        let fine = outcome.energy_margin > -BOUND && outcome.energy_margin.is_finite();
        (!fine).then(|| {
            format!(
                "{}, {}, seed {seed}: {:.4} J\n  {:?}",
                trial.law.name(),
                trial.environment.name(),
                outcome.energy_margin,
                trial.link,
            )
        })
    };
    let judge = &judge;
    std::thread::scope(|scope| {
        let halves = [0, 1].map(|half| {
            scope.spawn(move || {
                (0..cases())
                    .filter(|seed| seed % 2 == half)
                    .filter_map(judge)
                    .collect::<Vec<_>>()
            })
        });
        halves
            .into_iter()
            .flat_map(|half| half.join().expect("no panic"))
            .collect()
    })
}

fn report(failures: &[String]) {
    assert!(
        failures.is_empty(),
        "{} cases let more than {BOUND} J out:\n{}",
        failures.len(),
        failures.join("\n")
    );
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
        report(&failures(|seed| {
            let mut draw = Draw(Pcg64Mcg::seed_from_u64(seed));
            let scales = format!("position_scale = {}", draw.between(0.5, 2.0));
            draw.trial(configured(name, &scales), true, seed)
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
        report(&failures(|seed| {
            let mut draw = Draw(Pcg64Mcg::seed_from_u64(seed));
            // Twice the longest age of what is acted on: 1 s and what jitter,
            // loss and queue add.
            draw.trial(configured(law.name(), "round_trip = 2.2"), false, seed)
        }));
    }
}

#[test]
fn the_test_can_fail() {
    // Position–force makes energy on a stiff wall, and the test sees it.
    let found = failures(|seed| {
        let mut draw = Draw(Pcg64Mcg::seed_from_u64(seed));
        let law = configured("position_force", "");
        draw.trial(law, true, seed)
    });
    assert!(found.len() as u64 > cases() / 4, "{}", found.len());
}

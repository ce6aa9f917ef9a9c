//! Trials drawn from seeds, and the energy at their two ports.
//!
//! A case comes from its seed alone; a case that fails prints its seed.
//! `FERNTAST_PASSIVITY_CASES` sets how many seeds are tried, `FERNTAST_PASSIVITY_SEED` the first.

use ferntast_emulation::channel::{
    Bandwidth, Blackout, ChannelConfig, Jitter, LinkConfig, Loss, Reordering,
};
use ferntast_emulation::hand::ImpedanceParameters;
use ferntast_model::ParameterError;
use ferntast_sim::teleoperation::{Outcome, Trial};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{RngCore, SeedableRng};

/// Energy that may leave beyond what entered \[J\], at the hand's scale: the
/// kinetic energy of the arm (0.3 kg at up to 0.3 m/s, 14 mJ) and what one
/// step overdraws before it is paid back.
pub const BOUND: f64 = 0.02;
/// Draws from a seed.
pub struct Draw(Pcg64Mcg);

impl Draw {
    /// What the seed says.
    pub fn of(seed: u64) -> Draw {
        Draw(Pcg64Mcg::seed_from_u64(seed))
    }

    /// Evenly from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// True with that probability.
    pub fn chance(&mut self, probability: f64) -> bool {
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

    /// A hand that holds the handle lightly or firmly.
    pub fn hand(&mut self) -> ImpedanceParameters {
        ImpedanceParameters {
            mass: self.between(0.3, 2.0),
            damping: self.between(5.0, 50.0),
            stiffness: self.between(50.0, 1000.0),
        }
    }

    /// Both ways of a link; with outages, or of frames that nearly all come.
    pub fn link(&mut self, outages: bool) -> LinkConfig {
        LinkConfig {
            up: self.channel(outages),
            down: self.channel(outages),
            ..LinkConfig::default()
        }
    }
}

/// A whole number from the environment.
fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|text| text.parse().ok())
}

/// How many seeds are tried, `few` where nobody asks for more.
pub fn cases(few: u64) -> u64 {
    number("FERNTAST_PASSIVITY_CASES").unwrap_or(few)
}

/// Runs the trial of each of `few` seeds, or as many as are asked for, on both cores; the
/// failures, in words.
pub fn failures(few: u64, trial: impl Fn(u64) -> Trial + Sync) -> Vec<String> {
    let first = number("FERNTAST_PASSIVITY_SEED").unwrap_or(0);
    let judge = |seed: u64| -> Option<String> {
        let trial = trial(seed);
        let result: Result<Outcome, ParameterError> = trial.run();
        let outcome = result.expect("a valid trial");
        let fine = outcome.energy_margin > -BOUND && outcome.energy_margin.is_finite();
        (!fine).then(|| {
            format!(
                "seed {seed}: {:.4} J, {:?}, {}, {}, {:?}, {:?}",
                outcome.energy_margin,
                trial.law,
                trial.environment.name(),
                trial.task.name(),
                trial.hand,
                trial.link,
            )
        })
    };
    let judge = &judge;
    std::thread::scope(|scope| {
        let halves = [0, 1].map(|half| {
            scope.spawn(move || {
                (first..first + cases(few))
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

/// Fails where there are failures.
pub fn report(failures: &[String]) {
    assert!(
        failures.is_empty(),
        "{} cases let more than {BOUND} J out:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

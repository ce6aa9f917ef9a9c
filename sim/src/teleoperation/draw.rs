//! Trials drawn from a seed: channels, scales, hands, things to touch, tasks.
//!
//! The same seed and the same calls draw the same.

use super::{Environment, FollowerModel, Task, Trial};
use ferntast_control::delay::{Law, Mapping};
use ferntast_control::haptics::MasterConfig;
use ferntast_emulation::channel::{
    Bandwidth, Blackout, ChannelConfig, Jitter, LinkConfig, Loss, Reordering,
};
use ferntast_emulation::hand::ImpedanceParameters;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{RngCore, SeedableRng};

/// Draws from a seed.
#[derive(Clone, Debug)]
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

    /// `law` between scales of its own: motion at half to one and a half of the hand's, forces
    /// at 2 % of the tip's to all of them.
    pub fn scaled(&mut self, law: &Law) -> Law {
        law.between(&Mapping {
            position_scale: self.between(0.5, 1.5),
            force_scale: self.between(0.02, 1.0),
            ..law.mapping()
        })
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

impl Trial {
    /// The trial of `seed` of a law that `law` makes of a draw, over a link with outages, with
    /// `follower` and `master`.
    pub fn drawn(
        seed: u64,
        follower: FollowerModel,
        master: Option<MasterConfig>,
        law: impl FnOnce(&mut Draw) -> Law,
    ) -> Trial {
        let mut draw = Draw::of(seed);
        let law = law(&mut draw);
        let link = draw.link(true);
        let all = Environment::ALL.len() * Task::ALL.len();
        let pick = draw.between(0.0, all as f64) as usize;
        let environment = Environment::ALL[pick % Environment::ALL.len()];
        let task = Task::ALL[(pick / Environment::ALL.len()).min(Task::ALL.len() - 1)];
        let buffered = draw.chance(0.3);
        Trial {
            task,
            buffer: match buffered {
                true => draw.between(0.0, 0.15),
                false => 0.0,
            },
            hand: draw.hand(),
            follower,
            master,
            ..Trial::new(law, link, environment, seed)
        }
    }
}

//! The conditions of a sweep, one a trial.

use ferntast_control::{delay::Law, playout::LONGEST_BUFFER};
use ferntast_emulation::channel::{ChannelConfig, Jitter, LinkConfig, Loss};
use ferntast_sim::teleoperation::{Environment, Task};

use super::SweepConfig;

/// The conditions of one trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// The law.
    pub law: Law,
    /// Round trip, half of it each way \[ms\].
    pub rtt_ms: f64,
    /// Standard deviation of the delay, each way \[ms\].
    pub jitter_ms: f64,
    /// Jitter buffer of both ends \[ms\].
    pub buffer_ms: f64,
    /// Share of frames lost, each way \[-\].
    pub loss: f64,
    /// What the tip meets.
    pub environment: Environment,
    /// What the operator does.
    pub task: Task,
    /// Of all chance.
    pub seed: u64,
}

impl SweepConfig {
    /// Every condition, law by law.
    pub fn conditions(&self) -> Vec<Condition> {
        let mut all = Vec::new();
        for law in &self.laws {
            let here = |&environment| self.tasks.iter().map(move |&task| (environment, task));
            for (environment, task) in self.environments.iter().flat_map(here) {
                for &rtt_ms in &self.rtt_ms {
                    for &jitter_ms in &self.jitter_ms {
                        for &loss in &self.loss {
                            let chance = jitter_ms > 0.0 || loss > 0.0;
                            let seeds = if chance { self.seeds.len() } else { 1 };
                            all.extend(self.seeds.iter().take(seeds).map(|&seed| Condition {
                                law: law.clone(),
                                rtt_ms,
                                jitter_ms,
                                buffer_ms:
                                    (self.buffer_per_jitter * jitter_ms).min(1e3 * LONGEST_BUFFER),
                                loss,
                                environment,
                                task,
                                seed,
                            }));
                        }
                    }
                }
            }
        }
        all
    }
}

impl Condition {
    /// Stiffness of what is touched, at the hand's scale \[N/m\].
    pub fn true_stiffness(&self) -> f64 {
        let mapping = self.law.mapping();
        mapping.stiffness_at_hand(self.environment.surface().0)
    }

    /// The channel.
    pub fn link(&self) -> LinkConfig {
        let one_way = ChannelConfig {
            delay: 0.5e-3 * self.rtt_ms,
            jitter: (self.jitter_ms > 0.0).then_some(Jitter::Normal {
                deviation: 1e-3 * self.jitter_ms,
            }),
            loss: (self.loss > 0.0).then_some(Loss::Independent {
                probability: self.loss,
            }),
            ..ChannelConfig::default()
        };
        LinkConfig {
            description: String::new(),
            up: one_way.clone(),
            down: one_way,
        }
    }
}

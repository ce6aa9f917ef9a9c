//! What a channel does to frames: the files in `config/links/`.

use ferntast_model::{ParameterError, check};
use serde::{Deserialize, Serialize};

/// Both directions of a link.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkConfig {
    /// What it stands for, and where its figures come from.
    #[serde(default)]
    pub description: String,
    /// Leader to follower: motion forward.
    pub up: ChannelConfig,
    /// Follower to leader: force back.
    pub down: ChannelConfig,
}

impl LinkConfig {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, with key, value, bounds, unit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.up.validate().map_err(|error| error.within("up"))?;
        self.down.validate().map_err(|error| error.within("down"))
    }

    /// Round trip of a frame of `bytes` each way through empty queues and
    /// without jitter \[s\].
    pub fn nominal_round_trip(&self, bytes: usize) -> f64 {
        self.up.nominal_delay(bytes) + self.down.nominal_delay(bytes)
    }
}

/// One direction. What is left out does nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChannelConfig {
    /// Fixed delay, after transmission \[s\].
    pub delay: f64,
    /// What the delay varies by.
    pub jitter: Option<Jitter>,
    /// Whether jitter lets frames overtake each other; otherwise a frame waits
    /// for those before it.
    pub overtaking: bool,
    /// Which frames are lost.
    pub loss: Option<Loss>,
    /// Frames that are held back so that later ones overtake them.
    pub reordering: Option<Reordering>,
    /// Probability that a frame arrives twice \[-\].
    pub duplication: f64,
    /// How fast bits go in.
    pub bandwidth: Option<Bandwidth>,
    /// When nothing goes in.
    pub blackout: Vec<Blackout>,
}

/// Distribution of what is added to the delay of each frame, independently.
/// The whole delay is never below zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Jitter {
    /// Uniform on −half_width … +half_width.
    Uniform {
        /// \[s\]
        half_width: f64,
    },
    /// Normal with mean 0.
    Normal {
        /// Standard deviation \[s\].
        deviation: f64,
    },
    /// Exponential, adds its mean to the delay: queues of a shared network.
    Exponential {
        /// \[s\]
        mean: f64,
    },
}

/// Which frames are lost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Loss {
    /// Each frame by itself.
    Independent {
        /// \[-\]
        probability: f64,
    },
    /// In bursts: a chain of two states that takes one step a frame
    /// (Gilbert 1960, Elliott 1963). Mean loss
    /// (p h_b + r h_g)/(p + r), mean stay in the bad state 1/r frames.
    GilbertElliott {
        /// p: from good to bad, a frame \[-\].
        good_to_bad: f64,
        /// r: from bad to good, a frame \[-\].
        bad_to_good: f64,
        /// h_g: probability of loss while good \[-\].
        loss_in_good: f64,
        /// h_b: probability of loss while bad \[-\].
        loss_in_bad: f64,
    },
}

impl Loss {
    /// Share of frames lost in the long run \[-\].
    pub fn mean(&self) -> f64 {
        match *self {
            Loss::Independent { probability } => probability,
            Loss::GilbertElliott {
                good_to_bad,
                bad_to_good,
                loss_in_good,
                loss_in_bad,
            } => {
                (good_to_bad * loss_in_bad + bad_to_good * loss_in_good)
                    / (good_to_bad + bad_to_good)
            }
        }
    }
}

/// Frames that are held back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reordering {
    /// Probability that a frame is held back \[-\].
    pub probability: f64,
    /// By how much \[s\].
    pub hold_back: f64,
}

/// How fast bits go in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bandwidth {
    /// \[bit/s\]
    pub rate: f64,
    /// Bytes that may wait for transmission; what comes on top is dropped.
    pub queue: u32,
    /// Bytes that each frame costs on top of its own.
    #[serde(default)]
    pub overhead: u32,
}

/// A time in which every frame that goes in is lost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Blackout {
    /// Start after the channel's first frame \[s\].
    pub start: f64,
    /// \[s\]
    pub duration: f64,
    /// From one start to the next \[s\]; 0 for once.
    #[serde(default)]
    pub period: f64,
}

impl Blackout {
    /// Whether `time` \[s since the first frame\] is inside.
    pub fn covers(&self, time: f64) -> bool {
        let since = time - self.start;
        if since < 0.0 {
            return false;
        }
        let since = if self.period > 0.0 {
            since % self.period
        } else {
            since
        };
        since < self.duration
    }
}

/// Largest delay, jitter and hold-back \[s\].
pub(super) const LONGEST_DELAY: f64 = 5.0;

impl ChannelConfig {
    /// A channel that only delays, by `delay` \[s\].
    pub fn with_delay(delay: f64) -> Self {
        ChannelConfig {
            delay,
            ..ChannelConfig::default()
        }
    }

    /// Delay of a frame of `bytes` through an empty queue, without jitter \[s\].
    pub fn nominal_delay(&self, bytes: usize) -> f64 {
        let transmission = self.bandwidth.map_or(0.0, |bandwidth| {
            8.0 * (bytes as f64 + f64::from(bandwidth.overhead)) / bandwidth.rate
        });
        self.delay + transmission
    }

    /// Share of frames lost in the long run, blackouts and queue apart \[-\].
    pub fn mean_loss(&self) -> f64 {
        self.loss.map_or(0.0, |loss| loss.mean())
    }

    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, with key, value, bounds, unit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("delay", self.delay, 0.0, LONGEST_DELAY, "s")?;
        let (key, value) = match self.jitter {
            None => ("jitter", 0.0),
            Some(Jitter::Uniform { half_width }) => ("jitter.half_width", half_width),
            Some(Jitter::Normal { deviation }) => ("jitter.deviation", deviation),
            Some(Jitter::Exponential { mean }) => ("jitter.mean", mean),
        };
        check(key, value, 0.0, LONGEST_DELAY, "s")?;
        match self.loss {
            None => {}
            Some(Loss::Independent { probability }) => {
                check("loss.probability", probability, 0.0, 1.0, "-")?;
            }
            Some(Loss::GilbertElliott {
                good_to_bad,
                bad_to_good,
                loss_in_good,
                loss_in_bad,
            }) => {
                check("loss.good_to_bad", good_to_bad, 0.0, 1.0, "-")?;
                // Zero would be a state that is never left.
                check("loss.bad_to_good", bad_to_good, 1e-6, 1.0, "-")?;
                check("loss.loss_in_good", loss_in_good, 0.0, 1.0, "-")?;
                check("loss.loss_in_bad", loss_in_bad, 0.0, 1.0, "-")?;
            }
        }
        if let Some(own) = self.reordering {
            check("reordering.probability", own.probability, 0.0, 1.0, "-")?;
            check(
                "reordering.hold_back",
                own.hold_back,
                0.0,
                LONGEST_DELAY,
                "s",
            )?;
        }
        check("duplication", self.duplication, 0.0, 1.0, "-")?;
        if let Some(own) = self.bandwidth {
            check("bandwidth.rate", own.rate, 100.0, 1e12, "bit/s")?;
            check("bandwidth.queue", f64::from(own.queue), 64.0, 1e9, "byte")?;
            check(
                "bandwidth.overhead",
                f64::from(own.overhead),
                0.0,
                10_000.0,
                "byte",
            )?;
        }
        for (index, own) in self.blackout.iter().enumerate() {
            let key = |name: &str| format!("blackout[{index}].{name}");
            check(&key("start"), own.start, 0.0, 1e9, "s")?;
            check(&key("duration"), own.duration, 0.0, 1e9, "s")?;
            check(&key("period"), own.period, 0.0, 1e9, "s")?;
        }
        Ok(())
    }
}

//! What a channel does to frames: the files in `config/links/`.

use ferntast_model::{ParameterError, Section, check, parameters};
use serde::{Deserialize, Serialize};

parameters! {
    /// Both directions of a link.
    #[derive(Default)]
    pub struct LinkConfig {
        /// What it stands for, and where its figures come from.
        #[serde(default)]
        pub description: String,
        /// Leader to follower: motion forward.
        pub up: ChannelConfig [section],
        /// Follower to leader: force back.
        pub down: ChannelConfig [section],
    }
}

impl LinkConfig {
    /// Round trip of a frame of `bytes` each way through empty queues and
    /// without jitter \[s\].
    pub fn nominal_round_trip(&self, bytes: usize) -> f64 {
        self.up.nominal_delay(bytes) + self.down.nominal_delay(bytes)
    }
}

parameters! {
    /// One direction. What is left out does nothing.
    pub struct ChannelConfig {
        /// Fixed delay, after transmission \[s\].
        pub delay: f64 [0.0..=LONGEST_DELAY, "s"] = 0.0,
        /// What the delay varies by.
        pub jitter: Option<Jitter> [section] = None,
        /// Whether jitter lets frames overtake each other; otherwise a frame waits
        /// for those before it.
        pub overtaking: bool = false,
        /// Which frames are lost.
        pub loss: Option<Loss> [section] = None,
        /// Frames that are held back so that later ones overtake them.
        pub reordering: Option<Reordering> [section] = None,
        /// Probability that a frame arrives twice \[-\].
        pub duplication: f64 [0.0..=1.0, "-"] = 0.0,
        /// How fast bits go in.
        pub bandwidth: Option<Bandwidth> [section] = None,
        /// When nothing goes in.
        pub blackout: Vec<Blackout> [section] = Vec::new(),
    }
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

impl Section for Jitter {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        let (name, value) = match *self {
            Jitter::Uniform { half_width } => ("half_width", half_width),
            Jitter::Normal { deviation } => ("deviation", deviation),
            Jitter::Exponential { mean } => ("mean", mean),
        };
        check(&format!("{key}.{name}"), value, 0.0, LONGEST_DELAY, "s")
    }
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

impl Section for Loss {
    fn validate_at(&self, key: &str) -> Result<(), ParameterError> {
        let share = |name: &str, value: f64, least: f64| {
            check(&format!("{key}.{name}"), value, least, 1.0, "-")
        };
        match *self {
            Loss::Independent { probability } => share("probability", probability, 0.0),
            Loss::GilbertElliott {
                good_to_bad,
                bad_to_good,
                loss_in_good,
                loss_in_bad,
            } => {
                share("good_to_bad", good_to_bad, 0.0)?;
                // Zero would be a state that is never left.
                share("bad_to_good", bad_to_good, 1e-6)?;
                share("loss_in_good", loss_in_good, 0.0)?;
                share("loss_in_bad", loss_in_bad, 0.0)
            }
        }
    }
}

parameters! {
    /// Frames that are held back.
    #[derive(Copy)]
    pub struct Reordering {
        /// Probability that a frame is held back \[-\].
        pub probability: f64 [0.0..=1.0, "-"],
        /// By how much \[s\].
        pub hold_back: f64 [0.0..=LONGEST_DELAY, "s"],
    }
}

parameters! {
    /// How fast bits go in.
    #[derive(Copy)]
    pub struct Bandwidth {
        /// \[bit/s\]
        pub rate: f64 [100.0..=1e12, "bit/s"],
        /// Bytes that may wait for transmission; what comes on top is dropped.
        pub queue: u32 [64.0..=1e9, "byte"],
        /// Bytes that each frame costs on top of its own.
        #[serde(default)]
        pub overhead: u32 [0.0..=10_000.0, "byte"],
    }
}

parameters! {
    /// A time in which every frame that goes in is lost.
    #[derive(Copy)]
    pub struct Blackout {
        /// Start after the channel's first frame \[s\].
        pub start: f64 [0.0..=1e9, "s"],
        /// \[s\]
        pub duration: f64 [0.0..=1e9, "s"],
        /// From one start to the next \[s\]; 0 for once.
        #[serde(default)]
        pub period: f64 [0.0..=1e9, "s"],
    }
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
pub const LONGEST_DELAY: f64 = 5.0;

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

    /// Largest deviation of a frame's delay from the mean, or one like it: two standard
    /// deviations, the mean of what is added \[s\].
    pub fn largest_deviation(&self) -> f64 {
        match self.jitter {
            None => 0.0,
            Some(Jitter::Uniform { half_width }) => half_width,
            Some(Jitter::Normal { deviation }) => 2.0 * deviation,
            Some(Jitter::Exponential { mean }) => mean,
        }
    }

    /// Share of frames lost in the long run, blackouts and queue apart \[-\].
    pub fn mean_loss(&self) -> f64 {
        self.loss.map_or(0.0, |loss| loss.mean())
    }
}

//! What is to be different from a scenario's files.

use std::path::PathBuf;

use super::{ConfigError, HandSource, Loaded, UnknownLaw};

/// What is to be different from a scenario's files; `None` for what stays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Channel between operator and arm: a shipped one or a file.
    pub link: Option<String>,
    /// Delay law to start with.
    pub law: Option<String>,
    /// Constant round-trip time in place of the link's own \[ms\].
    pub rtt_ms: Option<f64>,
    /// Whose hand: `scripted`, `crtk`, `haply`, `leader`, or a CSV file with recorded motion.
    pub hand: Option<String>,
    /// Seed of everything that is random.
    pub seed: Option<u64>,
}

/// Why a scenario cannot be changed so.
#[derive(Debug, thiserror::Error)]
pub enum ChangeError {
    /// A file, or a value, cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// No law has that name.
    #[error(transparent)]
    Law(#[from] UnknownLaw),
}

impl Changes {
    /// Changes `loaded`, and reads what it needs then ([`Loaded::complete`]).
    ///
    /// # Errors
    ///
    /// What is wrong with it, where, and how to correct it.
    pub fn apply(&self, loaded: &mut Loaded) -> Result<(), ChangeError> {
        let scenario = &mut loaded.scenario;
        if let Some(seed) = self.seed {
            scenario.seed = seed;
        }
        if let Some(law) = &self.law {
            scenario.set_law(law)?;
        }
        match self.hand.as_deref() {
            None => {}
            Some("scripted") => scenario.hand.source = HandSource::Scripted,
            Some("crtk") => scenario.hand.source = HandSource::Crtk,
            Some("haply") => scenario.hand.source = HandSource::Haply,
            Some("leader") => scenario.hand.source = HandSource::Leader,
            Some(file) => {
                scenario.hand.source = HandSource::Recorded;
                scenario.hand.recording = Some(PathBuf::from(file));
                loaded.hand_recording = None;
            }
        }
        if let Some(link) = &self.link {
            loaded.set_link(link)?;
        }
        if let Some(rtt) = self.rtt_ms {
            loaded.set_round_trip(rtt)?;
        }
        Ok(loaded.complete()?)
    }
}

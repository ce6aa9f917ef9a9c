//! Options of studies that can be run in parts.

use std::path::PathBuf;

use ferntast_msgs::counted;
use ferntast_studies::shard::{Answers, Part, Shard, Study};

use super::Failure;

/// Which part of the work this is.
#[derive(Debug, clap::Args)]
pub struct ShardOptions {
    /// Do the I-th of N equal parts, here or on another machine, and write what was found to a file;
    /// `ferntast merge` puts the files together to what one run tells.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,

    /// The file of the part (else in this folder, named after the work, as in sweep_2_of_8.toml).
    #[arg(long, value_name = "FILE", requires = "shard")]
    part: Option<PathBuf>,
}

impl ShardOptions {
    /// Whether a part is asked for; 1/1, which is all, is one too.
    pub fn is_asked(&self) -> bool {
        self.shard.is_some()
    }

    /// Which part: all, where none is asked for.
    pub fn shard(&self) -> Shard {
        self.shard.unwrap_or(Shard::WHOLE)
    }

    /// Writes the part, where one is asked for, and gives nothing back; else gives back study
    /// and answers, which are whole.
    pub fn keep<S: Study>(
        &self,
        study: S,
        answers: Answers<S>,
        stopped: bool,
    ) -> Result<Option<(S, Answers<S>)>, Failure> {
        let told = counted(answers.len(), "answer");
        self.keep_telling(study, answers, stopped, &told)
    }

    /// The same; `told` is what the part comes to, for people.
    pub fn keep_telling<S: Study>(
        &self,
        study: S,
        answers: Answers<S>,
        stopped: bool,
        told: &str,
    ) -> Result<Option<(S, Answers<S>)>, Failure> {
        let Some(shard) = self.shard else {
            return Ok(Some((study, answers)));
        };
        if stopped {
            return Err(Failure::failed(format!(
                "stopped before part {shard} was done: no file was written; run it again"
            )));
        }
        let own = format!("{}_{}_of_{}.toml", S::KIND, shard.number(), shard.of());
        let path = self.part.clone().unwrap_or_else(|| own.into());
        let part = Part::new(study, shard, answers);
        part.write(&path).map_err(Failure::failed)?;
        eprintln!("part {shard}, {told}: {}", path.display());
        Ok(None)
    }
}

//! A study in parts, on as many machines as there are: each part says what was asked and
//! which of the questions it answers, and parts put together are the study as if it had
//! been run in one go, byte for byte.
//!
//! Whatever starts the parts (a shell, GNU parallel, Slurm, HyperQueue) only has to count.

mod merge;
mod part;

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize, de::DeserializeOwned};

pub use merge::{MergeError, kind, merge};
pub use part::{Answers, Part, PartError, Placed, values};

/// What can be run in parts: questions that come in an order, and know nothing of each other.
pub trait Study: Serialize + DeserializeOwned + PartialEq {
    /// What a part's file calls it.
    const KIND: &'static str;
    /// What is found of one question.
    type Answer: Serialize + DeserializeOwned;
}

/// Which part: `2/8` is the second of eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    number: u32,
    of: u32,
}

/// No part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no part: give I/N with 1 ≤ I ≤ N ≤ 1000000, as in 2/8, the second of eight")]
pub struct NoShard(String);

impl Shard {
    /// All of it.
    pub const WHOLE: Shard = Shard { number: 1, of: 1 };
    /// Parts of one study at most.
    const MOST: u32 = 1_000_000;

    /// Which one, from 1 on.
    pub const fn number(self) -> u32 {
        self.number
    }

    /// Of how many.
    pub const fn of(self) -> u32 {
        self.of
    }

    /// Whether the question at `place`, from 0 on, is in it: every N-th one, so that all
    /// parts take about as long.
    pub fn takes(self, place: u64) -> bool {
        place % u64::from(self.of) == u64::from(self.number - 1)
    }

    /// How many of `all` questions are in it.
    pub const fn count_of(self, all: u64) -> u64 {
        let of = self.of as u64;
        all / of + (all % of >= self.number as u64) as u64
    }

    /// Its questions out of `all`, with their places.
    pub fn part_of<T>(self, all: Vec<T>) -> Vec<(u64, T)> {
        let placed = (0_u64..).zip(all);
        placed.filter(|(place, _)| self.takes(*place)).collect()
    }
}

impl FromStr for Shard {
    type Err = NoShard;

    fn from_str(text: &str) -> Result<Shard, NoShard> {
        let read = || {
            let (number, of) = text.split_once('/')?;
            let (number, of) = (number.parse().ok()?, of.parse().ok()?);
            let is_part = 1 <= number && number <= of && of <= Shard::MOST;
            is_part.then_some(Shard { number, of })
        };
        read().ok_or_else(|| NoShard(text.to_owned()))
    }
}

impl TryFrom<String> for Shard {
    type Error = NoShard;

    fn try_from(text: String) -> Result<Shard, NoShard> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> String {
        shard.to_string()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        write!(to, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_question_is_in_one_part() {
        for of in 1..9 {
            let mut all: Vec<(u64, char)> = Vec::new();
            for shard in (1..=of).map(|number| Shard { number, of }) {
                let own = shard.part_of(('a'..='z').collect());
                assert_eq!(shard.count_of(26), own.len() as u64);
                all.extend(own);
            }
            all.sort_unstable();
            assert_eq!(all, (0..).zip('a'..='z').collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_part_is_written_as_it_is_read() {
        for text in ["1/1", "2/8", "8/8"] {
            assert_eq!(text.parse::<Shard>().unwrap().to_string(), text);
        }
        for wrong in ["", "3", "0/8", "9/8", "1/0", "a/b", "1/1000001", "-1/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}

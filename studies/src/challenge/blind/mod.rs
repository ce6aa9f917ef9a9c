//! The blind test: many recordings, each with an effect hidden, one with two,
//! or none, put to the diagnosis; and recordings like real ones.

mod ask;
mod count;
mod coverage;
mod real_like;
mod tally;
mod two;

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use ferntast_benches::{
    bench::BenchConfig,
    contact_bench,
    joint_bench::{self, RealLike},
};
use serde::{Deserialize, Serialize};

use super::TestBench;
use crate::{
    parallel,
    shard::{Placed, Shard, Study},
};

pub use ask::FollowedUp;
use ask::Given;
pub(super) use ask::true_model_reaches;
pub use count::Count;
use coverage::Held;
pub use coverage::{Coverage, Outside};
use real_like::RealCase;
pub use real_like::{RealAnswer, RealLikeRow};
pub use tally::{BlindTest, Miss};

/// What is tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Recordings of contacts; else of joints.
    pub contact: bool,
    /// Of the recordings with one effect hidden only those that hide one of these, by id;
    /// empty: all.
    pub only: Vec<String>,
    /// Seed of the first recording.
    pub seed: u64,
    /// Recordings of each effect at each strength.
    pub repeats: usize,
    /// Strengths of the hidden effects.
    pub strengths: Vec<f64>,
    /// Recordings that hide nothing.
    pub nothing: usize,
    /// Recordings that hide two effects of the catalogue at once, at full strength.
    pub two: usize,
    /// Recordings of each kind that is like real ones; of joints only.
    #[serde(default)]
    pub real_like: usize,
    /// Of those only these kinds, by id; empty: all.
    #[serde(default)]
    pub kinds: Vec<String>,
    /// Whether nothing is diagnosed: the true models are fitted, and their intervals held
    /// against the truth.
    pub intervals_only: bool,
}

#[derive(Clone, Copy)]
struct Case<H> {
    hidden: Option<H>,
    strength: f64,
    seed: u64,
}

impl<H: TestBench> Case<H> {
    fn config(&self) -> BenchConfig<H, H::Motion> {
        BenchConfig {
            seed: self.seed,
            hidden: self.hidden.into_iter().collect(),
            strength: self.strength,
            sessions: H::SESSIONS,
            ..BenchConfig::default()
        }
    }

    /// What it hides, and its seed, for an error.
    fn told(&self) -> String {
        let hidden = self.hidden.map_or("nothing", H::id);
        format!("{hidden} hidden, seed {}", self.seed)
    }
}

/// A recording, and the bench that it was made on.
struct Made<H: TestBench> {
    bench: H::Bench,
    recording: H::Recording,
}

impl<H: TestBench> Made<H> {
    fn by(config: &BenchConfig<H, H::Motion>) -> Result<Made<H>, String> {
        let bench = H::bench(config).map_err(|error| error.to_string())?;
        let recording = H::record(&bench).map_err(|error| error.to_string())?;
        Ok(Made { bench, recording })
    }
}

impl Plan {
    /// All recordings with one effect hidden, those of `only` where it names any,
    /// and those with none.
    fn cases<H: TestBench>(&self, only: &[H]) -> Vec<Case<H>> {
        let mut cases = Vec::new();
        for repeat in 0..self.repeats as u64 {
            for &hidden in H::ALL {
                for &strength in &self.strengths {
                    // Every recording has a joint of its own.
                    let seed = self.seed.wrapping_add(cases.len() as u64 + repeat);
                    let hidden = Some(hidden);
                    cases.push(Case {
                        hidden,
                        strength,
                        seed,
                    });
                }
            }
        }
        let asked = |hidden: H| only.is_empty() || only.contains(&hidden);
        cases.retain(|case: &Case<H>| case.hidden.is_some_and(asked));
        let first = self.seed.wrapping_add(1_000_000);
        cases.extend((0..self.nothing as u64).map(|index| Case {
            hidden: None,
            strength: 1.0,
            seed: first.wrapping_add(index),
        }));
        cases
    }
}

/// What came of one recording.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Answer {
    /// Of one with one effect hidden, or none.
    given: Option<Given>,
    /// Of its true model's intervals.
    #[serde(default)]
    held: Vec<Held>,
    /// Of one with two hidden: how many were named.
    of_two: Option<usize>,
    /// Of one that is like a real one.
    #[serde(default)]
    real_like: Option<RealAnswer>,
}

impl Study for Plan {
    const KIND: &'static str = "blind_test";
    type Answer = Answer;
}

/// A recording to be made.
enum Question<H> {
    /// With one effect hidden, or none.
    One(Case<H>),
    /// With two, by its seed.
    Two(u64),
    /// Like a real one.
    RealLike(RealCase),
}

impl Plan {
    /// Everything that is asked.
    ///
    /// # Errors
    ///
    /// [`Plan::only`] names an effect that the bench has not, [`Plan::kinds`] a kind that there
    /// is not.
    fn questions<H: TestBench>(&self) -> Result<Vec<Question<H>>, String> {
        let only: Result<Vec<H>, _> = self.only.iter().map(|id| id.parse()).collect();
        let cases = self.cases(&only.map_err(|error| error.to_string())?);
        let seed = |number| self.seed.wrapping_add(2_000_000 + number);
        let two = (0..self.two as u64).map(|number| Question::Two(seed(number)));
        let kinds: Result<Vec<RealLike>, _> = self.kinds.iter().map(|id| id.parse()).collect();
        let mut kinds = kinds.map_err(|error| error.to_string())?;
        if kinds.is_empty() {
            kinds = RealLike::ALL.to_vec();
        }
        let count = if self.contact { 0 } else { self.real_like };
        let real_like = real_like::cases(&kinds, count, self.seed).into_iter();
        let cases = cases.into_iter().map(Question::One).chain(two);
        Ok(cases.chain(real_like.map(Question::RealLike)).collect())
    }

    /// Puts its recordings that are in `shard` to the diagnosis, on all processors, until
    /// `stop`. `progress` is told how many of how many are done.
    ///
    /// # Errors
    ///
    /// An effect that there is not; a recording that cannot be made or diagnosed, with what
    /// it hid.
    pub fn run(
        &self,
        shard: Shard,
        stop: &AtomicBool,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Vec<Placed<Answer>>, String> {
        match self.contact {
            true => self.run_on::<contact_bench::HiddenEffect>(shard, stop, progress),
            false => self.run_on::<joint_bench::HiddenEffect>(shard, stop, progress),
        }
    }

    fn run_on<H: TestBench>(
        &self,
        shard: Shard,
        stop: &AtomicBool,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Vec<Placed<Answer>>, String> {
        let questions = shard.part_of(self.questions::<H>()?);
        let done = AtomicUsize::new(0);
        let answers = parallel::map_until(&questions, stop, |_, (place, question)| {
            let value = self.answer(question)?;
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, questions.len());
            Ok::<_, String>(Placed {
                place: *place,
                value,
            })
        })?;
        Ok(answers.into_iter().map(|(_, answer)| answer).collect())
    }

    /// What the answers come to.
    ///
    /// # Errors
    ///
    /// An effect that there is not.
    pub fn total(&self, answers: Vec<Placed<Answer>>) -> Result<BlindTest, String> {
        match self.contact {
            true => self.total_on::<contact_bench::HiddenEffect>(answers),
            false => self.total_on::<joint_bench::HiddenEffect>(answers),
        }
    }

    fn total_on<H: TestBench>(&self, answers: Vec<Placed<Answer>>) -> Result<BlindTest, String> {
        let questions = self.questions::<H>()?;
        let mut test = BlindTest::default();
        for Placed { place, value } in answers {
            test.coverage.add(&value.held);
            if let (Some(Question::One(case)), Some(given)) =
                (questions.get(place as usize), value.given)
            {
                test.note(case, given);
            }
            if let Some(own) = value.real_like {
                let row = test.real_like.entry(own.kind.clone());
                row.or_default().note(own);
            }
            if let Some(found) = value.of_two {
                test.both_of_two.note(found == 2);
                test.one_of_two.note(found >= 1);
            }
        }
        Ok(test)
    }

    fn answer<H: TestBench>(&self, question: &Question<H>) -> Result<Answer, String> {
        Ok(match question {
            Question::One(case) => {
                let made = Made::by(&case.config());
                let made = made.map_err(|error| format!("{}: {error}", case.told()))?;
                Answer {
                    given: match self.intervals_only {
                        true => None,
                        false => Some(ask::ask(case, &made)?),
                    },
                    held: coverage::held(case, &made.recording)?,
                    of_two: None,
                    real_like: None,
                }
            }
            Question::Two(seed) => Answer {
                given: None,
                held: Vec::new(),
                of_two: Some(two::two_at_once::<H>(*seed)?),
                real_like: None,
            },
            Question::RealLike(case) => Answer {
                given: None,
                held: Vec::new(),
                of_two: None,
                real_like: Some(real_like::ask(case)?),
            },
        })
    }
}

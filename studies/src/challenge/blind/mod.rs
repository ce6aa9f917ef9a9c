//! The blind test: many recordings, each with an effect hidden, one with two,
//! or none, put to the diagnosis.

mod ask;
mod coverage;
mod tally;
mod two;

use super::TestBench;
use crate::experiment::parallel;

pub(super) use ask::true_model_reaches;
pub use coverage::{Coverage, Outside};
pub use tally::{BlindTest, Count, FollowedUp, Miss};

/// What is tried.
#[derive(Clone, Debug)]
pub struct Plan {
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

/// Puts every recording of `plan` to the diagnosis, on all processors; of those
/// with one effect hidden only such as hide one of `only`, unless that is empty.
/// `progress` is told how many of how many are done.
///
/// # Errors
///
/// A recording that cannot be made or diagnosed, with what it hid.
pub fn run<H: TestBench>(
    plan: &Plan,
    only: &[H],
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<BlindTest, String> {
    let cases = plan.cases(only);
    let all = cases.len() + plan.two;
    let answers = parallel::map_telling(
        &cases,
        |_, case| {
            let given = match plan.intervals_only {
                true => None,
                false => Some(ask::ask(case)?),
            };
            Ok::<_, String>((given, coverage::held(case)?))
        },
        &|done| progress(done, all),
    )?;
    let mut test = BlindTest::default();
    for (case, (given, held)) in cases.iter().zip(answers) {
        test.coverage.add(&held);
        if let Some(given) = given {
            test.note(case, given);
        }
    }
    for index in 0..plan.two {
        let seed = plan.seed.wrapping_add(2_000_000 + index as u64);
        let found = two::two_at_once::<H>(seed)?;
        test.both_of_two.note(found == 2);
        test.one_of_two.note(found >= 1);
        progress(cases.len() + index + 1, all);
    }
    Ok(test)
}

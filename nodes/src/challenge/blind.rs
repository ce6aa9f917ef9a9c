//! The blind test: many recordings, each with an effect hidden, one with two,
//! or none, put to the diagnosis.

use std::{
    collections::BTreeMap,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use ferntast_identification::{Dataset, ModelSpec, Term, Verdict, add, diagnose};
use ferntast_sim::joint_bench::{Bench, BenchConfig, HiddenEffect};
use serde::Serialize;

use super::bench::{dataset, model};

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
}

/// A share, as found out of tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Count {
    /// How often it was so.
    pub found: usize,
    /// How often it was tried.
    pub tried: usize,
}

impl Count {
    fn note(&mut self, found: bool) {
        self.found += usize::from(found);
        self.tried += 1;
    }

    /// found over tried; 0 where nothing was tried.
    pub fn share(self) -> f64 {
        match self.tried {
            0 => 0.0,
            tried => self.found as f64 / tried as f64,
        }
    }
}

/// One recording that was not answered rightly.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Miss {
    /// What was hidden; nothing where it was nothing.
    pub hidden: Option<String>,
    /// At which strength.
    pub strength: f64,
    /// Seed of the recording.
    pub seed: u64,
    /// The verdict.
    pub verdict: Verdict,
    /// The effect that was named first.
    pub named: Option<String>,
    /// Whether the right one is in the family that was named.
    pub in_family: bool,
}

/// How the diagnosis did.
#[derive(Clone, Debug, Default, Serialize)]
pub struct BlindTest {
    /// The right effect first, by strength.
    pub right_first: BTreeMap<String, Count>,
    /// The right effect first or in the family that cannot be told apart, by strength.
    pub in_family: BTreeMap<String, Count>,
    /// Right effect first, by effect and strength.
    pub by_effect: BTreeMap<String, BTreeMap<String, Count>>,
    /// Effects outside the catalogue that were given no name, by strength.
    pub unknown_not_named: BTreeMap<String, Count>,
    /// Recordings that hide nothing in which an effect was named.
    pub false_alarms: Count,
    /// Recordings that hide two effects, of which both were named, one after the other.
    pub both_of_two: Count,
    /// The same, of which at least one was named.
    pub one_of_two: Count,
    /// Every recording that was not answered rightly.
    pub misses: Vec<Miss>,
}

#[derive(Clone, Copy)]
struct Case {
    hidden: Option<HiddenEffect>,
    strength: f64,
    seed: u64,
}

impl Plan {
    fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for repeat in 0..self.repeats as u64 {
            for &hidden in HiddenEffect::ALL {
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
        let first = self.seed.wrapping_add(1_000_000);
        cases.extend((0..self.nothing as u64).map(|index| Case {
            hidden: None,
            strength: 1.0,
            seed: first.wrapping_add(index),
        }));
        cases
    }
}

/// Puts every recording of `plan` to the diagnosis, on all processors.
/// `progress` is told how many of how many are done.
///
/// # Errors
///
/// A recording that cannot be made or diagnosed, with what it hid.
pub fn run(plan: &Plan, progress: &(dyn Fn(usize, usize) + Sync)) -> Result<BlindTest, String> {
    let cases = plan.cases();
    let next = AtomicUsize::new(0);
    let answers = Mutex::new(Vec::new());
    let workers = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let answer = ask(case);
                    let mut answers = answers.lock().unwrap_or_else(PoisonError::into_inner);
                    answers.push((*case, answer));
                    progress(answers.len(), cases.len());
                }
            });
        }
    });
    let mut answers = answers.into_inner().unwrap_or_else(PoisonError::into_inner);
    // The order in which workers ended does not matter.
    answers.sort_by_key(|(case, _)| (case.seed, case.hidden));
    let mut test = BlindTest::default();
    for (case, answer) in answers {
        test.note(&case, answer?);
    }
    for index in 0..plan.two {
        let seed = plan.seed.wrapping_add(2_000_000 + index as u64);
        let found = two_at_once(seed)?;
        test.both_of_two.note(found == 2);
        test.one_of_two.note(found >= 1);
        progress(cases.len() + index + 1, cases.len() + plan.two);
    }
    Ok(test)
}

/// Hides two effects and adds what is named until nothing more is; gives how
/// many of the two were named.
fn two_at_once(seed: u64) -> Result<usize, String> {
    let catalogue: Vec<HiddenEffect> = HiddenEffect::ALL
        .iter()
        .copied()
        .filter(|own| own.in_catalogue())
        .collect();
    let count = catalogue.len() as u64;
    // Neighbouring seeds take unrelated pairs; some pairs do not go together.
    for turn in 0..count {
        let mixed = seed.wrapping_add(turn).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let pick = |number: u64| catalogue.get((number % count) as usize).copied();
        let (Some(first), Some(second)) = (pick(mixed), pick(mixed / count)) else {
            continue;
        };
        let config = BenchConfig {
            seed,
            hidden: vec![first, second],
            ..BenchConfig::default()
        };
        let Ok(bench) = Bench::new(&config) else {
            continue;
        };
        let failed = |error: String| format!("{first} and {second} hidden, seed {seed}: {error}");
        let recording = bench.record().map_err(|error| failed(error.to_string()))?;
        let named = add_all(&dataset(&recording), model(&recording)).map_err(failed)?;
        let is_named = |effect: &HiddenEffect| {
            named
                .iter()
                .any(|name| effect.accepted().contains(&name.as_str()))
        };
        return Ok([first, second].iter().filter(|own| is_named(own)).count());
    }
    Err(format!("no two effects go together for seed {seed}"))
}

/// Diagnoses and adds as `ferntast lab auto` does; gives what was named.
fn add_all(dataset: &Dataset, mut model: ModelSpec) -> Result<Vec<String>, String> {
    const MOST: usize = 4;
    let mut named = Vec::new();
    while named.len() < MOST {
        let diagnosis =
            diagnose(dataset, &model, &mut |_| {}).map_err(|error| error.to_string())?;
        let (Verdict::Missing, Some(best)) = (diagnosis.verdict, diagnosis.candidates.first())
        else {
            break;
        };
        let term = Term::Catalogue(best.effect.clone());
        model = add(dataset, &model, &term)
            .map_err(|error| error.to_string())?
            .model;
        named.push(best.effect.clone());
    }
    Ok(named)
}

struct Given {
    verdict: Verdict,
    named: Option<String>,
    family: Vec<String>,
}

fn ask(case: &Case) -> Result<Given, String> {
    let config = BenchConfig {
        seed: case.seed,
        hidden: case.hidden.into_iter().collect(),
        strength: case.strength,
        ..BenchConfig::default()
    };
    let what = || case.hidden.map_or("nothing", HiddenEffect::id);
    let failed = |error: String| format!("{} hidden, seed {}: {error}", what(), case.seed);
    let recording = Bench::new(&config)
        .and_then(|bench| bench.record())
        .map_err(|error| failed(error.to_string()))?;
    let diagnosis = diagnose(&dataset(&recording), &model(&recording), &mut |_| {})
        .map_err(|error| failed(error.to_string()))?;
    let first = diagnosis.candidates.first();
    Ok(Given {
        verdict: diagnosis.verdict,
        named: first.map(|own| own.effect.clone()),
        family: first.map_or_else(Vec::new, |own| own.indistinguishable_from.clone()),
    })
}

impl BlindTest {
    fn note(&mut self, case: &Case, given: Given) {
        let named = given.named.filter(|_| given.verdict == Verdict::Missing);
        let strength = case.strength.to_string();
        let accepted = case.hidden.map_or(&[][..], HiddenEffect::accepted);
        let is_right = |name: &String| accepted.contains(&name.as_str());
        let first = named.as_ref().is_some_and(is_right);
        let in_family = first || (named.is_some() && given.family.iter().any(is_right));
        let right = match case.hidden {
            None => {
                self.false_alarms.note(named.is_some());
                given.verdict == Verdict::Complete
            }
            Some(hidden) if !hidden.in_catalogue() => {
                let count = self.unknown_not_named.entry(strength).or_default();
                count.note(named.is_none());
                named.is_none()
            }
            Some(hidden) => {
                let by_effect = self.by_effect.entry(hidden.id().to_owned()).or_default();
                by_effect.entry(strength.clone()).or_default().note(first);
                self.right_first
                    .entry(strength.clone())
                    .or_default()
                    .note(first);
                self.in_family.entry(strength).or_default().note(in_family);
                first
            }
        };
        if !right {
            self.misses.push(Miss {
                hidden: case.hidden.map(|hidden| hidden.id().to_owned()),
                strength: case.strength,
                seed: case.seed,
                verdict: given.verdict,
                named,
                in_family,
            });
        }
    }
}

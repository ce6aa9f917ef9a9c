//! Laws that no catalogue has, and nothing at all, put to the search for formulas.

use std::collections::BTreeMap;

use ferntast_benches::joint_bench::{Bench, BenchConfig, HiddenEffect};
use ferntast_identification::{Verdict, discover};
use serde::Serialize;

use super::{TestBench, blind::true_model_reaches};
use crate::challenge::blind::Count;
use crate::experiment::parallel;

/// Within this factor of what the true law reaches on the same recording, a formula
/// is as good.
const AS_GOOD_AS_TRUE: f64 = 1.1;
/// Seed of the search.
const SEARCH: u64 = 1;

/// What is tried.
#[derive(Clone, Debug)]
pub struct LawPlan {
    /// Seed of the first recording.
    pub seed: u64,
    /// Laws at each strength.
    pub laws: usize,
    /// Strengths of the laws.
    pub strengths: Vec<f64>,
    /// Recordings that hide nothing.
    pub nothing: usize,
}

/// What came of one recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answered {
    /// The law in words; none where nothing is hidden.
    pub law: Option<String>,
    /// At which strength.
    pub strength: f64,
    /// Seed of the recording.
    pub seed: u64,
    /// What the catalogue says.
    pub verdict: Verdict,
    /// The effect that it names.
    pub named: Option<String>,
    /// Error on data held out with that effect \[Nm\].
    pub named_after: Option<f64>,
    /// The first formula.
    pub formula: Option<String>,
    /// Error on data held out \[Nm\], without the law.
    pub before: f64,
    /// With the first formula.
    pub after: Option<f64>,
    /// With the true law.
    pub truth: f64,
    /// The p-value of the first formula.
    pub p_value: Option<f64>,
    /// Its complexity.
    pub complexity: Option<usize>,
}

impl Answered {
    /// Whether the catalogue has what is as good as the law, and no formula is better.
    #[must_use]
    pub fn is_in_catalogue(&self) -> bool {
        let is_as_good = |after: f64| after <= AS_GOOD_AS_TRUE * self.truth;
        self.formula.is_none() && self.named_after.is_some_and(is_as_good)
    }

    /// Whether the first formula is as good as the law.
    #[must_use]
    pub fn is_as_good(&self) -> bool {
        (self.after).is_some_and(|after| after <= AS_GOOD_AS_TRUE * self.truth)
    }
}

/// How the search did.
#[derive(Clone, Debug, Default, Serialize)]
pub struct DiscoveryTest {
    /// First formulas whose error on data held out is within 1.1 times the true law's,
    /// by strength.
    pub as_good_as_true: BTreeMap<String, Count>,
    /// Laws for which any formula was proposed, by strength.
    pub proposed: BTreeMap<String, Count>,
    /// Laws that an effect of the catalogue explains within 1.1 times the true law's
    /// error, and no formula better, by strength: they were not outside it.
    pub in_catalogue: BTreeMap<String, Count>,
    /// Recordings that hide nothing for which one was.
    pub false_alarms: Count,
    /// Every recording.
    pub answers: Vec<Answered>,
}

/// Puts every recording of `plan` to the search, on all processors. `progress` is told
/// how many of how many are done.
///
/// # Errors
///
/// A recording that cannot be made or searched, with its seed.
pub fn run(
    plan: &LawPlan,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<DiscoveryTest, String> {
    let mut cases: Vec<(u64, Option<f64>)> = Vec::new();
    for number in 0..plan.laws as u64 {
        for &strength in &plan.strengths {
            cases.push((
                plan.seed.wrapping_add(cases.len() as u64 + number),
                Some(strength),
            ));
        }
    }
    let first = plan.seed.wrapping_add(1_000_000);
    cases.extend((0..plan.nothing as u64).map(|number| (first.wrapping_add(number), None)));
    let mut answers = parallel::map_telling(
        &cases,
        |_, &(seed, strength)| {
            answer(seed, strength).map_err(|error| format!("seed {seed}: {error}"))
        },
        &|done| progress(done, cases.len()),
    )?;
    answers.sort_by_key(|own| own.seed);
    let mut test = DiscoveryTest::default();
    for own in answers {
        let strength = own.strength.to_string();
        match own.law {
            Some(_) => {
                let of = test.as_good_as_true.entry(strength.clone());
                of.or_default().note(own.is_as_good());
                let of = test.in_catalogue.entry(strength.clone());
                of.or_default().note(own.is_in_catalogue());
                let of = test.proposed.entry(strength);
                of.or_default().note(own.formula.is_some());
            }
            None => test.false_alarms.note(own.formula.is_some()),
        }
        test.answers.push(own);
    }
    Ok(test)
}

fn answer(seed: u64, strength: Option<f64>) -> Result<Answered, String> {
    let config = BenchConfig {
        seed,
        strength: strength.unwrap_or(1.0),
        sessions: HiddenEffect::SESSIONS,
        ..BenchConfig::default()
    };
    let drawn = match strength {
        Some(_) => Bench::with_law(&config).map(|(bench, law)| (bench, Some(law))),
        None => Bench::new(&config).map(|bench| (bench, None)),
    };
    let (bench, law) = drawn.map_err(|error| error.to_string())?;
    let recording = bench.record().map_err(|error| error.to_string())?;
    let data = HiddenEffect::dataset(&recording);
    let believed = HiddenEffect::model(&recording);
    let truth = true_model_reaches::<HiddenEffect>(&data, &believed, &recording)?;
    let found = discover(&data, &believed, SEARCH, &mut |_| {});
    let found = found.map_err(|error| error.to_string())?;
    let first = found.formulas.first();
    Ok(Answered {
        law,
        strength: config.strength,
        seed,
        verdict: found.verdict,
        named: found.named.first().map(|own| own.effect.clone()),
        named_after: found.named.first().map(|own| own.held_out_after),
        formula: first.map(|own| own.expression.clone()),
        before: found.rms.held_out,
        after: first.map(|own| own.held_out_after),
        truth,
        p_value: first.map(|own| own.p_value),
        complexity: first.map(|own| own.complexity),
    })
}

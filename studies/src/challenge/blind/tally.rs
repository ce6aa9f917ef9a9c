//! How the diagnosis did.

use std::collections::BTreeMap;

use ferntast_identification::Verdict;
use serde::Serialize;

use super::{
    super::TestBench,
    Case,
    ask::{FollowedUp, Given},
    count::Count,
    coverage::Coverage,
    real_like::Rows,
};

/// Within this factor of what the true model reaches on the same recording, an
/// error has fallen as far as it can.
const AS_GOOD_AS_TRUE: f64 = 1.05;

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
    /// Whether the right one was suspected where nothing was named.
    pub suspected: bool,
    /// After the experiment that the lab proposed.
    pub followed_up: Option<FollowedUp>,
}

/// An effect that was named rightly, whose error did not fall as far as it can.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Above {
    /// What was hidden.
    pub hidden: String,
    /// At which strength.
    pub strength: f64,
    /// Seed of the recording.
    pub seed: u64,
    /// Error on data held out over what the true model reaches on the recording.
    pub over_true: f64,
}

/// How the diagnosis did.
#[derive(Clone, Debug, Default, Serialize)]
pub struct BlindTest {
    /// The right effect first, by strength.
    pub right_first: BTreeMap<String, Count>,
    /// The right effect first or in the family that cannot be told apart, by strength.
    pub in_family: BTreeMap<String, Count>,
    /// The same, or suspected where nothing was proven, by strength.
    pub at_least_suspected: BTreeMap<String, Count>,
    /// Right effect first, by effect and strength.
    pub by_effect: BTreeMap<String, BTreeMap<String, Count>>,
    /// Effects outside the catalogue that were given no name, by strength.
    pub unknown_not_named: BTreeMap<String, Count>,
    /// Named rightly, and after adding it the error on data held out was within
    /// 5 % of what the true model reaches on the same recording, by strength.
    pub as_good_as_true: BTreeMap<String, Count>,
    /// Recordings whose family held the right effect, of which it alone was
    /// named after the experiment that the lab proposed.
    pub resolved: Count,
    /// The same of suspicions.
    pub suspicion_proven: Count,
    /// Recordings that hide nothing in which an effect was named.
    pub false_alarms: Count,
    /// Recordings that hide two effects, of which both were named, one after the other.
    pub both_of_two: Count,
    /// The same, of which at least one was named.
    pub one_of_two: Count,
    /// Recordings like real ones, by kind.
    pub real_like: Rows,
    /// How often the 95 % intervals of the true model's parameters hold the true value.
    pub coverage: Coverage,
    /// Every recording that was not answered rightly, also not after the
    /// experiment that was proposed.
    pub misses: Vec<Miss>,
    /// What was named rightly and left more than 5 % above the true model.
    pub above_true: Vec<Above>,
}

impl BlindTest {
    pub(super) fn note<H: TestBench>(&mut self, case: &Case<H>, given: Given) {
        let named = given.named.filter(|_| given.verdict == Verdict::Missing);
        let strength = case.strength.to_string();
        let accepted = case.hidden.map_or(&[][..], H::accepted);
        let is_right = |name: &String| accepted.contains(&name.as_str());
        let first = named.as_ref().is_some_and(is_right);
        let in_family = first || (named.is_some() && given.family.iter().any(is_right));
        let suspected = named.is_none() && given.suspected.iter().any(is_right);
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
                let of = |counts: &mut BTreeMap<String, Count>, found| {
                    counts.entry(strength.clone()).or_default().note(found);
                };
                of(
                    self.by_effect.entry(hidden.id().to_owned()).or_default(),
                    first,
                );
                of(&mut self.right_first, first);
                of(&mut self.in_family, in_family);
                of(&mut self.at_least_suspected, in_family || suspected);
                if let Some(over_true) = given.over_true {
                    of(&mut self.as_good_as_true, over_true <= AS_GOOD_AS_TRUE);
                    if over_true > AS_GOOD_AS_TRUE {
                        self.above_true.push(Above {
                            hidden: hidden.id().to_owned(),
                            strength: case.strength,
                            seed: case.seed,
                            over_true,
                        });
                    }
                }
                first
            }
        };
        let unresolved = given.followed_up.as_ref().is_some_and(|own| !own.resolved);
        match &given.followed_up {
            Some(own) if own.was_family => self.resolved.note(own.resolved),
            Some(own) => self.suspicion_proven.note(own.resolved),
            None => {}
        }
        if !right || unresolved {
            self.misses.push(Miss {
                hidden: case.hidden.map(|hidden| hidden.id().to_owned()),
                strength: case.strength,
                seed: case.seed,
                verdict: given.verdict,
                named,
                in_family,
                suspected,
                followed_up: given.followed_up,
            });
        }
    }
}

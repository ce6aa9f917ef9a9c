//! Every safety rule that is taken out is missed: a schedule of faults violates an
//! invariant that holds otherwise.
//!
//! Needs a build of its own, with the feature `planted_bugs`: `./tests/run` makes it.

use std::sync::{
    Mutex,
    atomic::{AtomicBool, Ordering},
};

use ferntast_control::planted::Rule;
use ferntast_nodes::session_graph;
use ferntast_studies::{
    faults::{Kits, Outcome, Plan, RunError, Schedule, load, run_many, shrink_where, violates},
    shard::Shard,
};

/// Within so many schedules a missing rule has to be found.
const SCHEDULES: u64 = 10_000;
/// The first of them. Two rules are rarely missed, a frozen sensor and the limit of pressing: here
/// they are soon, from 20 000 on they take 4476 and 5794 schedules, and the limit of pressing
/// shows in none of those before.
const FIRST: u64 = 24_400;
/// Faults that may be left of a schedule that finds it.
const FAULTS: usize = 5;

fn kits() -> Kits {
    let loaded = load("rokviss").expect("a shipped scenario");
    let graph = session_graph(ferntast_drivers::rows());
    Kits::new(&graph, &loaded, "rokviss").expect("it can be run under faults")
}

/// Whether the schedule violates the invariant, and would not with every rule in
/// force; gives when \[ms\].
fn missed_at(kits: &Kits, schedule: &Schedule, invariant: &str) -> Result<Option<i64>, RunError> {
    let found = violates(kits, schedule, invariant)?;
    let whole = Schedule {
        planted: None,
        ..schedule.clone()
    };
    Ok(match violates(kits, &whole, invariant)? {
        Some(_) => None,
        None => found,
    })
}

/// The first schedules that show that `rule` is missed, made small; how many were run.
fn search(kits: &Kits, rule: Rule) -> (Option<(String, Schedule)>, u64) {
    let over = AtomicBool::new(false);
    let found: Mutex<Option<(String, Schedule)>> = Mutex::new(None);
    let plan = Plan {
        seeds: FIRST..FIRST + SCHEDULES,
        shard: Shard::WHOLE,
        longest: None,
        threads: 2,
    };
    let done = |schedule: &Schedule, outcome: &Outcome| {
        for violation in &outcome.violations {
            let name = &*violation.invariant;
            let at = missed_at(kits, schedule, name).expect("a schedule that runs");
            if at.is_some() {
                over.store(true, Ordering::Relaxed);
                let mut found = found.lock().expect("no thread panicked");
                found.get_or_insert((name.to_owned(), schedule.clone()));
                return;
            }
        }
    };
    let change = |schedule: &mut Schedule| schedule.planted = Some(rule.name().to_owned());
    let results = run_many(kits, &plan, change, done, &over).expect("schedules that run");
    let found = found.into_inner().expect("no thread panicked");
    let small = found.map(|(name, schedule)| {
        let small = shrink_where(&schedule, |own| missed_at(kits, own, &name));
        (name, small.expect("a schedule that runs"))
    });
    (small, results.schedules)
}

#[test]
fn every_rule_that_is_taken_out_is_missed() {
    let kits = kits();
    let mut missed = Vec::new();
    let mut too_long = Vec::new();
    for rule in Rule::ALL {
        let (found, schedules) = search(&kits, *rule);
        let name = rule.name();
        let Some((invariant, small)) = found else {
            missed.push(name);
            continue;
        };
        let faults = small.event.len();
        println!("{name:22} {invariant:24} after {schedules:5} schedules, {faults} faults left");
        if faults > FAULTS {
            too_long.push(small.to_string());
        }
    }
    assert!(missed.is_empty(), "not found: {missed:?}");
    assert!(
        too_long.is_empty(),
        "more than {FAULTS} faults: {too_long:#?}"
    );
}

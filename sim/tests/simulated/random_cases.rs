//! Trials drawn from seeds, and the energy at their two ports.
//!
//! A case comes from its seed alone; a case that fails prints its seed.
//! `FERNTAST_PASSIVITY_CASES` sets how many seeds are tried, `FERNTAST_PASSIVITY_SEED` the first.

use ferntast_model::ParameterError;
use ferntast_sim::teleoperation::{Outcome, Trial};

/// Energy that may leave beyond what entered \[J\], at the hand's scale: the
/// kinetic energy of the arm (0.3 kg at up to 0.3 m/s, 14 mJ) and what one
/// step overdraws before it is paid back.
pub const BOUND: f64 = 0.02;

/// A whole number from the environment.
fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|text| text.parse().ok())
}

/// How many seeds are tried, `few` where nobody asks for more.
pub fn cases(few: u64) -> u64 {
    number("FERNTAST_PASSIVITY_CASES").unwrap_or(few)
}

/// Runs the trial of each of `few` seeds, or as many as are asked for, on both cores; the
/// failures, in words.
pub fn failures(few: u64, trial: impl Fn(u64) -> Trial + Sync) -> Vec<String> {
    let first = number("FERNTAST_PASSIVITY_SEED").unwrap_or(0);
    let judge = |seed: u64| -> Option<String> {
        let trial = trial(seed);
        let result: Result<Outcome, ParameterError> = trial.run();
        let outcome = result.expect("a valid trial");
        let fine = outcome.energy_margin > -BOUND && outcome.energy_margin.is_finite();
        (!fine).then(|| {
            format!(
                "seed {seed}: {:.4} J, {:?}, {}, {}, {:?}, {:?}",
                outcome.energy_margin,
                trial.law,
                trial.environment.name(),
                trial.task.name(),
                trial.hand,
                trial.link,
            )
        })
    };
    let judge = &judge;
    std::thread::scope(|scope| {
        let halves = [0, 1].map(|half| {
            scope.spawn(move || {
                (first..first + cases(few))
                    .filter(|seed| seed % 2 == half)
                    .filter_map(judge)
                    .collect::<Vec<_>>()
            })
        });
        halves
            .into_iter()
            .flat_map(|half| half.join().expect("no panic"))
            .collect()
    })
}

/// Fails where there are failures.
pub fn report(failures: &[String]) {
    assert!(
        failures.is_empty(),
        "{} cases let more than {BOUND} J out:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

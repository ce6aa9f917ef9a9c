//! What `ferntast challenge discover` prints.

use std::process::ExitCode;

use ferntast_studies::{
    challenge::{Answered, LawPlan},
    shard::Placed,
};

use crate::{Failure, output::print_json};

/// Tells how the search for formulas did.
pub fn tell(
    plan: &LawPlan,
    answers: Vec<Placed<Answered>>,
    json: bool,
) -> Result<ExitCode, Failure> {
    let test = plan.total(answers);
    if json {
        print_json(&test)?;
        return Ok(ExitCode::SUCCESS);
    }
    for (strength, count) in test.as_good_as_true.iter().rev() {
        let proposed = test.proposed.get(strength).copied().unwrap_or_default();
        println!(
            "strength {strength:<5} first formula within 1.1 of the true law {}/{} ({:.1} %), proposed {}/{}, in the catalogue {}",
            count.found,
            count.tried,
            count.share() * 100.0,
            proposed.found,
            proposed.tried,
            test.in_catalogue.get(strength).map_or(0, |own| own.found)
        );
    }
    let alarms = test.false_alarms;
    println!(
        "nothing hidden, yet proposed: {}/{} ({:.1} %)",
        alarms.found,
        alarms.tried,
        alarms.share() * 100.0
    );
    let missed = |own: &&Answered| match own.law {
        Some(_) => !own.is_as_good(),
        None => own.formula.is_some(),
    };
    for own in test.answers.iter().filter(missed) {
        println!(
            "  seed {:<9} strength {:<5} {:?} {}: {:.4} before, {} after, {:.4} true\n    {}\n    {}",
            own.seed,
            own.strength,
            own.verdict,
            own.named.as_deref().unwrap_or("-"),
            own.before,
            own.after
                .map_or_else(|| "-".to_owned(), |after| format!("{after:.4}")),
            own.truth,
            own.law.as_deref().unwrap_or("nothing"),
            own.formula.as_deref().unwrap_or("no formula"),
        );
    }
    Ok(ExitCode::SUCCESS)
}

//! `ferntast challenge reveal`.

use std::{path::Path, process::ExitCode};

use ferntast_studies::challenge;
use serde_json::json;

use crate::{Failure, output::print_json};

/// Refuses what is no answer, before the seal is opened.
fn check_answer(guess: &str) -> Result<(), Failure> {
    let effects = ferntast_identification::catalogue();
    let verdicts = ["complete", "none", "unexplained"];
    let is_answer = verdicts.contains(&guess) || effects.iter().any(|own| own.id == guess);
    match is_answer {
        true => Ok(()),
        false => Err(Failure::refused(format!(
            "{guess:?} is no answer, and the seal stays closed: give an effect (ferntast lab effects), \"complete\" or \"unexplained\""
        ))),
    }
}

/// Opens the sealed answer, and tells whether `guess` was right.
pub fn run(folder: &Path, guess: &str, json: bool) -> Result<ExitCode, Failure> {
    check_answer(guess)?;
    let answer = challenge::reveal(folder).map_err(Failure::refused)?;
    let outside = !answer.hidden.is_empty() && answer.accepted.is_empty();
    let right = match guess {
        "complete" | "none" => answer.hidden.is_empty(),
        "unexplained" => outside,
        effect => answer.accepted.iter().any(|own| own == effect),
    };
    if json {
        print_json(&json!({"right": right, "answer": answer}))?;
        return Ok(ExitCode::SUCCESS);
    }
    let what = match answer.hidden.as_slice() {
        [] => "nothing was hidden".to_owned(),
        hidden => format!("hidden: {}", hidden.join(", ")),
    };
    let verdict = if right { "right" } else { "no" };
    println!(
        "{verdict}: {what}, strength {}, seed {}",
        answer.strength, answer.seed
    );
    for (name, value, unit) in &answer.truth {
        println!("  {name:<28} {value:>12.5} {unit}");
    }
    Ok(ExitCode::SUCCESS)
}

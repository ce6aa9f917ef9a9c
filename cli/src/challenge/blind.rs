//! What `ferntast challenge blind` prints.

use std::{collections::BTreeMap, process::ExitCode};

use ferntast_studies::{
    challenge::{BlindAnswer, BlindTest, Count, Coverage, Plan, RealLikeRow},
    shard::Placed,
};

use crate::{Failure, output::print_json};

/// Tells how the diagnosis did.
pub fn tell(
    plan: &Plan,
    answers: Vec<Placed<BlindAnswer>>,
    json: bool,
) -> Result<ExitCode, Failure> {
    let test = plan.total(answers).map_err(Failure::refused)?;
    match (json, plan.intervals_only) {
        (true, true) => print_json(&test.coverage)?,
        (true, false) => print_json(&test)?,
        (false, true) => {
            print_coverage(&test.coverage);
            print_intervals(&test.coverage);
        }
        (false, false) => print(&test),
    }
    Ok(ExitCode::SUCCESS)
}

fn print(test: &BlindTest) {
    let strengths: Vec<&String> = test.right_first.keys().rev().collect();
    let row = |name: &str, counts: &BTreeMap<String, Count>| {
        print!("{name:<34}");
        for strength in &strengths {
            let count = counts.get(*strength).copied().unwrap_or_default();
            let tried = format!("{}/{}", count.found, count.tried);
            print!("{tried:>9} {:>5.1} %", count.share() * 100.0);
        }
        println!();
    };
    print!("{:<34}", "strength");
    for strength in &strengths {
        print!("{strength:>17}");
    }
    println!();
    row("right effect first", &test.right_first);
    row("  or in the family named", &test.in_family);
    row("  or suspected, not proven", &test.at_least_suspected);
    row("outside the catalogue: no name", &test.unknown_not_named);
    row("error within 5 % of the truth's", &test.as_good_as_true);
    let (family, suspicion) = (test.resolved, test.suspicion_proven);
    println!(
        "after the experiment proposed: {}/{} families resolved ({:.1} %), {}/{} suspicions proven",
        family.found,
        family.tried,
        family.share() * 100.0,
        suspicion.found,
        suspicion.tried
    );
    let alarms = test.false_alarms;
    println!(
        "nothing hidden, yet named: {}/{} ({:.1} %)",
        alarms.found,
        alarms.tried,
        alarms.share() * 100.0
    );
    let (both, one) = (test.both_of_two, test.one_of_two);
    println!(
        "two hidden at once, by adding what is named: both {}/{}, at least one {}/{}",
        both.found, both.tried, one.found, one.tried
    );
    print_real_like(&test.real_like);
    print_coverage(&test.coverage);
    println!();
    for (effect, counts) in &test.by_effect {
        row(effect, counts);
    }
    println!();
    println!("misses");
    for miss in &test.misses {
        let mut more = String::new();
        if miss.in_family && miss.followed_up.as_ref().is_none_or(|own| own.resolved) {
            more += " (in its family)";
        }
        if miss.suspected {
            more += " (suspected)";
        }
        if let Some(own) = &miss.followed_up {
            let after = own.named.as_deref().unwrap_or("-");
            let verdict = if own.resolved { "resolved" } else { "open" };
            more += &format!("; after {}: {after}, {verdict}", own.experiment);
        }
        println!(
            "  {:<28} strength {:<5} seed {:<9} {:?}: {}{more}",
            miss.hidden.as_deref().unwrap_or("nothing"),
            miss.strength,
            miss.seed,
            miss.verdict,
            miss.named.as_deref().unwrap_or("-"),
        );
    }
    println!();
    println!("named rightly, error above the true model's by more than 5 %");
    for own in &test.above_true {
        println!(
            "  {:<28} strength {:<5} seed {:<9} {:.1} %",
            own.hidden,
            own.strength,
            own.seed,
            (own.over_true - 1.0) * 100.0
        );
    }
}

fn print_real_like(rows: &BTreeMap<String, RealLikeRow>) {
    if rows.is_empty() {
        return;
    }
    println!(
        "\n{:<28} {:>10} {:>12} {:>12} {:>18}",
        "like real ones", "recordings", "right first", "in family", "false names"
    );
    for (kind, row) in rows {
        let of = |count: Count| format!("{}/{}", count.found, count.tried);
        println!(
            "{kind:<28} {:>10} {:>12} {:>12} {:>9} {:>6.1} %",
            row.recordings,
            of(row.right_first),
            of(row.in_family),
            of(row.false_names),
            row.false_names.share() * 100.0
        );
        for miss in &row.misses {
            let there = match miss.there.as_slice() {
                [] => "nothing".to_owned(),
                there => there.join(", "),
            };
            let alike = if miss.in_family {
                " (told as indistinguishable)"
            } else {
                ""
            };
            println!(
                "  seed {:<9} {} named where there is {there}{alike}",
                miss.seed,
                miss.named.as_deref().unwrap_or("-")
            );
        }
    }
    println!();
}

fn print_coverage(coverage: &Coverage) {
    for (what, count) in [
        ("fitted", coverage.fitted),
        ("searched", coverage.searched),
        ("of one session", coverage.one_session),
    ] {
        println!(
            "95 % intervals that hold the true value, parameters {what}: {}/{} ({:.1} %)",
            count.found,
            count.tried,
            count.share() * 100.0
        );
    }
}

fn print_intervals(coverage: &Coverage) {
    println!("\nby parameter, with mean and rms of estimate less truth in standard errors");
    for (name, own) in &coverage.by_parameter {
        let (held, tried) = (own.count.found, own.count.tried);
        let (mean, rms) = (own.mean_deviation, own.rms_deviation);
        println!("  {name:<36} {held:>4}/{tried:<4} {mean:>8.2} {rms:>8.2}");
    }
    println!("\noutside");
    for own in &coverage.outside {
        let [low, high] = own.interval_95;
        println!(
            "  {:<36} strength {:<5} seed {:<9} sessions {}: {:.5} in place of {:.5}, interval {low:.5} to {high:.5}",
            own.parameter, own.strength, own.seed, own.sessions, own.value, own.truth
        );
    }
}

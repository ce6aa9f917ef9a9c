//! `ferntast challenge`.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::atomic::{AtomicBool, Ordering},
};

use clap::Subcommand;
use ferntast_nodes::process::stop_on_signals;
use ferntast_studies::{
    challenge::{
        self, Answered, Asked, BlindAnswer, BlindTest, Count, Coverage, LawPlan, Plan, RealLikeRow,
    },
    shard::Placed,
};
use indicatif::ProgressBar;
use serde_json::json;

use super::{Failure, output::print_json, shard_options::ShardOptions};

/// Recordings with a hidden effect: to learn on, and to test the lab with.
#[derive(Debug, clap::Args)]
#[command(after_help = "Learn on one:\n  \
    ferntast challenge new recordings/riddle\n  \
    ferntast lab diagnose recordings/riddle/experiment.toml\n  \
    ferntast challenge reveal recordings/riddle stribeck\n\n\
    The same of a tip on an edge: ferntast challenge new recordings/riddle --contact")]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Make a recording with one effect hidden, and seal the answer.
    New {
        /// Folder, which must not exist yet.
        folder: PathBuf,

        /// A tip that slides along an edge instead of a joint.
        #[arg(long)]
        contact: bool,

        /// Decides joint or edge, sessions, noise, and what is hidden.
        #[arg(long, default_value_t = 1)]
        seed: u64,

        /// Size of the hidden effect: 1 is plain to see, 0.25 is hard.
        #[arg(long, default_value_t = 1.0)]
        strength: f64,

        /// Hide this effect (can be given twice), or "none", instead of what the seed says.
        #[arg(long, value_name = "EFFECT")]
        hide: Vec<String>,

        /// Sessions, each at another date and temperature [default: 6, of a contact 8].
        #[arg(long)]
        sessions: Option<usize>,
    },
    /// Open the sealed answer.
    Reveal {
        /// The challenge's folder.
        folder: PathBuf,
        /// Your answer: an effect, "complete" or "unexplained".
        answer: String,
    },
    /// Put many recordings to the diagnosis and print how it did, with the misses.
    Blind {
        /// Contacts instead of joints.
        #[arg(long)]
        contact: bool,

        /// Recordings of each effect at each strength.
        #[arg(long, default_value_t = 3)]
        repeats: usize,

        /// Strengths of the hidden effects.
        #[arg(long, value_delimiter = ',', default_values_t = [1.0, 0.5, 0.25])]
        strengths: Vec<f64>,

        /// Only the recordings that hide this effect (can be given several times),
        /// with the seeds that they have among all.
        #[arg(long, value_name = "EFFECT")]
        hide: Vec<String>,

        /// Recordings that hide nothing [default: 400; 0 with --hide].
        #[arg(long)]
        nothing: Option<usize>,

        /// Recordings that hide two effects at once [default: 40; 0 with --hide].
        #[arg(long)]
        two: Option<usize>,

        /// Recordings of each kind that is like real ones: no torque sensor but a load by a
        /// model that is off (uncertain_load), a few moves over and over (little_excitation),
        /// one_session, a drive that ends within the motion or not (limited_drive),
        /// coarse_encoder, 100 to 1000 Hz (other_rate), friction that no catalogue has
        /// (unnamed_friction); half of each hide an effect
        /// [default: 10; 0 with --hide, --contact, --intervals-only].
        #[arg(long, value_name = "COUNT")]
        real_like: Option<usize>,

        /// Only this kind of those (can be given several times).
        #[arg(long, value_name = "KIND")]
        kind: Vec<String>,

        /// Diagnose nothing: fit the true models, and print how often their 95 % intervals
        /// hold the true values, parameter by parameter.
        #[arg(long)]
        intervals_only: bool,

        /// Seed of the first recording.
        #[arg(long, default_value_t = 1)]
        seed: u64,

        #[command(flatten)]
        parts: ShardOptions,
    },
    /// Put laws that no catalogue has to `ferntast lab discover`, and print how it did.
    Discover {
        /// Laws at each strength.
        #[arg(long, default_value_t = 10)]
        laws: usize,

        /// Strengths of the laws.
        #[arg(long, value_delimiter = ',', default_values_t = [1.0, 0.5, 0.25])]
        strengths: Vec<f64>,

        /// Recordings that hide nothing.
        #[arg(long, default_value_t = 100)]
        nothing: usize,

        /// Seed of the first recording.
        #[arg(long, default_value_t = 1)]
        seed: u64,

        #[command(flatten)]
        parts: ShardOptions,
    },
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    match arguments.action {
        Action::New {
            folder,
            contact,
            seed,
            strength,
            hide,
            sessions,
        } => {
            let asked = Asked {
                seed,
                strength,
                hide,
                sessions,
            };
            let experiment = challenge::make(&folder, contact, &asked).map_err(Failure::refused)?;
            if json {
                print_json(&json!({"experiment": experiment}))?;
            } else {
                println!("ferntast lab diagnose {}", experiment.display());
            }
            Ok(ExitCode::SUCCESS)
        }
        Action::Reveal { folder, answer } => reveal(&folder, &answer, json),
        Action::Blind {
            contact,
            repeats,
            strengths,
            hide,
            nothing,
            two,
            real_like,
            kind,
            intervals_only,
            seed,
            parts,
        } => {
            let of_all = |count: usize| if hide.is_empty() { count } else { 0 };
            let plan = Plan {
                contact,
                seed,
                repeats,
                strengths,
                nothing: nothing.unwrap_or(of_all(400)),
                two: two.unwrap_or(if intervals_only { 0 } else { of_all(40) }),
                real_like: match (contact, intervals_only) {
                    (false, false) => real_like.unwrap_or(of_all(10)),
                    _ => 0,
                },
                kinds: kind,
                only: hide,
                intervals_only,
            };
            let (answers, stopped) =
                with_bar(|stop, progress| plan.run(parts.shard(), stop, progress))?;
            match parts.keep(plan, answers, stopped)? {
                Some((plan, answers)) => tell_blind(&plan, answers, json),
                None => Ok(ExitCode::SUCCESS),
            }
        }
        Action::Discover {
            laws,
            strengths,
            nothing,
            seed,
            parts,
        } => {
            let plan = LawPlan {
                seed,
                laws,
                strengths,
                nothing,
            };
            let (answers, stopped) =
                with_bar(|stop, progress| plan.run(parts.shard(), stop, progress))?;
            match parts.keep(plan, answers, stopped)? {
                Some((plan, answers)) => tell_discovered(&plan, answers, json),
                None => Ok(ExitCode::SUCCESS),
            }
        }
    }
}

/// Does long work beside a bar, until Ctrl-C; gives what was found, and whether it was
/// stopped.
fn with_bar<T>(
    work: impl FnOnce(&AtomicBool, &(dyn Fn(usize, usize) + Sync)) -> Result<T, String>,
) -> Result<(T, bool), Failure> {
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let bar = ProgressBar::new(0);
    let found = work(&stop, &|done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    let stopped = stop.load(Ordering::Relaxed);
    if stopped {
        eprintln!("stopped: what follows is of the recordings that were done");
    }
    Ok((found.map_err(Failure::refused)?, stopped))
}

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

/// Tells how the search for formulas did.
pub fn tell_discovered(
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

fn reveal(folder: &Path, guess: &str, json: bool) -> Result<ExitCode, Failure> {
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

/// Tells how the diagnosis did.
pub fn tell_blind(
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

//! `ferntast faults`.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::atomic::{AtomicU64, Ordering},
    thread,
    time::Duration,
};

use ferntast_nodes::{graph::Graph, process::stop_on_signals};
use ferntast_studies::{
    faults::{
        self, Fault, FaultStudy, Found, Kits, Outcome, Plan, Results, RunError, Schedule, Summary,
        Violation, run_many, shrink,
    },
    shard::Placed,
};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, output::print_json, shard_options::ShardOptions};

/// Schedules where nothing else is asked for.
const SCHEDULES: u64 = 2000;

/// Run a session under seeded schedules of faults, and check at every step what has to hold.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "A schedule is 2.5 s of virtual time with one to some sixteen faults, all from its seed: nodes that \
    crash or stall, clocks that are elsewhere, frames that are lost, late, damaged, forged or replayed, a second \
    master, nonsense on ROS 2, sensors that fail, words of the operator, a full disk. Both ends of the link run the \
    nodes of a session, each on a host of its own.\n\n\
    A schedule that violates an invariant is made small, and written to a file:\n  \
    ferntast faults rokviss --seeds 0..2000\n  \
    ferntast faults --replay fresh_word_17.toml      # writes the recording fresh_word_17\n\n\
    Exit code 0: everything held. 1: something did not. 2: the input was refused."
)]
pub struct Arguments {
    /// Scenario: a shipped one or a file.
    #[arg(value_name = "NAME|FILE", default_value = "rokviss")]
    scenario: String,

    /// Seeds of the schedules, the last one not included (else 0..2000).
    #[arg(long, value_name = "A..B", value_parser = parse_seeds)]
    seeds: Option<Range<u64>>,

    /// Run for so long instead, from the first seed on [minutes].
    #[arg(long, value_name = "M", value_parser = parse_minutes, allow_negative_numbers = true, conflicts_with = "shard")]
    minutes: Option<f64>,

    /// Run the schedule of this file once, tell what it violates, and record it beside the file.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seeds", "minutes", "shard"])]
    replay: Option<PathBuf>,

    /// Leave faults of this name out of every schedule (may be given again).
    #[arg(long, value_name = "FAULT", value_parser = Fault::NAMES, conflicts_with = "replay")]
    without: Vec<String>,

    /// Folder for the schedules that fail, or for the recording of a replay.
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    output: PathBuf,

    /// Take a safety rule out, to see that it is missed (control/src/planted.rs lists them).
    #[cfg(feature = "planted_bugs")]
    #[arg(long, value_name = "RULE", conflicts_with = "shard")]
    planted: Option<String>,

    #[command(flatten)]
    parts: ShardOptions,

    /// Schedules at the same time (else one a processor).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Runs it.
pub fn run(graph: &Graph, arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    match &arguments.replay {
        Some(file) => replay(graph, file, &arguments.output, json),
        None => run_seeds(graph, arguments, json),
    }
}

fn kits(graph: &Graph, scenario: &str) -> Result<Kits, Failure> {
    let loaded = faults::load(scenario).map_err(Failure::refused)?;
    Kits::new(graph, &loaded, scenario).map_err(Failure::refused)
}

fn run_seeds(graph: &Graph, arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let kits = kits(graph, &arguments.scenario)?;
    let folder = &arguments.output;
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::refused(format!("{}: {error}", folder.display())))?;
    let longest = arguments
        .minutes
        .map(|own| Duration::from_secs_f64(60.0 * own));
    let seeds = match (&arguments.seeds, longest) {
        (Some(seeds), None) => seeds.clone(),
        (Some(seeds), Some(_)) => seeds.start..u64::MAX,
        (None, None) => 0..SCHEDULES,
        (None, Some(_)) => 0..u64::MAX,
    };
    let plan = Plan {
        threads: match arguments.threads {
            Some(threads) => usize::from(threads),
            None => thread::available_parallelism().map_or(1, usize::from),
        },
        seeds: seeds.clone(),
        shard: arguments.parts.shard(),
        longest,
    };
    let study = FaultStudy {
        scenario: arguments.scenario.clone(),
        seeds,
        without: arguments.without.clone(),
    };
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let bar = progress(&plan);
    let violated = AtomicU64::new(0);
    let done = |_: &Schedule, outcome: &Outcome| {
        bar.inc(1);
        if !outcome.violations.is_empty() {
            let count = 1 + violated.fetch_add(1, Ordering::Relaxed);
            bar.set_message(format!(", {count} violate something"));
        }
    };
    let change = |schedule: &mut Schedule| {
        #[cfg(feature = "planted_bugs")]
        schedule.planted.clone_from(&arguments.planted);
        study.change(schedule);
    };
    let results = run_many(&kits, &plan, change, done, &stop).map_err(Failure::failed)?;
    bar.finish_and_clear();
    if !arguments.parts.is_asked() {
        return tell_results(&kits, &results, folder, json);
    }
    let schedules = results.schedules;
    let answers = study.answers(results);
    let told = format!(
        "{schedules} schedules, of which {} violate something",
        answers.len()
    );
    let stopped = stop.load(Ordering::Relaxed);
    let parts = &arguments.parts;
    parts.keep_telling(study, answers, stopped, &told)?;
    Ok(ExitCode::SUCCESS)
}

/// Tells what the schedules of all parts come to.
pub fn tell_merged(
    graph: &Graph,
    study: &FaultStudy,
    answers: Vec<Placed<Vec<Violation>>>,
    output: Option<&Path>,
    json: bool,
) -> Result<ExitCode, Failure> {
    let kits = kits(graph, &study.scenario)?;
    let results = study.total(&kits, answers);
    tell_results(&kits, &results, output.unwrap_or(Path::new(".")), json)
}

fn tell_results(
    kits: &Kits,
    results: &Results,
    folder: &Path,
    json: bool,
) -> Result<ExitCode, Failure> {
    let found = make_small(kits, results, folder)?;
    let summary = Summary::new(results, found);
    if json {
        print_json(&summary)?;
    } else {
        let took = match (results.took, summary.schedules_per_minute) {
            (Some(took), Some(rate)) => {
                format!(" in {:.1} s, {rate:.0} a minute", took.as_secs_f64())
            }
            _ => String::new(),
        };
        println!(
            "{} schedules{took}; {} invariants, {} violated",
            summary.schedules,
            summary.invariants.len(),
            summary.violations.len()
        );
    }
    for own in &summary.violations {
        tell(own);
    }
    Ok(match summary.violations.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    })
}

fn progress(plan: &Plan) -> ProgressBar {
    let (bar, template) = match plan.longest {
        None => (
            ProgressBar::new(
                plan.shard
                    .count_of(plan.seeds.end.saturating_sub(plan.seeds.start)),
            ),
            "{bar:30} {pos}/{len} schedules, {eta} left{msg}",
        ),
        Some(_) => (
            ProgressBar::new_spinner(),
            "{spinner} {pos} schedules in {elapsed}{msg}",
        ),
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// Makes the first schedule of each violation small, and writes it to a file.
fn make_small(kits: &Kits, results: &Results, folder: &Path) -> Result<Vec<Found>, Failure> {
    let mut found = Vec::new();
    for (invariant, (schedule, violation, count)) in &results.violations {
        let small = shrink(kits, schedule, invariant).map_err(Failure::failed)?;
        let again = kits
            .run(&small, faults::Look::default())
            .map_err(Failure::failed)?;
        let own = again
            .violations
            .iter()
            .find(|own| own.invariant == *invariant);
        let mut own = Found::new(small, own.unwrap_or(violation), *count);
        let file = folder.join(format!("{invariant}_{}.toml", own.seed));
        own.schedule.write(&file).map_err(Failure::failed)?;
        own.file = Some(file);
        found.push(own);
    }
    Ok(found)
}

fn tell(found: &Found) {
    eprintln!(
        "\n{} is violated in {} schedules; seed {}, at {} ms: {}\n{}",
        found.invariant, found.schedules, found.seed, found.at_ms, found.told, found.schedule
    );
    if let Some(file) = &found.file {
        eprintln!("  again: ferntast faults --replay {}", file.display());
    }
}

fn replay(graph: &Graph, file: &Path, folder: &Path, json: bool) -> Result<ExitCode, Failure> {
    let schedule = Schedule::read(file).map_err(Failure::refused)?;
    let kits = kits(graph, &schedule.scenario)?;
    let name = file.file_stem().unwrap_or_default();
    let recording = folder.join(name);
    if recording.exists() {
        return Err(Failure::refused(format!(
            "{}: the recording is there already; move it away, or choose another folder with -o",
            recording.display()
        )));
    }
    let outcome = faults::replay(&kits, &schedule, &recording).map_err(of_run)?;
    let violations: Vec<Found> = outcome
        .violations
        .iter()
        .map(|own| Found {
            file: Some(file.to_owned()),
            ..Found::new(schedule.clone(), own, 1)
        })
        .collect();
    if json {
        print_json(&serde_json::json!({ "recording": recording, "violations": violations }))?;
    } else {
        println!("{schedule}");
        for own in &violations {
            println!("{} at {} ms: {}", own.invariant, own.at_ms, own.told);
        }
        if violations.is_empty() {
            println!("everything held");
        }
        println!("recording: {}", recording.display());
    }
    Ok(match violations.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    })
}

fn parse_seeds(text: &str) -> Result<Range<u64>, String> {
    let seeds = text
        .split_once("..")
        .and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    match seeds {
        Some(seeds) if !seeds.is_empty() => Ok(seeds),
        _ => Err("give A..B with A less than B, as in 0..2000".to_owned()),
    }
}

/// What cannot be run is refused; what breaks on the way has failed.
fn of_run(error: RunError) -> Failure {
    match error {
        RunError::Law { .. } | RunError::Planted { .. } => Failure::refused(error),
        RunError::World(_) => Failure::failed(error),
    }
}

fn parse_minutes(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(minutes) if (1e-3..=1e5).contains(&minutes) => Ok(minutes),
        _ => Err("give a number of minutes, 0.001 to 100000".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_a_range_that_is_not_empty() {
        assert_eq!(parse_seeds("3..7"), Ok(3..7));
        for bad in ["", "3", "7..3", "3..3", "a..b", "-1..3"] {
            assert!(parse_seeds(bad).is_err(), "{bad}");
        }
    }
}

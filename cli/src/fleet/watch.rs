//! `ferntast fleet watch`.

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use ferntast_fleet::{DaySummary, Fleet, ageing::WatchSettings, days, read};

use super::{
    super::{Failure, output::print_json, scenario_options::domains},
    live, terminal,
};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Siblings are the joints of the same name on all robots, each parameter of their twins by itself. A robot has a level, \
    a slope with temperature, and an ageing of its own; how far robots differ in these is estimated from the fleet. Named is \
    what goes farther, more every day: from the sixth day on, of three robots or more, where it is as sure as --false-alarms asks \
    and more than --least-change. A step is told where it is more than --least-step: smaller ones another load makes.\n\n\
    A journal has a line for each day and joint:\n  \
    {\"day\": \"2026-11-25\", \"robot\": \"left\", \"joint\": \"joint_2\", \"temperature_degC\": 12.1,\n   \
    \"parameters\": {\"b0\": {\"value\": 12.3, \"std_error\": 0.1}}}\n\n\
    Live, days end at midnight UTC; Ctrl-C writes what the day has so far into the journal, and the next start goes on with it. \
    With --json, live, one JSON object a line: event heard, day or named; of a journal one object."
)]
pub struct Arguments {
    /// Journals of days, or folders of them (.jsonl); without --router and --listen only they are looked at.
    #[arg(value_name = "FILE|DIR")]
    journals: Vec<PathBuf>,

    /// Zenoh router of a session, or one that knows several (may be given again).
    #[arg(long, value_name = "tcp/HOST:PORT")]
    router: Vec<String>,

    /// Be the router that the sessions' routers connect to (connect/endpoints in their --router-config).
    #[arg(long, value_name = "tcp/HOST:PORT")]
    listen: Option<String>,

    /// ROS domain of the sessions (else ROS_DOMAIN_ID, else 0).
    #[arg(long, value_name = "ID", value_parser = domains())]
    domain: Option<u32>,

    /// Write what is heard there, a line a day and joint; what it has already counts.
    #[arg(long, value_name = "FILE.jsonl")]
    journal: Option<PathBuf>,

    /// False alarms of the whole fleet that are tolerated in a year.
    #[arg(long, value_name = "NUMBER", default_value_t = 1.0)]
    false_alarms: f64,

    /// Least change that is named, as a share of what the siblings have.
    #[arg(long, value_name = "SHARE", default_value_t = WatchSettings::default().least_change)]
    least_change: f64,

    /// Least step that is named, as such a share.
    #[arg(long, value_name = "SHARE", default_value_t = WatchSettings::default().least_step)]
    least_step: f64,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let settings = settings(arguments)?;
    let hears = !arguments.router.is_empty() || arguments.listen.is_some();
    if arguments.journals.is_empty() && !hears {
        return Err(Failure::refused(
            "nothing to watch: name journals (FILE or DIR), or where sessions are heard: --router tcp/HOST:PORT or \
             --listen tcp/HOST:PORT",
        ));
    }
    let mut known: Vec<DaySummary> = Vec::new();
    for path in &arguments.journals {
        for file in files(path)? {
            known.extend(read_file(&file)?);
        }
    }
    if !hears {
        let mut fleet = Fleet::new(settings);
        fleet.days(&days(&known)).map_err(Failure::refused)?;
        let told = fleet.told(terminal::STANDING);
        match json {
            true => print_json(&told)?,
            false => terminal::tell(&told),
        }
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(journal) = arguments.journal.as_ref().filter(|own| own.exists()) {
        known.extend(read_file(journal)?);
    }
    let live = live::Live {
        routers: &arguments.router,
        listen: arguments.listen.as_deref(),
        domain: arguments.domain,
        journal: arguments.journal.as_deref(),
        settings,
    };
    live.run(known, json)
}

fn settings(arguments: &Arguments) -> Result<WatchSettings, Failure> {
    let share = |name: &str, value: f64| match (0.0..=10.0).contains(&value) {
        true => Ok(value),
        false => Err(Failure::refused(format!(
            "--{name} {value}: give a share of 0 to 10"
        ))),
    };
    if !(1e-6..=1e3).contains(&arguments.false_alarms) {
        return Err(Failure::refused(format!(
            "--false-alarms {}: give a number a year, of 1e-6 to 1000",
            arguments.false_alarms
        )));
    }
    Ok(WatchSettings {
        false_alarms: arguments.false_alarms,
        least_change: share("least-change", arguments.least_change)?,
        least_step: share("least-step", arguments.least_step)?,
    })
}

/// `path`, or the journals in it.
fn files(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let bad = |error: std::io::Error| Failure::refused(format!("{}: {error}", path.display()));
    let entries = fs::read_dir(path).map_err(bad)?;
    let entries = entries.collect::<Result<Vec<_>, _>>().map_err(bad)?;
    let journals = entries.into_iter().map(|own| own.path());
    let journals = journals.filter(|own| own.extension().is_some_and(|ending| ending == "jsonl"));
    let mut found: Vec<PathBuf> = journals.collect();
    found.sort();
    match found.is_empty() {
        true => Err(Failure::refused(format!(
            "{}: no .jsonl in it; `ferntast fleet day RECORDING --robot NAME` prints the lines of one",
            path.display()
        ))),
        false => Ok(found),
    }
}

fn read_file(path: &Path) -> Result<Vec<DaySummary>, Failure> {
    let bad =
        |error: &dyn std::fmt::Display| Failure::refused(format!("{}: {error}", path.display()));
    let text = fs::read_to_string(path).map_err(|error| bad(&error))?;
    read(&text).map_err(|error| bad(&error))
}

//! `ferntast lockstep`.

use std::{path::PathBuf, process::ExitCode, sync::atomic::Ordering};

use ferntast_nodes::{
    graph::Graph,
    process::{SessionContext, stop_on_signals},
};
use ferntast_studies::lockstep::{self, LockstepOutcome, LockstepPlan};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, output::print_json, scenario_options::ScenarioOptions};

/// Run a scenario in one process and virtual time.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "The same seed gives the same recording, byte for byte:\n  \
    ferntast lockstep config/scenarios/rokviss.toml --record recordings/a\n  \
    ferntast replay recordings/a"
)]
pub struct Arguments {
    /// Scenario: a shipped one or a file.
    #[arg(value_name = "NAME|FILE", conflicts_with = "scenario")]
    file: Option<String>,

    #[command(flatten)]
    scenario: ScenarioOptions,

    /// Virtual time to run (else that of the scenario) [s].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    duration: Option<f64>,

    /// Switch the delay law so many seconds after the start (may be given again).
    #[arg(long = "switch", value_name = "SECONDS=LAW")]
    switches: Vec<String>,

    /// Hold the model of this experiment of the lab against a joint while it moves; topics /twin/*.
    /// Give it again for another joint.
    #[arg(long, value_name = "EXPERIMENT.toml")]
    twin: Vec<PathBuf>,

    /// Have the servo take over the friction that the twin found, so many seconds after the start.
    #[arg(long, value_name = "SECONDS", requires = "twin")]
    take_over: Option<f64>,

    /// Have it feed the configured friction forward again, so many seconds after the start.
    #[arg(long, value_name = "SECONDS", requires = "twin")]
    give_back: Option<f64>,

    /// Record into this folder (a rosbag2 directory; must not exist yet).
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,
}

/// Runs it.
pub fn run(graph: &Graph, mut arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    if let Some(file) = arguments.file.take() {
        arguments.scenario.scenario = file;
    }
    let driver = arguments.scenario.driver();
    let mut context = SessionContext::in_virtual_time(arguments.scenario.load()?);
    context.driver = driver;
    context.twins = arguments.twin;
    context.bag = arguments.record;
    let switches: Result<Vec<_>, Failure> = arguments
        .switches
        .iter()
        .map(|text| parse_switch(text))
        .collect();
    let plan = LockstepPlan {
        duration: arguments.duration,
        switches: switches?,
        take_over: arguments.take_over,
        give_back: arguments.give_back,
    };
    let duration = plan.duration_in(&context).map_err(Failure::refused)?;
    let bar = ProgressBar::new(duration.ceil() as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:30} {pos}/{len} s of virtual time, {eta} left")
    {
        bar.set_style(style);
    }
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let mut done = |passed: f64| {
        bar.set_position(passed as u64);
        !stop.load(Ordering::Relaxed)
    };
    let outcome = lockstep::run(graph, &context, &plan, &mut done).map_err(Failure::refused)?;
    bar.finish_and_clear();
    match json {
        true => print_json(&outcome)?,
        false => tell(&outcome),
    }
    if let Some(fault) = outcome.recording_fault {
        return Err(Failure::failed(fault));
    }
    if outcome.duration_s < duration {
        let whole = match outcome.recording.is_some() {
            true => ", the recording is whole up to there",
            false => "",
        };
        let done = outcome.duration_s;
        return Err(Failure::failed(format!(
            "stopped after {done} s of {duration} s{whole}"
        )));
    }
    Ok(ExitCode::SUCCESS)
}

fn tell(outcome: &LockstepOutcome) {
    println!(
        "{} s of {} in {:.3} s: {:.0} times real time",
        outcome.duration_s, outcome.scenario, outcome.wall_s, outcome.real_time_factor
    );
    println!(
        "contact {}; hand at most {:.1} N; round trip {:.3} ms",
        outcome.contact,
        outcome.leader.peak_force,
        outcome.link.rtt_ms.unwrap_or(f64::NAN)
    );
    if !outcome.twins.is_empty() {
        outcome.twins.iter().for_each(|own| println!("{own}"));
        outcome.friction.iter().for_each(|own| println!("{own}"));
    }
}

/// Time \[s\] and law of `SECONDS=LAW`.
fn parse_switch(text: &str) -> Result<(f64, String), Failure> {
    let parts = text.split_once('=');
    let parsed = parts.and_then(|(seconds, law)| Some((seconds.parse().ok()?, law.to_owned())));
    parsed
        .ok_or_else(|| Failure::refused(format!("--switch {text}: give SECONDS=LAW, as in 5=wave")))
}

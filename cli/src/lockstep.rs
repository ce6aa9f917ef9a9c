//! `ferntast lockstep`.

use std::{path::PathBuf, process::ExitCode, sync::atomic::Ordering, time::Instant};

use ferntast_control::delay::Law;
use ferntast_msgs::sample::FrictionCommand;
use ferntast_nodes::{
    config::{HandSource, UnknownLaw},
    graph::Graph,
    lockstep::LockstepSession,
    process::{SessionContext, stop_on_signals},
    servo::FrictionSummary,
    session::{ArmSummary, ContactSummary, LeaderSummary, LinkSummary, StateSummary, TipSummary},
    twin::TwinSummary,
};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

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

#[derive(Debug, Serialize)]
struct Result {
    scenario: String,
    seed: u64,
    duration_s: f64,
    wall_s: f64,
    real_time_factor: f64,
    #[serde(flatten)]
    arm: ArmSummary,
    link: LinkSummary,
    contact: ContactSummary,
    tip: TipSummary,
    #[serde(rename = "felt_stiffness_N_per_m")]
    felt_stiffness: Option<f64>,
    leader: LeaderSummary,
    twins: Vec<TwinSummary>,
    friction: Vec<FrictionSummary>,
    states: std::collections::BTreeMap<String, StateSummary>,
    recording: Option<String>,
    /// Why the recording is not whole; `null` where it is, or without one.
    recording_fault: Option<String>,
}

/// Runs it.
pub fn run(
    graph: &Graph,
    mut arguments: Arguments,
    json: bool,
) -> std::result::Result<ExitCode, Failure> {
    if let Some(file) = arguments.file.take() {
        arguments.scenario.scenario = file;
    }
    let driver = arguments.scenario.driver();
    let loaded = arguments.scenario.load()?;
    if loaded.scenario.hand.source == HandSource::Crtk {
        return Err(Failure::refused(
            "lockstep has no hand on ROS 2 in its virtual time: give --hand scripted or --hand FILE.csv, or run \
             ferntast session --hand crtk",
        ));
    }
    let duration = arguments.duration.unwrap_or(loaded.scenario.duration);
    if !(duration.is_finite() && duration > 0.0) {
        return Err(Failure::refused(format!(
            "--duration {duration}: give a positive number of seconds"
        )));
    }
    let mut context = SessionContext::in_virtual_time(loaded);
    context.driver = driver;
    context.twins = arguments.twin;
    context.bag = arguments.record;
    let mut session = LockstepSession::new(graph, &context).map_err(Failure::refused)?;
    for text in &arguments.switches {
        let (seconds, law) = parse_switch(text)?;
        session
            .switch_law_at(seconds, law)
            .map_err(Failure::refused)?;
    }
    for (flag, seconds, command) in [
        (
            "--take-over",
            arguments.take_over,
            FrictionCommand::TAKE_OVER,
        ),
        (
            "--give-back",
            arguments.give_back,
            FrictionCommand::GIVE_BACK,
        ),
    ] {
        let Some(seconds) = seconds else {
            continue;
        };
        if !(seconds.is_finite() && seconds >= 0.0) {
            return Err(Failure::refused(format!(
                "{flag} {seconds}: give a number of seconds after the start"
            )));
        }
        session
            .command_friction_at(seconds, command)
            .map_err(Failure::refused)?;
    }
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let bar = ProgressBar::new(duration.ceil() as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:30} {pos}/{len} s of virtual time, {eta} left")
    {
        bar.set_style(style);
    }
    let begun = Instant::now();
    let mut done = 0.0;
    while done < duration && !stop.load(Ordering::Relaxed) {
        let slice = (duration - done).min(1.0);
        session.run(slice);
        done += slice;
        bar.set_position(done as u64);
    }
    let wall = begun.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let monitor = session.monitor();
    let mut result = Result {
        scenario: context.loaded.scenario.name.clone(),
        seed: context.loaded.scenario.seed,
        duration_s: done,
        wall_s: wall,
        real_time_factor: done / wall,
        arm: ArmSummary::of(&context),
        link: monitor.link(),
        contact: monitor.contact(),
        tip: monitor.tip(),
        felt_stiffness: monitor.felt_stiffness(),
        leader: monitor.leader(),
        twins: monitor.twins(),
        friction: monitor.friction(),
        states: monitor.states(),
        recording: context.bag.as_ref().map(|path| path.display().to_string()),
        recording_fault: None,
    };
    let recorded = session.finish();
    result.recording_fault = recorded.as_ref().err().map(ToString::to_string);
    if json {
        print_json(&result)?;
    } else {
        println!(
            "{done} s of {} in {:.3} s: {:.0} times real time",
            result.scenario, wall, result.real_time_factor
        );
        println!(
            "contact {:.1} s, peak normal force {:.1} N; hand at most {:.1} N; round trip {:.3} ms",
            result.contact.time_s,
            result.contact.peak_normal_force,
            result.leader.peak_force,
            result.link.rtt_ms.unwrap_or(f64::NAN)
        );
        if !result.twins.is_empty() {
            result.twins.iter().for_each(|own| println!("{own}"));
            result.friction.iter().for_each(|own| println!("{own}"));
        }
    }
    recorded.map_err(Failure::failed)?;
    if done < duration {
        let whole = if result.recording.is_some() {
            ", the recording is whole up to there"
        } else {
            ""
        };
        return Err(Failure::failed(format!(
            "stopped after {done} s of {duration} s{whole}"
        )));
    }
    Ok(ExitCode::SUCCESS)
}

/// Time \[s\] and law of `SECONDS=LAW`.
fn parse_switch(text: &str) -> std::result::Result<(f64, &str), Failure> {
    let parts = text.split_once('=');
    let parsed = parts.and_then(|(seconds, law)| Some((seconds.parse::<f64>().ok()?, law)));
    match parsed {
        Some((seconds, law)) if seconds.is_finite() && seconds >= 0.0 => {
            match Law::NAMES.contains(&law) {
                true => Ok((seconds, law)),
                false => Err(Failure::refused(UnknownLaw::new(law))),
            }
        }
        _ => Err(Failure::refused(format!(
            "--switch {text}: give SECONDS=LAW, as in 5=wave"
        ))),
    }
}

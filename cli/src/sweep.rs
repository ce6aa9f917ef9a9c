//! `ferntast sweep`.

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use ferntast_control::codec::Codec;
use ferntast_nodes::process::stop_on_signals;
use ferntast_studies::{
    shard::{Placed, values},
    sweep::{
        self, Case, RandomCases, RandomSweep, Row, SweepConfig,
        arms::{self, ArmsError, arms_table},
    },
};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, output::print_json, scenario_options::Driver, shard_options::ShardOptions};

/// The law of arms where none is asked for: the one that gives out next to no energy.
const ARMS_LAW: &str = "two_layer";

/// Hold the delay laws against each other over delay, jitter, loss and environment.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Every trial is an operator at a task (presses and slides, taps, lets go, roams and presses) on the simulated\n\
    arm with the servo, the estimator and the limits of the hand's force that a session has, in virtual time, on every processor.\n\
    With -o DIR: DIR/sweep.json (every trial) and DIR/sweep.html (stability maps and curves).\n\n\
    With --random N: N cases of each law in which scales, both channels (delay to 1 s, jitter, loss, reordering, copies,\n\
    bandwidth, outages), hand, surface and task are drawn from the case's seed; a line a law with the energy that was made\n\
    at hand and tip, by the simulated bodies. Ctrl-C ends it and tells what is done. Case S+k is the same in any run:\n  \
    ferntast sweep --random 10000 --law two_layer          # in one go\n  \
    ferntast sweep --random 1000 --seed 3000 --json        # a slice\n\n\
    With --arms A,B: each arm out of a URDF on walls of 0.2, 2 and 20 kN/m, over 600 ms round trip with 50 ms jitter and\n\
    10 % loss beside none, a minute a wall, with the law two_layer where --law gives no other: energy made at hand and tip\n\
    (0.02 J at most), drift (1 mm), peak force (1.5 times that without delay), stiffness felt (within 25 % of that), task:\n  \
    ferntast sweep --arms panda,ur5,xarm7\n  \
    ferntast sweep --arms panda --driver 'process:python3 tests/python/peers/mujoco_plant.py' --json\n\n\
    Exit code 1: a law that claims to be passive makes more than 0.02 J; an arm that misses a bound."
)]
pub struct Arguments {
    /// What is swept over: the shipped delay_sweep or a file.
    #[arg(value_name = "NAME|FILE", default_value = "delay_sweep")]
    file: String,

    /// Write sweep.json and sweep.html into this folder.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Only these laws of the sweep (may be given again).
    #[arg(long, value_name = "NAME")]
    law: Vec<String>,

    /// So many cases of each law, drawn at random, in place of the file's conditions.
    #[arg(long, value_name = "N", conflicts_with = "output", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    random: Option<u64>,

    /// Seed of the first case, with --random.
    #[arg(long, value_name = "S", default_value_t = 0, requires = "random")]
    seed: u64,

    /// Hold these arms against each other, ones that come along or files.
    #[arg(long, value_name = "ARM,…", value_delimiter = ',', conflicts_with_all = ["output", "random", "shard"])]
    arms: Vec<String>,

    /// What moves in place of the arms: the simulated ones, or a program of yours, stepped over a pipe (process:COMMAND).
    #[arg(
        long,
        value_name = "DRIVER",
        default_value = "simulated",
        requires = "arms"
    )]
    driver: Driver,

    /// Which frames the link carries: all of them, or with deadband those that say something new.
    #[arg(long, value_name = "none|deadband", value_parser = Codec::NAMES)]
    codec: Option<String>,

    #[command(flatten)]
    parts: ShardOptions,
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let mut config = SweepConfig::load(&arguments.file).map_err(Failure::refused)?;
    config.only(&arguments.law).map_err(Failure::refused)?;
    if let Some(codec) = arguments.codec.as_deref().and_then(Codec::by_name) {
        config.codec = codec;
    }
    let stop = stop_on_signals().map_err(Failure::failed)?;
    if let Some(cases) = arguments.random {
        let study = RandomSweep {
            seed: arguments.seed,
            cases,
            sweep: config,
        };
        return run_random(study, &arguments.parts, &stop, json);
    }
    if !arguments.arms.is_empty() {
        if arguments.law.is_empty() {
            config
                .only(&[ARMS_LAW.to_owned()])
                .map_err(Failure::refused)?;
        }
        return run_arms(&config, &arguments.arms, &arguments.driver.0, &stop, json);
    }
    if let Some(folder) = &arguments.output {
        // Before the work, so that it is not done in vain.
        make(folder)?;
    }
    let shard = arguments.parts.shard();
    let trials = shard.part_of(config.conditions()).len();
    let bar = progress(trials as u64);
    let begun = Instant::now();
    let rows = sweep::run(&config, shard, &stop, || bar.inc(1)).map_err(Failure::refused)?;
    bar.finish_and_clear();
    let (done, took) = (rows.len(), begun.elapsed().as_secs_f64());
    eprintln!("{done} trials in {took:.1} s");
    let stopped = done < trials;
    if stopped {
        eprintln!("stopped: {} of {trials} trials were not run", trials - done);
    }
    match arguments.parts.keep(config, rows, stopped)? {
        Some((config, rows)) => tell(&config, rows, arguments.output.as_deref(), json),
        None => Ok(ExitCode::SUCCESS),
    }
}

/// Tells what a sweep found.
pub fn tell(
    config: &SweepConfig,
    rows: Vec<Placed<Row>>,
    output: Option<&Path>,
    json: bool,
) -> Result<ExitCode, Failure> {
    let rows = values(rows);
    if let Some(folder) = output {
        make(folder)?;
        let page = sweep::render(config, &rows).map_err(Failure::failed)?;
        write(&folder.join("sweep.html"), page.as_bytes())?;
        write_rows(&folder.join("sweep.json"), &rows)?;
        eprintln!("{}", folder.join("sweep.html").display());
    }
    if json {
        print_json(&rows)?;
    } else {
        println!("{}", sweep::table(&rows));
    }
    Ok(ExitCode::SUCCESS)
}

fn run_random(
    study: RandomSweep,
    parts: &ShardOptions,
    stop: &AtomicBool,
    json: bool,
) -> Result<ExitCode, Failure> {
    let bar = progress(parts.shard().count_of(study.count()));
    let begun = Instant::now();
    let cases = study
        .run(parts.shard(), stop, || bar.inc(1))
        .map_err(Failure::refused)?;
    bar.finish_and_clear();
    let took = begun.elapsed().as_secs_f64();
    eprintln!("{} cases in {took:.1} s", cases.len());
    match parts.keep(study, cases, stop.load(Ordering::Relaxed))? {
        Some((study, cases)) => tell_random(&study, &cases, json),
        None => Ok(ExitCode::SUCCESS),
    }
}

/// Tells what cases drawn at random come to.
pub fn tell_random(
    study: &RandomSweep,
    cases: &[Placed<Case>],
    json: bool,
) -> Result<ExitCode, Failure> {
    let found = study.total(cases);
    if json {
        print_json(&found)?;
    } else {
        println!("{}", sweep::random_table(&found));
    }
    Ok(match found.iter().any(RandomCases::breaks_its_claim) {
        true => ExitCode::FAILURE,
        false => ExitCode::SUCCESS,
    })
}

fn make(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder)
        .map_err(|error| Failure::refused(format!("{}: {error}", folder.display())))
}

/// Runs the arms of these names.
fn run_arms(
    config: &SweepConfig,
    names: &[String],
    driver: &str,
    stop: &AtomicBool,
    json: bool,
) -> Result<ExitCode, Failure> {
    let bar = progress(arms::trials(config, names.len()));
    let begun = Instant::now();
    let rows = arms::arms(config, names, driver, stop, || bar.inc(1));
    bar.finish_and_clear();
    let rows = rows.map_err(|error| match error {
        ArmsError::Plant(_) | ArmsError::Stopped => Failure::failed(error),
        refused => Failure::refused(refused),
    })?;
    eprintln!(
        "{} trials in {:.1} s",
        2 * rows.len(),
        begun.elapsed().as_secs_f64()
    );
    match json {
        true => print_json(&rows)?,
        false => println!("{}", arms_table(&rows)),
    }
    Ok(match rows.iter().all(|row| row.misses.is_empty()) {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    })
}

fn progress(trials: u64) -> ProgressBar {
    let bar = ProgressBar::new(trials);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} trials, {eta} left") {
        bar.set_style(style);
    }
    bar
}

fn write_rows(path: &Path, rows: &[Row]) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(rows).map_err(Failure::failed)?;
    write(path, text.as_bytes())
}

fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    fs::write(path, content)
        .map_err(|error| Failure::failed(format!("{}: {error}", path.display())))
}

//! `ferntast lab trend`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_lab::{
    report::{render_trend, significant},
    work::{Opened, OpenedArm, Trend, TrendError, trends, trends_of_arm},
};

use super::{
    super::{Failure, output::print_json},
    arm, open,
    table::chance,
};

/// Tell what changed between recordings, or between the dates of one experiment.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    ferntast lab trend spring.toml autumn.toml\n  \
    ferntast lab trend recordings/mission/day_*/spring_joint_2   # of a campaign, in the order given\n  \
    ferntast lab trend E.toml -o trend.html        # over its dates, or sessions; with charts\n  \
    ferntast lab trend empty.toml gripper.toml     # of whole arms, and what came on them\n\n\
    The same model is fitted to each: all effects that any of them has. A change counts where it exceeds the \
    standard errors of both ends; with many parameters and dates one in twenty does so by chance.")]
pub struct Arguments {
    /// Experiment files or recordings of sessions, in order; or one experiment of several dates.
    #[arg(required = true)]
    experiments: Vec<PathBuf>,

    /// Write a page with a chart of each parameter.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Do not ask of each whether an effect is missing.
    #[arg(long)]
    quick: bool,
}

/// What is held beside each other.
enum Files {
    /// Of each file one experiment a joint.
    Joints(Vec<Vec<Opened>>),
    /// Of whole arms.
    Arms(Vec<OpenedArm>),
}

impl Files {
    fn open(paths: &[PathBuf]) -> Result<Files, Failure> {
        let (mut joints, mut arms) = (Vec::new(), Vec::new());
        for path in paths {
            match arm::open(path)? {
                Some(own) => arms.push(own),
                None => joints.push(open::open(path)?),
            }
        }
        match (joints.is_empty(), arms.is_empty()) {
            (true, _) => Ok(Files::Arms(arms)),
            (_, true) => Ok(Files::Joints(joints)),
            _ => Err(Failure::refused(
                "some of the files are of a whole arm and some are not: give such as are of the same",
            )),
        }
    }

    fn trends(
        &self,
        diagnoses: bool,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Vec<Trend>, TrendError> {
        match self {
            Files::Joints(files) => trends(files, diagnoses, progress),
            Files::Arms(files) => trends_of_arm(files, diagnoses, progress),
        }
    }
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let files = Files::open(&arguments.experiments)?;
    let bar = open::bar("trend");
    let found = files.trends(!arguments.quick, &mut |share| {
        bar.set_position((share * 1000.0) as u64);
    });
    bar.finish_and_clear();
    let found = found.map_err(Failure::refused)?;
    if let Some(output) = &arguments.output {
        let html = render_trend(&found).map_err(Failure::failed)?;
        std::fs::write(output, html)
            .map_err(|error| Failure::refused(format!("{}: {error}", output.display())))?;
    }
    if json {
        print_json(&found)?;
        return Ok(ExitCode::SUCCESS);
    }
    found.iter().for_each(print);
    if let Some(output) = &arguments.output {
        println!("written to {}", output.display());
    }
    Ok(ExitCode::SUCCESS)
}

fn print(trend: &Trend) {
    println!("{}: model {}", trend.title, trend.effects.join(", "));
    for note in &trend.notes {
        println!("note: {note}");
    }
    if trend.points.iter().any(|point| point.days.is_some()) {
        println!("days count from the first recording");
    }
    let names = trend.points.iter().map(|point| point.name.chars().count());
    let width = names.max().unwrap_or(0).max(20);
    for point in &trend.points {
        let days = point
            .days
            .map_or_else(String::new, |days| format!("day {days:.1}"));
        let degrees = point
            .temperature
            .map_or_else(String::new, |own| format!("{own:.1} degC"));
        let missing = match (&point.missing, point.verdict) {
            (Some(effect), _) => format!("missing: {effect}"),
            (None, Some(verdict)) => verdict.name().to_owned(),
            (None, None) => String::new(),
        };
        println!(
            "  {:<width$} {days:>10} {degrees:>10}  error {} {}  {missing}",
            point.name,
            significant(point.held_out),
            trend.unit
        );
    }
    println!();
    let names = (trend.parameters.iter()).map(|own| own.name.chars().count());
    let width = names.max().unwrap_or(0).max(16);
    if !trend.parameters.is_empty() {
        println!(
            "{:<width$} {:>12} {:>12} {:>12} {:>10} {:>9}  unit",
            "parameter", "first", "last", "change", "± error", "p of all"
        );
    }
    for course in &trend.parameters {
        let value = |of: Option<&ferntast_lab::work::Point>| {
            let own = of.and_then(|point| point.parameters.get(&course.name));
            own.map_or_else(|| "-".to_owned(), |own| significant(own.value))
        };
        let (change, error, mark) = course.change.as_ref().map_or_else(
            || ("-".to_owned(), "-".to_owned(), ""),
            |own| {
                let mark = if own.exceeds_errors {
                    "  exceeds its errors"
                } else {
                    ""
                };
                (significant(own.change), significant(own.std_error), mark)
            },
        );
        println!(
            "{:<width$} {:>12} {:>12} {change:>12} {error:>10} {:>9}  {}{mark}",
            course.name,
            value(trend.points.first()),
            value(trend.points.last()),
            course.p_value.map_or_else(|| "-".to_owned(), chance),
            course.unit
        );
    }
    for turn in &trend.came_or_went {
        println!(
            "{} {} between {} and {} ({})",
            turn.effect,
            if turn.came { "came" } else { "went" },
            turn.from,
            turn.to,
            if turn.by_diagnosis {
                "by the diagnosis"
            } else {
                "by its parameters"
            }
        );
    }
}

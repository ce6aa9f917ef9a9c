//! `ferntast lab discover`.

use std::{path::PathBuf, process::ExitCode};

use super::{super::Failure, arm, open, table};

/// Propose formulas for what no effect of the catalogue explains.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Where `ferntast lab diagnose` ends with \"unexplained\", short formulas over the signals are searched: \
    their units work out, their constants have standard errors, and they lower the error on data held out by more \
    than its uncertainty and by more than chance does in the same search (p-value). Nothing is proposed where \
    nothing is left, and where an effect of the catalogue is missing only what is certainly better.\n\n\
    Read them, and accept the one that you believe:\n  \
    ferntast lab discover E.toml\n  \
    ferntast lab add E.toml 'film=c1*tanh(qd/0.21)*tau^2'     # the expression as printed: the error promised\n\n\
    Which formulas cannot be told apart by these data, and the recording that would, stands below each. The same \
    seed gives the same answer. Of a whole arm formulas are proposed for every joint that is unexplained, over the \
    motions of all joints (position_NAME, velocity_NAME, load_NAME)."
)]
pub struct Arguments {
    /// Experiment file, or the recording of a session.
    experiment: PathBuf,

    /// Decides what chance is taken to be.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    if let Some(opened) = arm::open(&arguments.experiment)? {
        return arm::discover(&opened, arguments.seed, json);
    }
    let mut results = Vec::new();
    for opened in open::open(&arguments.experiment)? {
        let bar = open::bar("discover");
        let result = opened.discover(arguments.seed, &mut |share| {
            bar.set_position((share * 1000.0) as u64);
        });
        bar.finish_and_clear();
        let result = result.map_err(Failure::refused)?;
        if !json {
            println!("{}", opened.experiment.title);
            let path = opened.experiment.path.as_deref();
            table::discovery(&result, path, opened.torque_unit());
        }
        let result = opened.in_unit(result);
        results.push((opened.experiment.title, result));
    }
    if json {
        open::print_results(&results)?;
    }
    Ok(ExitCode::SUCCESS)
}

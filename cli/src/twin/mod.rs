//! `ferntast twin`.

mod experiment;
mod friction;

use std::process::ExitCode;

use clap::Subcommand;
use ferntast_msgs::sample::FrictionCommand;

use super::Failure;

/// Use what the twin of a joint found: in the servo's friction feed-forward, or in the lab.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "While a session runs that was started with --twin joint.toml:\n  \
    ferntast twin friction           # tells what is fed forward\n  \
    ferntast twin take-over          # excited parameters with small standard errors, within bounds\n  \
    ferntast twin give-back          # what is configured, again\n  \
    ros2 param set /servo friction twin\n\
    Bounds, certainty and time are in the scenario's [servo.take_over]. Parameters are called as in the arm's file: \
    its b_0, b_0T, b_1, b_2, b_3 are b0, b0T, b1, b2, b3 in the lab.\n\n\
    From its recording into the lab:\n  \
    ferntast twin experiment recordings/run --model joint.toml -o found.toml\n  \
    ferntast lab compare found.toml"
)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Tell the friction that the servo feeds forward.
    Friction(friction::Arguments),
    /// Feed the friction forward that the twin found.
    TakeOver(friction::Arguments),
    /// Feed the configured friction forward again.
    GiveBack(friction::Arguments),
    /// Write an experiment of the lab that begins with what the twin found in a recording.
    Experiment(experiment::Arguments),
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    match arguments.what {
        What::Friction(own) => friction::run(&own, None, json),
        What::TakeOver(own) => friction::run(&own, Some(FrictionCommand::TAKE_OVER), json),
        What::GiveBack(own) => friction::run(&own, Some(FrictionCommand::GIVE_BACK), json),
        What::Experiment(own) => experiment::run(&own, json),
    }
}

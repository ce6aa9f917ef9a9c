//! `ferntast fleet`.

mod day;
mod live;
mod terminal;
mod watch;

use std::process::ExitCode;

use clap::Subcommand;

use super::Failure;

/// Watch many robots' twins: which joint ages differently from its siblings.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Each robot runs its session with twins of its joints, in a namespace of its own:\n  \
    ferntast session --middleware zenoh --namespace left --twin joint_1.toml --twin joint_2.toml\n\n\
    Live, from their routers, with a journal of days that outlives the watch:\n  \
    ferntast fleet watch --router tcp/left:7447 --router tcp/right:7447 --journal fleet.jsonl\n\n\
    From a journal, or from recordings:\n  \
    ferntast fleet watch fleet.jsonl\n  \
    ferntast fleet day recordings/monday --robot left >> fleet.jsonl"
)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Compare each joint with its siblings day by day, live or from a journal, and name the one that ages differently.
    Watch(watch::Arguments),
    /// Print the days of a recording with a twin as lines of a journal.
    Day(day::Arguments),
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    match arguments.what {
        What::Watch(own) => watch::run(&own, json),
        What::Day(own) => day::run(&own),
    }
}

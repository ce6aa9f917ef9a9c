//! The `ferntast` command.

mod arm;
mod bag;
mod challenge;
mod completions;
mod config;
mod doctor;
mod experiment;
mod faults;
mod fleet;
mod foxglove_option;
mod interfaces;
mod lab;
mod link;
mod lockstep;
mod man;
mod merge;
mod node;
mod output;
mod page_options;
mod paper;
mod play;
mod replay;
mod scenario_options;
mod session;
mod shard_options;
mod state;
mod sweep;
mod twin;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand, builder::PossibleValue};

use ferntast_nodes::{graph::Graph, process::Priority, session_graph};

use output::Failure;

/// Force-reflecting telemanipulation: run sessions, record, play back.
#[derive(Debug, Parser)]
#[command(
    name = "ferntast",
    version,
    about,
    long_about = "Force-reflecting telemanipulation.\n\n\
        An operator moves a haptic master; across a link with delay, jitter and loss a two-joint arm follows, \
        touches a contour, and the contact force comes back into the hand.\n\n\
        Begin with:  ferntast session --duration 20 --record recordings/first\n\
        Then:        ferntast bag info recordings/first\n\
        And:         ferntast doctor",
    propagate_version = true
)]
struct Arguments {
    /// Print one JSON value on stdout; everything else goes to stderr.
    #[arg(long, global = true)]
    json: bool,

    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a session: arm, servo, estimator, master, link, ROS 2 gateway, recorder.
    Session(session::Arguments),
    /// Run one node alone, in this process.
    Node(node::Arguments),
    /// Run a scenario in one process and virtual time, faster than real time.
    Lockstep(lockstep::Arguments),
    /// Feed a lockstep recording again through servo and estimator and compare their outputs.
    Replay(replay::Arguments),
    /// Put a recording back on the topics.
    Play(play::Arguments),
    /// Hold the delay laws against each other over delay, jitter, loss and environment.
    Sweep(sweep::Arguments),
    /// Run a session under seeded schedules of faults, and check at every step what has to hold.
    Faults(faults::Arguments),
    /// Hold a model against a recording, find the missing effect, add it.
    Lab(lab::Arguments),
    /// Put together what parts of a study found that was run with --shard.
    Merge(merge::Arguments),
    /// Make a recording with a hidden effect, to learn on; test the lab with many.
    Challenge(challenge::Arguments),
    /// Run an identification experiment on the arm, or a whole campaign; record it, say what it shows.
    Experiment(experiment::Arguments),
    /// Run the paper's experiments and hold its table and figures against what the recordings say.
    Paper(paper::Arguments),
    /// Look into recordings, mend them.
    Bag(bag::Arguments),
    /// Look at an arm before a session moves it: what of it is implausible.
    Arm(arm::Arguments),
    /// Tell the operating state, or change it: enable, disable, pause, resume (re-arm).
    State(state::Arguments),
    /// Tell how the link does, or change its delay law.
    Link(link::Arguments),
    /// Use what the twin of a joint found: in the servo's friction feed-forward, or in the lab.
    Twin(twin::Arguments),
    /// Watch many robots' twins: which joint ages differently from its siblings.
    Fleet(fleet::Arguments),
    /// Say what this machine offers and lacks, and how to correct it.
    Doctor(doctor::Arguments),
    /// List the topics' interfaces: type, RIHS01 hash, schema.
    Interfaces(interfaces::Arguments),
    /// The arms, links and scenarios that come along: list, show, export to change them.
    Config(config::Arguments),
    /// Print completions for a shell.
    Completions(completions::Arguments),
    /// Write the manual pages.
    Man(man::Arguments),
}

impl Command {
    /// Whether it holds processes or a recording, so that nobody who stops
    /// reading its output may end it.
    fn keeps_running(&self) -> bool {
        use Command::{Arm, Experiment, Faults, Fleet, Lockstep, Node, Paper, Play, Session};
        matches!(
            self,
            Session(_)
                | Arm(_)
                | Node(_)
                | Play(_)
                | Lockstep(_)
                | Faults(_)
                | Fleet(_)
                | Experiment(_)
                | Paper(_)
        )
    }
}

/// The command line; `node` knows the nodes of `graph`.
fn command_line(graph: &Graph) -> clap::Command {
    let names: Vec<PossibleValue> = graph
        .rows()
        .map(|row| PossibleValue::new(row.name).help(row.about))
        .collect();
    Arguments::command().mut_subcommand("node", |node| {
        node.mut_arg("node", |argument| argument.value_parser(names))
    })
}

/// Runs the command line; gives the process's exit code: 0 when all is well,
/// 2 when the input was refused, 1 when something failed on the way.
fn main() -> ExitCode {
    if std::env::args_os()
        .nth(1)
        .is_some_and(|word| word == "state")
    {
        // Whoever wants the arm to stop shall not wait for a computer that is
        // busy. Where that is not allowed it goes on without.
        let _ = Priority::Command.take();
    }
    let graph = session_graph(ferntast_drivers::rows());
    let matches = command_line(&graph).try_get_matches();
    let arguments = match matches.and_then(|found| Arguments::from_arg_matches(&found)) {
        Ok(arguments) => arguments,
        Err(error) => error.exit(),
    };
    let json = arguments.json;
    if !arguments.command.keeps_running() {
        // `ferntast … | head` ends as other programs do, without a word.
        // SAFETY: no handler is involved; no other thread runs yet.
        unsafe {
            libc::signal(libc::SIGPIPE, libc::SIG_DFL);
        }
    }
    let result = match arguments.command {
        Command::Session(arguments) => session::run(&graph, arguments, json),
        Command::Node(arguments) => node::run(&graph, arguments),
        Command::Lockstep(arguments) => lockstep::run(&graph, arguments, json),
        Command::Replay(arguments) => replay::run(&graph, arguments, json),
        Command::Play(arguments) => play::run(&graph, arguments, json),
        Command::Challenge(arguments) => challenge::run(arguments, json),
        Command::Sweep(arguments) => sweep::run(arguments, json),
        Command::Faults(arguments) => faults::run(&graph, &arguments, json),
        Command::Lab(arguments) => lab::run(arguments, json),
        Command::Merge(arguments) => merge::run(&graph, &arguments, json),
        Command::Experiment(arguments) => experiment::run(arguments, json),
        Command::Paper(arguments) => paper::run(&arguments, json),
        Command::Bag(arguments) => bag::run(arguments, json),
        Command::Arm(arguments) => arm::run(arguments, json),
        Command::State(arguments) => state::run(arguments, json),
        Command::Link(arguments) => link::run(arguments, json),
        Command::Twin(arguments) => twin::run(arguments, json),
        Command::Fleet(arguments) => fleet::run(arguments, json),
        Command::Doctor(arguments) => doctor::run(arguments, json),
        Command::Interfaces(arguments) => interfaces::run(arguments, json),
        Command::Config(arguments) => config::run(&arguments, json),
        Command::Completions(arguments) => completions::run(&arguments, command_line(&graph)),
        Command::Man(arguments) => man::run(&arguments, command_line(&graph), json),
    };
    match result {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}

//! `ferntast node`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_bus::SharedMemoryBus;
use ferntast_nodes::{
    graph::{self, Graph},
    process::{NodeError, SessionContext, stop_on_signals},
};

use super::{Failure, scenario_options::ScenarioOptions};

/// Run one node alone, in this process.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "The node meets others of the same --session over shared memory. Three terminals make an arm that can be felt:\n  \
    ferntast node arm\n  \
    ferntast node servo\n  \
    ferntast node estimator"
)]
pub struct Arguments {
    /// Which node.
    #[arg(value_name = "NODE")]
    node: String,

    /// Name of the session whose other nodes it shall meet.
    #[arg(long, default_value = "default", value_name = "NAME")]
    session: String,

    #[command(flatten)]
    scenario: ScenarioOptions,

    /// Folder that the recorder writes or the player plays.
    #[arg(long, value_name = "DIR")]
    bag: Option<PathBuf>,

    /// Experiment whose model the twin holds against a joint (may be given again for another joint).
    #[arg(long, value_name = "EXPERIMENT.toml")]
    twin: Vec<PathBuf>,

    /// Everything at once, as the supervisor wrote it.
    #[arg(long, hide = true)]
    session_file: Option<PathBuf>,

    /// How often the supervisor started it before.
    #[arg(long, default_value_t = 0, hide = true)]
    generation: u32,
}

/// Runs it until Ctrl-C.
pub fn run(graph: &Graph, arguments: Arguments) -> Result<ExitCode, Failure> {
    let row = graph.row(&arguments.node).map_err(Failure::refused)?;
    let supervised = arguments.session_file.is_some();
    let context = match &arguments.session_file {
        Some(path) => SessionContext::read(path).map_err(Failure::refused)?,
        None => {
            let driver = arguments.scenario.driver();
            let loaded = arguments.scenario.load()?;
            let mut context =
                SessionContext::new(&arguments.session, loaded).map_err(Failure::refused)?;
            context.link_access.peer = arguments.scenario.link_peer;
            context.driver = driver;
            context.bag = arguments.bag;
            context.twins = arguments.twin;
            context
        }
    };
    let stop = stop_on_signals().map_err(Failure::failed)?;
    if !supervised {
        eprintln!(
            "node {} of session {:?}; Ctrl-C ends it",
            row.name, context.session
        );
    }
    let result = graph::process::run(row, &context, arguments.generation, &stop);
    if !supervised {
        // The last process of the session frees its shared memory; while
        // others live this is refused.
        let _ = SharedMemoryBus::clean_up(&context.session);
    }
    result.map(|()| ExitCode::SUCCESS).map_err(|error| {
        let text = format!("node {}: {error}", row.name);
        match error {
            NodeError::Broken(_) => Failure::failed(text),
            _ => Failure::refused(text),
        }
    })
}

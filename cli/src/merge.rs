//! `ferntast merge`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_nodes::graph::Graph;
use ferntast_studies::{
    challenge::{LawPlan, Plan},
    faults::FaultStudy,
    lab_folder::LabFolder,
    shard::{self, Study, merge},
    sweep::{RandomSweep, SweepConfig},
};

use super::{Failure, challenge, faults, lab, sweep};

/// Put together what parts of a study found.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "sweep, faults, challenge blind, challenge discover and lab auto of a folder can be run in parts, \
    on as many machines as there are, by whatever starts programs there:\n  \
    for i in 1 2 3; do ferntast sweep --shard $i/3 & done; wait\n  \
    ferntast merge sweep_*_of_3.toml --json\n\n\
    What is told then, and the exit code, are those of one run, byte for byte (but for how long it took)."
)]
pub struct Arguments {
    /// Files of all parts.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,

    /// Of a sweep: write sweep.json and sweep.html into this folder. Of faults: folder for the schedules that fail.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Runs it.
pub fn run(graph: &Graph, arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let parts = &arguments.parts;
    let output = arguments.output.as_deref();
    let first = parts
        .first()
        .ok_or_else(|| Failure::refused("no part was given"))?;
    let kind = shard::kind(first).map_err(Failure::refused)?;
    match kind.as_str() {
        SweepConfig::KIND => {
            let (config, rows) = merge::<SweepConfig>(parts).map_err(Failure::refused)?;
            sweep::tell(&config, rows, output, json)
        }
        RandomSweep::KIND => {
            let (study, cases) = merge::<RandomSweep>(parts).map_err(Failure::refused)?;
            sweep::tell_random(&study, &cases, json)
        }
        Plan::KIND => {
            let (plan, answers) = merge::<Plan>(parts).map_err(Failure::refused)?;
            challenge::blind::tell(&plan, answers, json)
        }
        LawPlan::KIND => {
            let (plan, answers) = merge::<LawPlan>(parts).map_err(Failure::refused)?;
            challenge::discover::tell(&plan, answers, json)
        }
        FaultStudy::KIND => {
            let (study, answers) = merge::<FaultStudy>(parts).map_err(Failure::refused)?;
            faults::tell_merged(graph, &study, answers, output, json)
        }
        LabFolder::KIND => {
            let (study, answers) = merge::<LabFolder>(parts).map_err(Failure::refused)?;
            lab::tell_folder(&study, &answers, json)
        }
        other => Err(Failure::refused(format!(
            "{}: a part of {other:?}, which this program does not know; merge it with the one that made it",
            first.display()
        ))),
    }
}

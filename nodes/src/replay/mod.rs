//! Feeds a recording again through the nodes that can be replayed: servo,
//! estimator and, if asked, a twin.

mod check;
mod recorded;

use std::path::{Path, PathBuf};

use ferntast_bus::CreateError;
use serde::Serialize;

use crate::{
    graph::{Graph, NodeRow},
    lockstep::{RunError, VirtualTime},
    process::SessionContext,
    twin::{LastWords, TwinSummary},
};

use recorded::Recorded;

/// Why a recording cannot be fed again.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// It cannot be opened.
    #[error("{0}")]
    Open(String),
    /// It does not say what it was made of.
    #[error(
        "the recording does not say what it was made of ({0}); only recordings of `ferntast lockstep` can be fed again"
    )]
    Origin(String),
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// A node cannot be made.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// How the outputs compare.
#[derive(Debug, Serialize)]
pub struct Comparison {
    /// Whether all were equal, bit for bit.
    pub equal: bool,
    /// Output messages compared.
    pub compared: u64,
    /// Messages that differ, are missing or are too many.
    pub different: u64,
    /// The first difference.
    pub first_difference: Option<String>,
    /// The last word of each twin.
    pub twins: Vec<TwinSummary>,
}

/// Feeds the recording at `path` again through the nodes of `graph` that can
/// be replayed, and through twins of the experiments `twins`, and compares what
/// they publish with what is recorded: of the twin only where one was recorded.
///
/// # Errors
///
/// A recording that cannot be opened, or that lockstep did not make; an
/// experiment that cannot be followed.
pub fn run(
    graph: &Graph,
    path: &Path,
    twins: &[PathBuf],
    progress: &mut dyn FnMut(f64),
) -> Result<Comparison, ReplayError> {
    let recorded = Recorded::open(path)?;
    let mut session = SessionContext::in_virtual_time(recorded.loaded()?);
    session.twins = twins.to_vec();
    let rows: Vec<&NodeRow> = graph
        .rows()
        .filter(|row| (row.in_replay)(&session))
        .collect();

    let mut time = VirtualTime::new(recorded.start).map_err(RunError::from)?;
    let joints = session.joints();
    let mut forwarder = recorded.inputs(&rows, &joints, time.bus())?;
    time.add(move |now| {
        forwarder.forward(now);
    });
    time.add_nodes(rows.iter().copied(), &session)?;
    let compared = recorded.outputs(&rows, &joints)?;
    let mut checks = check::checks(compared, &joints, &recorded.bus, time.bus())?;
    let mut said = LastWords::new(time.bus())?;

    let mut result = Comparison {
        equal: true,
        compared: 0,
        different: 0,
        first_difference: None,
        twins: Vec::new(),
    };
    let duration = recorded.end.seconds_since(recorded.start).max(1e-9);
    while time.now() <= recorded.end {
        let now = time.tick();
        for check in &mut checks {
            check.check(now, &mut result);
        }
        said.update(now);
        if now.nanos_since(recorded.start) % 1_000_000_000 == 0 {
            progress(now.seconds_since(recorded.start) / duration);
        }
    }
    // What was published at the end is visible after it.
    said.update(time.now());
    result.twins = said.summaries();
    Ok(result)
}

//! What runs in virtual time: `ferntast lockstep` and `ferntast sweep`.

use std::{
    path::PathBuf,
    sync::atomic::{AtomicUsize, Ordering},
};

use ferntast_config::Changes;
use ferntast_drivers::simulated;
use ferntast_nodes::{process::SessionContext, session_graph};
use ferntast_studies::{
    lockstep::{self as alone, LockstepPlan},
    shard::{Shard, values},
    sweep::{self as sweeps, Row, SweepConfig},
};
use pyo3::{prelude::*, types::PyAny};
use serde::Serialize;

use crate::{
    error::{failed, refused},
    interrupt,
    lab::json,
};

/// Runs a scenario. Ctrl-C closes the recording.
#[pyfunction]
#[pyo3(signature = (scenario, link, law, rtt_ms, hand, seed, duration, switch, twin, take_over, give_back, record,
    progress))]
#[allow(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn lockstep(
    py: Python<'_>,
    scenario: String,
    link: Option<String>,
    law: Option<String>,
    rtt_ms: Option<f64>,
    hand: Option<String>,
    seed: Option<u64>,
    duration: Option<f64>,
    switch: Vec<(f64, String)>,
    twin: Vec<PathBuf>,
    take_over: Option<f64>,
    give_back: Option<f64>,
    record: Option<PathBuf>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let changes = Changes {
        link,
        law,
        rtt_ms,
        hand,
        seed,
    };
    let plan = LockstepPlan {
        duration,
        switches: switch,
        take_over,
        give_back,
    };
    interrupt::run(py, progress, move |watch| {
        let mut loaded =
            ferntast_config::load_scenario(&scenario, simulated::load_arm).map_err(refused)?;
        changes.apply(&mut loaded).map_err(refused)?;
        let mut context = SessionContext::in_virtual_time(loaded);
        context.twins = twin;
        context.bag = record;
        let whole = plan.duration_in(&context).map_err(refused)?;
        let graph = session_graph(ferntast_drivers::rows());
        let mut done = |passed: f64| {
            watch.tell(passed / whole);
            !watch.is_stopped()
        };
        let outcome = alone::run(&graph, &context, &plan, &mut done).map_err(refused)?;
        match &outcome.recording_fault {
            Some(fault) => Err(failed(fault)),
            None => json(&outcome),
        }
    })
}

#[derive(Serialize)]
struct Swept {
    /// As the command line prints them.
    rows: Vec<Row>,
    /// Its table.
    text: String,
}

/// Holds the delay laws against each other.
#[pyfunction]
#[pyo3(signature = (config, laws, progress))]
pub fn sweep(
    py: Python<'_>,
    config: String,
    laws: Vec<String>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    interrupt::run(py, progress, move |watch| {
        let mut config = SweepConfig::load(&config).map_err(refused)?;
        config.only(&laws).map_err(refused)?;
        let trials = config.conditions().len() as f64;
        let done = AtomicUsize::new(0);
        let step = || {
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            watch.step(count as f64 / trials);
        };
        let rows = sweeps::run(&config, Shard::WHOLE, watch.stop(), step).map_err(refused)?;
        watch.step(1.0);
        let rows = values(rows);
        let text = sweeps::table(&rows);
        json(&Swept { rows, text })
    })
}

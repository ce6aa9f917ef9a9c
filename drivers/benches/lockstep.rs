//! How much faster than time shipped scenarios run in lockstep, with all nodes on one core:
//! two joints alone, with every message recorded, and seven joints.

use std::{path::Path, time::Instant};

use ferntast_drivers::simulated;
use ferntast_nodes::{lockstep::LockstepSession, process::SessionContext, session_graph};

/// Virtual time of one run \[s\].
const SECONDS: f64 = 20.0;
const RUNS: usize = 9;

fn main() {
    println!(
        "{:<28} {:>8} {:>8} {:>8}   times real time, {RUNS} runs of {SECONDS} s",
        "scenario", "min", "median", "max"
    );
    let folder = std::env::temp_dir().join(format!("ferntast-bench-{}", std::process::id()));
    report("rokviss", || run("rokviss", None));
    report("panda", || run("panda", None));
    report("rokviss, recorded", || {
        let factor = run("rokviss", Some(&folder));
        // Made again by the next run.
        let _ = std::fs::remove_dir_all(&folder);
        factor
    });
}

fn report(name: &str, mut run: impl FnMut() -> Result<f64, String>) {
    let factors: Result<Vec<f64>, String> = (0..RUNS).map(|_| run()).collect();
    match factors {
        Ok(mut factors) => {
            factors.sort_by(f64::total_cmp);
            let (min, median, max) = (factors[0], factors[RUNS / 2], factors[RUNS - 1]);
            println!("{name:<28} {min:>8.0} {median:>8.0} {max:>8.0}");
        }
        Err(error) => eprintln!("{name}: {error}"),
    }
}

/// Virtual seconds per second.
fn run(scenario: &str, record: Option<&Path>) -> Result<f64, String> {
    let mut loaded = ferntast_config::load_scenario(scenario, simulated::load_arm)
        .map_err(|error| error.to_string())?;
    loaded.complete().map_err(|error| error.to_string())?;
    let mut context = SessionContext::in_virtual_time(loaded);
    context.bag = record.map(Path::to_owned);
    let graph = session_graph(ferntast_drivers::rows());
    let begun = Instant::now();
    let mut session = LockstepSession::new(&graph, &context).map_err(|error| error.to_string())?;
    session.run(SECONDS);
    session.finish().map_err(|error| error.to_string())?;
    Ok(SECONDS / begun.elapsed().as_secs_f64())
}

//! Recursive least squares: accuracy and tracking on one set of data, beside
//! Python peers, and the cost of one update with eight parameters.
//!
//! The data: a friction model of eight parameters in steady motion, noise of
//! known size; one parameter steps at half time. `padasip` (RLS with a fixed
//! forgetting factor) and NumPy (least squares on a sliding window) get the
//! same rows through a CSV file. They run if a Python that has both is named:
//!
//!     python3 -m venv /tmp/peer && /tmp/peer/bin/pip install numpy padasip
//!     PEER_PYTHON=/tmp/peer/bin/python cargo bench -p ferntast-identification --bench on_line

use std::fmt::Write as _;
use std::time::Instant;

use ferntast_model::recursive_least_squares::{Forgetting, Prior, RecursiveLeastSquares};

const PARAMETERS: usize = 8;
const SAMPLES: usize = 40_000;
/// Time between samples \[s\].
const PERIOD: f64 = 0.01;
const NOISE: f64 = 0.2;
/// Memory of every estimator \[samples\].
const MEMORY: f64 = 2000.0;
const TRUTH: [f64; PARAMETERS] = [9.0, 35.0, -8.0, 6.0, 0.4, 1.2, -0.7, 0.15];
/// Which parameter steps at half time, and to what.
const STEP: (usize, f64) = (1, 42.0);
const PEER: &str = include_str!("on_line_peer.py");

fn main() {
    let rows = rows();
    report_ours(
        "fixed",
        &rows,
        Forgetting::Exponential {
            factor: 1.0 - 1.0 / MEMORY,
        },
    );
    report_ours(
        "variable",
        &rows,
        Forgetting::Variable {
            memory: MEMORY,
            least: 0.98,
        },
    );
    match peer(&rows) {
        Ok(text) => print!("{text}"),
        Err(error) => println!("no peer: {error}"),
    }
}

/// φ and y of every sample; uniform noise of standard deviation [`NOISE`].
fn rows() -> Vec<([f64; PARAMETERS], f64)> {
    let mut state = 1_u64;
    let mut uniform = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    (0..SAMPLES)
        .map(|sample| {
            let time = sample as f64 * PERIOD;
            let q = 0.9 * (0.7 * time).sin() + 0.3 * (2.3 * time).sin();
            let v = 0.63 * (0.7 * time).cos() + 0.69 * (2.3 * time).cos();
            let load = 15.0 * (0.11 * time).sin();
            let warm = (0.02 * time).sin();
            let s = v.signum();
            let phi = [
                s,
                v,
                v * v.abs(),
                v.powi(3),
                load.abs() * s / 15.0,
                q,
                warm * s,
                1.0,
            ];
            let mut theta = TRUTH;
            if sample >= SAMPLES / 2 {
                theta[STEP.0] = STEP.1;
            }
            let y: f64 = phi.iter().zip(theta).map(|(x, t)| x * t).sum();
            (phi, y + NOISE * 3.0_f64.sqrt() * uniform())
        })
        .collect()
}

fn report_ours(name: &str, rows: &[([f64; PARAMETERS], f64)], forgetting: Forgetting) {
    let priors = [Prior::unbounded(0.0, 100.0); PARAMETERS];
    let Ok(mut estimator) = RecursiveLeastSquares::new(&priors, NOISE, forgetting) else {
        println!("no estimator: a prior is not usable");
        return;
    };
    let mut track = Vec::with_capacity(rows.len());
    let begun = Instant::now();
    for (phi, y) in rows {
        estimator.update(phi, *y);
        track.push(
            estimator
                .estimate()
                .get(STEP.0)
                .copied()
                .unwrap_or(f64::NAN),
        );
    }
    let cost = begun.elapsed().as_secs_f64() / rows.len() as f64;
    println!(
        "ours, {name:9} {:6.0} ns an update  {}",
        cost * 1e9,
        summary(&track)
    );
}

/// Error of the parameter that steps: rms before and at the end, and how long
/// after the step it is within a tenth of the step for good.
fn summary(track: &[f64]) -> String {
    let rms = |from: usize, to: usize, truth: f64| {
        let sum: f64 = track[from..to].iter().map(|x| (x - truth).powi(2)).sum();
        (sum / (to - from) as f64).sqrt()
    };
    let half = SAMPLES / 2;
    let size = (STEP.1 - TRUTH[STEP.0]).abs();
    let late = track[half..]
        .iter()
        .rposition(|x| (x - STEP.1).abs() > 0.1 * size)
        .map_or(0, |last| last + 1);
    format!(
        "rms error before {:.3}, at the end {:.3} Nm s/rad; follows the step within {:.1} s",
        rms(half / 2, half, TRUTH[STEP.0]),
        rms(SAMPLES * 3 / 4, SAMPLES, STEP.1),
        late as f64 * PERIOD
    )
}

fn peer(rows: &[([f64; PARAMETERS], f64)]) -> Result<String, String> {
    let python = std::env::var("PEER_PYTHON").map_err(|_| "PEER_PYTHON names no Python")?;
    let mut csv = String::new();
    for (phi, y) in rows {
        for x in phi {
            write!(csv, "{x},").map_err(|error| error.to_string())?;
        }
        writeln!(csv, "{y}").map_err(|error| error.to_string())?;
    }
    let file = std::env::temp_dir().join(format!("ferntast-on-line-{}.csv", std::process::id()));
    std::fs::write(&file, csv).map_err(|error| error.to_string())?;
    let output = std::process::Command::new(&python)
        .args(["-c", PEER])
        .arg(&file)
        .args([
            MEMORY.to_string(),
            STEP.0.to_string(),
            TRUTH[STEP.0].to_string(),
            STEP.1.to_string(),
            PERIOD.to_string(),
        ])
        .output()
        .map_err(|error| format!("{python}: {error}"));
    std::fs::remove_file(&file).map_err(|error| error.to_string())?;
    let output = output?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

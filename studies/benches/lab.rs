//! The lab on ten minutes at 1 kHz (600 000 samples): compare, and diagnose
//! over the whole catalogue. On one core, in this order, three runs each.
//! `lab_peers.sh` beside this file puts the same samples to NumPy and pysindy.

use std::{path::Path, time::Instant};

use ferntast_benches::joint_bench::{Bench, BenchConfig, HiddenEffect};
use ferntast_identification::{Dataset, Inertia, ModelSpec, RecordedSession, compare, diagnose};
use ferntast_studies::challenge::TestBench;

const SAMPLES: usize = 600_000;
const PERIOD: f64 = 1e-3;
const RUNS: usize = 3;

fn main() {
    let (dataset, model) = match recording() {
        Ok(both) => both,
        Err(error) => {
            eprintln!("no recording: {error}");
            return;
        }
    };
    if let Some(path) = std::env::var_os("FERNTAST_BENCH_SAMPLES")
        && let Err(error) = write_samples(Path::new(&path), &dataset, &model)
    {
        eprintln!("{}: {error}", Path::new(&path).display());
    }
    let samples: usize = dataset.sessions.iter().map(RecordedSession::len).sum();
    println!("{samples} samples in {} sessions", dataset.sessions.len());
    for _ in 0..RUNS {
        let begun = Instant::now();
        let error = compare(&dataset, &model).map(|own| own.rms.held_out);
        let told = begun.elapsed().as_secs_f64();
        println!("compare   {told:>7.3} s   held out {error:?} Nm");
    }
    for _ in 0..RUNS {
        let begun = Instant::now();
        let first = diagnose(&dataset, &model, &mut |_| {})
            .map(|own| own.candidates.first().map(|best| best.effect.clone()));
        let told = begun.elapsed().as_secs_f64();
        println!("diagnose  {told:>7.3} s   first {first:?}");
    }
    println!(
        "largest memory {:.0} MiB",
        peak_memory_mib().unwrap_or(f64::NAN)
    );
}

/// A recording of the bench, put on a grid of 1 ms.
fn recording() -> Result<(Dataset, ModelSpec), String> {
    let config = BenchConfig {
        hidden: vec![HiddenEffect::Stribeck],
        sessions: 9,
        ..BenchConfig::default()
    };
    let recording = Bench::new(&config)
        .and_then(|bench| bench.record())
        .map_err(|error| error.to_string())?;
    let model = HiddenEffect::model(&recording);
    let mut dataset = HiddenEffect::dataset(&recording);
    let mut left = SAMPLES;
    for session in &mut dataset.sessions {
        let step = PERIOD / session.period;
        let length = (((session.len() - 1) as f64 / step) as usize).min(left);
        left -= length;
        let fine = |values: &Vec<f64>| -> Vec<f64> {
            let at = |index: usize| index as f64 * step;
            (0..length)
                .map(|index| {
                    let (whole, part) = (at(index) as usize, at(index).fract());
                    let next = (whole + 1).min(values.len() - 1);
                    values[whole] + part * (values[next] - values[whole])
                })
                .collect()
        };
        session.position = fine(&session.position);
        session.motor_torque = fine(&session.motor_torque);
        session.joint_torque = session.joint_torque.as_ref().map(fine);
        session.temperature = session.temperature.as_ref().map(fine);
        session.period = PERIOD;
    }
    dataset.sessions.retain(|session| session.len() > 1000);
    Ok((dataset, model))
}

/// The samples for `lab_peers.py`, rows of seven doubles: see there.
fn write_samples(path: &Path, dataset: &Dataset, model: &ModelSpec) -> std::io::Result<()> {
    let inertia = match model.inertia {
        Inertia::Given(inertia) => inertia,
        Inertia::Fit => 0.0,
    };
    let mut bytes = Vec::new();
    for (number, session) in dataset.sessions.iter().enumerate() {
        for index in 0..session.len() {
            let at = |values: &Option<Vec<f64>>| values.as_ref().map_or(0.0, |own| own[index]);
            for value in [
                number as f64,
                index as f64 * session.period,
                session.position[index],
                session.motor_torque[index],
                at(&session.joint_torque),
                at(&session.temperature),
                inertia,
            ] {
                bytes.extend(value.to_le_bytes());
            }
        }
    }
    std::fs::write(path, bytes)
}

/// Largest resident memory of this process \[MiB\].
fn peak_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}

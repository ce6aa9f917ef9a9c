//! How long a recording of the joint bench takes: six sessions of about a minute.

use ferntast_benches::joint_bench::{Bench, BenchConfig, BenchError, HiddenEffect};
use std::time::Instant;

const RUNS: usize = 9;

fn main() -> Result<(), BenchError> {
    println!(
        "{:<24} {:>8} {:>8} {:>8}   ms a recording, {RUNS} runs",
        "hidden", "min", "median", "max"
    );
    report("nothing", &[])?;
    report("ripple", &[HiddenEffect::Ripple])?;
    report("two", &[HiddenEffect::Backlash, HiddenEffect::ChannelDelay])
}

fn report(name: &str, hidden: &[HiddenEffect]) -> Result<(), BenchError> {
    let config = BenchConfig {
        hidden: hidden.to_vec(),
        ..BenchConfig::default()
    };
    let mut times = Vec::with_capacity(RUNS);
    for _ in 0..RUNS {
        let begun = Instant::now();
        std::hint::black_box(Bench::new(&config)?.record()?);
        times.push(begun.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    let (min, median, max) = (times[0], times[RUNS / 2], times[RUNS - 1]);
    println!("{name:<24} {min:>8.1} {median:>8.1} {max:>8.1}");
    Ok(())
}

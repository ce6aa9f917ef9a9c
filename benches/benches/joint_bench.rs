//! How long a recording of the joint bench takes: six sessions of about a minute.

use criterion::{Criterion, criterion_group, criterion_main};
use ferntast_benches::joint_bench::{Bench, BenchConfig, BenchError, HiddenEffect};

fn record(criterion: &mut Criterion) {
    for (name, hidden) in [
        ("nothing", vec![]),
        ("ripple", vec![HiddenEffect::Ripple]),
        (
            "two",
            vec![HiddenEffect::Backlash, HiddenEffect::ChannelDelay],
        ),
    ] {
        let config = BenchConfig {
            hidden,
            ..BenchConfig::default()
        };
        let run = || -> Result<usize, BenchError> {
            let recording = Bench::new(&config)?.record()?;
            Ok(recording.sessions.iter().map(|s| s.time.len()).sum())
        };
        criterion.bench_function(&format!("joint_bench/record_{name}"), |bencher| {
            bencher.iter(|| std::hint::black_box(run()));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = record
}
criterion_main!(benches);

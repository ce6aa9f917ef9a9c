//! A session whose memory stays what it is, in every process.

use std::{
    env, thread,
    time::{Duration, Instant},
};

use ferntast_tests::{MemoryLog, PATIENCE, Session, await_enabled, free_tcp_port, start};

/// What a process may grow by after it has settled \[KiB\].
const MOST: i64 = 1024;
/// What the recorder grows by a minute \[KiB\]: the index of its chunks, which the
/// `mcap` library (0.26) keeps for the summary at the file's end.
const INDEX: i64 = 180;
/// How long caches and queues may fill up before that.
const SETTLING: Duration = Duration::from_secs(120);

/// A third of a minute of settling and two that count; with `./tests/run --soak MINUTES`
/// two of settling, and as long as was asked for in all.
#[test]
fn memory_stays_flat_in_every_process() {
    let minutes = env::var("FERNTAST_SOAK_MINUTES").ok();
    let minutes: Option<f64> = minutes.and_then(|minutes| minutes.parse().ok());
    let (settling, all, most) = match minutes {
        Some(minutes) => {
            let all = Duration::from_secs_f64((minutes * 60.0).max(180.0));
            (SETTLING, all, MOST)
        }
        None => (Duration::from_secs(20), Duration::from_secs(60), MOST / 3),
    };
    let session = Session::new();
    let page = format!("127.0.0.1:{}", free_tcp_port());
    let foxglove = format!("--foxglove=127.0.0.1:{}", free_tcp_port());
    let mut process = start(&session, &["--listen", &page, &foxglove]);
    await_enabled(&session, &mut process);
    let begun = Instant::now();
    let mut log = MemoryLog::default();
    let mut settled = false;
    while begun.elapsed() < all {
        if !settled && begun.elapsed() >= settling {
            settled = true;
            log.begin();
        }
        log.look(&session);
        thread::sleep(Duration::from_secs(2));
    }
    let (after, all) = (settling.as_secs(), all.as_secs());
    eprintln!("memory of every process from {after} s to {all} s\n{log}");
    process.interrupt();
    process.wait(PATIENCE);
    let index = INDEX * (all - after).div_ceil(60) as i64;
    let allowed = |name: &str| most + if name == "recorder" { index } else { 0 };
    let mut grown = log
        .growth()
        .filter(|(name, growth)| *growth >= allowed(name));
    let first = grown.next();
    assert!(first.is_none(), "KiB more in {first:?}\n{log}");
}

//! What the page costs: `cargo bench --workspace --bench page`.
//!
//! Processor time of headless Chromium (all its processes, software rendering)
//! and of the console's process over ten seconds of a session, first paint, and
//! the time until 100 000 points stand in the lab's chart. Needs
//! `cargo build --release` before, as the whole-system tests do.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    fs,
    time::{Duration, Instant},
};

use ferntast_tests::{Browser, Process, Session, await_armed, free_tcp_port, wait_for};

const PATIENCE: Duration = Duration::from_secs(120);
const WATCHED: Duration = Duration::from_secs(10);

/// By process: its parent, and processor time so far \[s\].
fn processes() -> BTreeMap<u32, (u32, f64)> {
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    entries
        .filter_map(|entry| {
            let id: u32 = entry.file_name().to_str()?.parse().ok()?;
            let stat = fs::read_to_string(entry.path().join("stat")).ok()?;
            // The name may hold spaces; what follows its bracket does not.
            let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
            let ticks =
                fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
            Some((id, (fields.get(1)?.parse().ok()?, ticks / 100.0)))
        })
        .collect()
}

/// Processor time of `root` and all its descendants \[s\].
fn time_of(root: u32) -> f64 {
    let all = processes();
    let belongs = |mut id: u32| loop {
        if id == root {
            return true;
        }
        match all.get(&id) {
            Some((parent, _)) if *parent > 1 => id = *parent,
            _ => return false,
        }
    };
    all.iter()
        .filter(|(id, _)| belongs(**id))
        .map(|(_, (_, time))| time)
        .sum()
}

fn console_process(session: &Session) -> Option<u32> {
    session.processes().into_iter().find(|id| {
        fs::read(format!("/proc/{id}/cmdline")).is_ok_and(|line| {
            let mut words = line.split(|byte| *byte == 0).skip(1);
            words.next() == Some(b"node") && words.next() == Some(b"console")
        })
    })
}

fn session() {
    let session = Session::new();
    let address = format!("127.0.0.1:{}", free_tcp_port());
    let mut process = Process::spawn(session.ferntast_here(&["session", "--listen", &address]));
    await_armed(&session, &mut process);
    let console = wait_for(PATIENCE, || console_process(&session)).expect("the console runs");
    let cost = |what: &str, browser: Option<&Browser>| {
        let before = (
            browser.map(|b| time_of(b.process())),
            time_of(console),
            Instant::now(),
        );
        let drawn = browser
            .map(|b| b.number("return Number(document.querySelector('#scene').dataset.drawn)"));
        std::thread::sleep(WATCHED);
        let passed = before.2.elapsed().as_secs_f64();
        let share = |now: f64, then: f64| (now - then) / passed * 100.0;
        println!(
            "{what}: server {:.1} % of a core",
            share(time_of(console), before.1)
        );
        if let (Some(browser), Some(then), Some(drawn)) = (browser, before.0, drawn) {
            let frames = browser
                .number("return Number(document.querySelector('#scene').dataset.drawn)")
                - drawn;
            println!(
                "{what}: Chromium {:.1} % of a core, {:.1} frames a second",
                share(time_of(browser.process()), then),
                frames / passed
            );
        }
    };
    cost("no page", None);
    let browser = Browser::start(1280, 800);
    browser.open(&format!("http://{address}"));
    browser.until(
        "drawn",
        PATIENCE,
        "return Number(document.querySelector('#scene').dataset.drawn) > 50",
    );
    let paint = browser
        .number("return performance.getEntriesByName('first-contentful-paint')[0]?.startTime");
    println!("first contentful paint {paint:.0} ms");
    std::thread::sleep(Duration::from_secs(20));
    cost("one page, 1280×800", Some(&browser));
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE);
}

fn lab() {
    let session = Session::new();
    let folder = session.folder().join("lab");
    fs::create_dir(&folder).expect("a folder");
    let mut text = String::from("t_s,q,tau\n");
    for row in 0..110_000 {
        let t = f64::from(row) * 0.01;
        let q = (0.7 * t).sin() + 0.3 * (0.23 * t).sin();
        let speed = 0.7 * (0.7 * t).cos() + 0.069 * (0.23 * t).cos();
        let tau = 4.0 * speed.signum() + 9.0 * speed + 0.05 * (97.0 * t).sin();
        let _ = writeln!(text, "{t:.4},{q:.8},{tau:.6}");
    }
    fs::write(folder.join("long.csv"), text).expect("a recording");
    let experiment = "recording = \"long.csv\"\n[signals]\nposition = \"q\"\nmotor_torque = \"tau\"\n\
        [model]\ninertia = 0.0\neffects = [\"viscous\"]\n";
    fs::write(folder.join("long.toml"), experiment).expect("an experiment");
    let process = Process::spawn(session.ferntast(&["lab", "serve", "lab", "--json"]));
    let url = wait_for(PATIENCE, || {
        let told: serde_json::Value = serde_json::from_str(&process.stdout()).ok()?;
        told["url"].as_str().map(str::to_owned)
    });
    let browser = Browser::start(1280, 800);
    browser.open(&url.expect("an address"));
    browser.click("[data-path='long.toml']");
    browser.until(
        "drawn",
        PATIENCE,
        "return Number(document.querySelector('#chart-time')?.dataset.took) > 0",
    );
    let points =
        browser.number("return Number(document.querySelector('#chart-time').dataset.points)");
    let took = browser.number("return Number(document.querySelector('#chart-time').dataset.took)");
    println!(
        "first drawing of {points:.0} points (three curves), plotly.js loaded meanwhile: {took:.0} ms"
    );
    // Opened again, plotly.js is there.
    browser.run("document.querySelector('#chart-time').remove()", Vec::new());
    browser.click("[data-path='long.toml']");
    browser.until(
        "drawn again",
        PATIENCE,
        "return Number(document.querySelector('#chart-time')?.dataset.took) > 0",
    );
    let took = browser.number("return Number(document.querySelector('#chart-time').dataset.took)");
    println!("drawing of {points:.0} points (three curves): {took:.0} ms");
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE);
}

fn main() {
    // `cargo test --benches` runs benchmarks with `--test`: they are no tests.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    session();
    lab();
}

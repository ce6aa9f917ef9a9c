//! The lab in a real browser: a hidden effect is found, added, and the error falls.

use std::time::Duration;

use ferntast_tests::{Browser, PATIENCE, Process, Session, run};

use super::lab_bench::{Bench, table};

/// Diagnosing takes a while on a machine that is busy.
pub const LONG: Duration = Duration::from_secs(180);

/// The lab's page on `folder`, and where it is.
pub fn serve(session: &Session, folder: &str) -> (Process, String) {
    let mut process = Process::spawn(session.ferntast(&["lab", "serve", folder, "--json"]));
    let url = ferntast_tests::wait_for(PATIENCE, || {
        let told: serde_json::Value = serde_json::from_str(&process.stdout()).ok()?;
        told["url"].as_str().map(str::to_owned)
    });
    assert!(process.is_running());
    (process, url.expect("an address"))
}

const STAIRS: &str = "return document.querySelector('#chart-stairs')?.dataset.errors ?? '[]'";

fn stairs(browser: &Browser) -> Vec<f64> {
    let text = browser.run(STAIRS, Vec::new());
    serde_json::from_str(text.as_str().unwrap_or("[]")).unwrap_or_default()
}

/// Lines are computed where the processor has to draw them, and left to a graphics card where one is.
#[test]
fn curves_are_drawn_by_the_graphics_card_where_there_is_one() {
    let session = Session::new();
    let riddle = ["challenge", "new", "lab/riddle", "--seed", "89"];
    run(&session, &riddle).success();
    let (process, url) = serve(&session, "lab");
    let by_card = "return document.querySelector('#chart-time .gl-canvas') !== null";
    let by_processor =
        "return document.querySelectorAll('#chart-time .scatterlayer path.js-line').length >= 3";
    let others = [
        (Browser::start(1280, 900), by_processor, by_card),
        (
            Browser::with_graphics_card(1280, 900),
            by_card,
            by_processor,
        ),
    ];
    for (browser, drawn, not_drawn) in others {
        browser.open(&url);
        browser.click("[data-path='riddle/experiment.toml']");
        browser.until("the curves are drawn", LONG, drawn);
        assert_eq!(browser.run(not_drawn, Vec::new()), false);
        assert_eq!(browser.complaints(), Vec::<String>::new());
    }
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn a_hidden_effect_is_found_added_and_the_staircase_falls() {
    let session = Session::new();
    run(
        &session,
        &[
            "challenge",
            "new",
            "lab/riddle",
            "--seed",
            "89",
            "--hide",
            "stribeck",
        ],
    )
    .success();
    let (process, url) = serve(&session, "lab");
    let browser = Browser::start(1280, 900);
    browser.open(&url);
    browser.click("[data-path='riddle/experiment.toml']");
    browser.until(
        "the model is compared",
        LONG,
        "return document.querySelector('#chart-time canvas, #chart-time svg') !== null",
    );
    let began = stairs(&browser);
    assert_eq!(began.len(), 1);
    browser.click("#diagnose");
    browser.until(
        "the verdict is told",
        LONG,
        "return document.querySelector('#verdict')?.dataset.verdict === 'missing'",
    );
    browser.click("#lab-diagnosis button[data-effect]");
    browser.until("the effect is added", LONG, "return JSON.parse(document.querySelector('#chart-stairs')?.dataset.errors ?? '[]').length === 2");
    let after = stairs(&browser);
    assert!(
        (after[0] - began[0]).abs() < 1e-6 * began[0],
        "{began:?} {after:?}"
    );
    assert!((0.2..0.9).contains(&(after[1] / after[0])), "{after:?}");

    // The command line sees the same chain with the same numbers.
    let child = session.folder().join("lab/riddle/experiment+stribeck.toml");
    let told = run(
        &session,
        &["lab", "history", child.to_str().unwrap(), "--json"],
    )
    .success()
    .json();
    let held_out = told[1]["held_out"].as_f64().unwrap_or(f64::NAN);
    assert!((held_out - after[1]).abs() < 1e-9, "{held_out} {after:?}");

    // Undo goes back; an effect of one's own is fitted; nonsense is refused.
    browser.click("#undo");
    browser.until("undone", LONG, "return JSON.parse(document.querySelector('#chart-stairs')?.dataset.errors ?? '[]').length === 1");
    browser.run(
        "document.querySelector('#own-name').closest('details').open = true",
        Vec::new(),
    );
    browser.type_into("#own-name", "wave");
    browser.type_into("#own-expression", "a*sin(3*q) + b*sin(");
    browser.click("#own-add");
    browser.until(
        "it is refused",
        LONG,
        "return document.querySelector('#lab-trouble .error') !== null",
    );
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn a_foreign_recording_is_mapped_by_its_own_columns() {
    let session = Session::new();
    let folder = session.folder().join("lab");
    std::fs::create_dir(&folder).unwrap();
    // A mass on rails: 90 kg, 20 N and 200 Ns/m of friction.
    let rows = (0..8000).map(|row| {
        let t = 0.002 * f64::from(row);
        let (sine, cosine) = (2.0 * t).sin_cos();
        let (q, qd, qdd) = (0.1 * sine, 0.2 * cosine, -0.4 * sine);
        let force = 90.0 * qdd + 20.0 * qd.signum() + 200.0 * qd;
        format!("{t},{q},{q},{force}\n")
    });
    let text = format!("t_s,q_m,qref_m,force_N\n{}", rows.collect::<String>());
    std::fs::write(folder.join("foreign.csv"), text).unwrap();
    let (process, url) = serve(&session, "lab");
    let browser = Browser::start(390, 844);
    browser.open(&url);
    browser.click("[data-path='foreign.csv']");
    browser.find("#begin");
    // The columns come after the form.
    browser.until(
        "its columns are offered",
        LONG,
        "return document.querySelectorAll('#signal-position option').length > 2",
    );
    browser.run(
        "document.querySelector('#joint-kind').value = 'prismatic';
         const choose = (id, words) => { const s = document.querySelector(id);
           s.value = [...s.options].map(o => o.value).find(v => words.some(w => v.includes(w))) ?? s.value; };
         choose('#signal-position', ['q_m', 'qm', 'position']);
         choose('#signal-motor_torque', ['force', 'tau', 'torque']);
         document.querySelector('#signal-joint_torque').value = '';
         document.querySelector('#signal-temperature').value = '';",
        Vec::new(),
    );
    browser.click("#begin");
    browser.until(
        "the experiment is compared",
        LONG,
        "return document.querySelector('.figures b')?.textContent.endsWith('N')",
    );
    assert!(folder.join("foreign.toml").is_file());
    // On a phone nothing is wider than the screen.
    let width = browser.number("return document.documentElement.scrollWidth");
    assert!((380.0..=390.0).contains(&width), "{width} px");
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
}

/// Every later day is warmer: no effect of the one is told from one of the other.
#[test]
fn what_varies_together_is_said_of_the_comparison_and_of_the_diagnosis() {
    let mut files: Vec<(String, String)> = Vec::new();
    for day in 0..6_u32 {
        // Noise that is the same each time.
        let noise = |n: u32| {
            f64::from((n + 3000 * day).wrapping_mul(2_654_435_761) >> 8) / 16_777_216.0 - 0.5
        };
        let temperature = 20.0 + 2.0 * f64::from(day);
        let text = table("t,q,tau,temp", 3000, |n, t, q, tau| {
            let tau = tau + 0.2 * noise(n);
            let temperature = temperature + 0.1 * t;
            let t = 1.7e9 + 86_400.0 * f64::from(day) + t;
            format!("{t:.3},{q:.9},{tau:.6},{temperature:.3}")
        });
        files.push((format!("day_{day}.csv"), text));
    }
    let names: Vec<String> = files.iter().map(|(name, _)| name.clone()).collect();
    let experiment = |temperature: &str| {
        format!(
            "recording = {names:?}\n[signals]\nposition = \"q\"\nmotor_torque = \"tau\"\n{temperature}\n[model]\ninertia = {{ fit = true }}\neffects = [\"coulomb\", \"viscous\"]\n"
        )
    };
    files.push(("warm.toml".to_owned(), experiment("temperature = \"temp\"")));
    files.push(("plain.toml".to_owned(), experiment("")));
    let files: Vec<(&str, &str)> = files
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_str()))
        .collect();
    let bench = Bench::new(&files);
    for (name, sentence) in [
        ("warm.toml", "temperature and date rise together"),
        ("plain.toml", ""),
    ] {
        bench.open(name);
        let free = "return document.querySelector('#lab-head .figures b') !== null && document.querySelector('#diagnose')?.disabled === false";
        bench.browser.until("it is compared", LONG, free);
        assert!(bench.browser.text("#warnings").contains(sentence));
        assert_eq!(bench.browser.text("#lab-diagnosis"), "");
        bench.browser.click("#diagnose");
        let told = "return document.querySelector('#verdict') !== null";
        bench.browser.until("the verdict is told", LONG, told);
        let together = bench.browser.text("#lab-diagnosis [data-together]");
        assert!(together.contains(sentence), "{name}: {together}");
        assert_eq!(
            together.is_empty(),
            sentence.is_empty(),
            "{name}: {together}"
        );
    }
    bench.end();
}

//! What is on a page can be read, in windows of three sizes and in both themes.

use std::{fs, path::Path, time::Duration};

use ferntast_tests::{Browser, PATIENCE, Session, run};

use super::{
    arm_of_three,
    console::session_with_page,
    lab_bench::{self, Bench},
    lab_page, lab_subjects,
};

/// A page that is a file, with at least `words` on its canvases.
fn fits(browser: &Browser, page: &Path, words: f64) {
    browser.open(&format!("file://{}", page.display()));
    browser.watch_words();
    assert_eq!(
        browser.misfits(),
        Vec::<String>::new(),
        "{}",
        page.display()
    );
    let drawn = browser.words_drawn();
    assert!(drawn >= words, "{}: {drawn} words", page.display());
}

/// The scenario of a sweep that takes seconds.
const SWEEP: &str = r#"
description = "Two laws at two delays."
arm = "rokviss"
rtt_ms = [20, 300]
jitter_ms = [0]
loss = [0]
environments = ["hard_wall", "soft_spring"]
tasks = ["press_and_slide"]
seeds = [1]
hand = { mass = 0.5, damping = 20.0, stiffness = 300.0 }
laws = [
    { kind = "position_force", force_scale = 1.0 },
    { kind = "two_layer", force_scale = 1.0 },
]
"#;

#[test]
fn pages_that_are_files_are_read_at_every_width() {
    let session = Session::new();
    let in_folder = |name: &str| session.folder().join(name);
    run(&session, &["challenge", "new", "riddle", "--seed", "76"]).success();
    let done = [
        "lab",
        "report",
        "riddle/experiment.toml",
        "-o",
        "report.html",
    ];
    run(&session, &done).success();
    fs::write(in_folder("small.toml"), SWEEP).expect("a scenario");
    run(&session, &["sweep", "small.toml", "-o", "sweep"]).success();
    let browser = Browser::start(1280, 800);
    fits(&browser, &in_folder("report.html"), 20.0);
    fits(&browser, &in_folder("sweep/sweep.html"), 5.0);
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn the_console_is_read_at_every_width() {
    for arm in ["rokviss", "panda"] {
        let session = Session::new();
        let (process, address) = session_with_page(&session, &["--arm", arm]);
        let browser = Browser::start(1280, 800);
        browser.open(&format!("http://{address}"));
        browser.until(
            "the arm is drawn",
            PATIENCE,
            "return Number(document.querySelector('#scene').dataset.drawn) > 5",
        );
        browser.watch_words();
        assert_eq!(browser.misfits(), Vec::<String>::new(), "{arm}");
        assert!(browser.words_drawn() > 10.0);
        assert_eq!(browser.complaints(), Vec::<String>::new());
        drop(browser);
        process.interrupt();
        process.wait(PATIENCE).success();
    }
}

#[test]
fn the_lab_is_read_at_every_width() {
    let session = Session::new();
    let new = ["challenge", "new", "lab/riddle", "--seed", "76"];
    run(&session, &new).success();
    let (process, url) = lab_page::serve(&session, "lab");
    let browser = Browser::start(1280, 800);
    browser.open(&url);
    browser.click("[data-path='riddle/experiment.toml']");
    browser.until(
        "the model is compared",
        lab_page::LONG,
        "return document.querySelector('#chart-time canvas, #chart-time svg') !== null",
    );
    // The charts below come one after the other.
    browser.until(
        "all is drawn",
        Duration::from_secs(60),
        "return document.querySelectorAll('.js-plotly-plot .xtitle').length > 5",
    );
    assert_eq!(browser.misfits(), Vec::<String>::new());
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn the_form_for_signals_is_read_at_every_width() {
    let session = Session::new();
    let folder = session.folder().join("lab");
    fs::create_dir(&folder).expect("a folder");
    for name in ["monday_bench_with_a_long_name.csv", "tuesday.csv"] {
        let text = lab_bench::table("t,q_deg,tau,remark", 6000, |n, t, q, tau| match n {
            2000..2300 => String::new(),
            n if n % 501 == 3 => format!("{t:.3},nan,{tau:.9},1"),
            _ => format!("{t:.3},{:.9},{tau:.9},x", q.to_degrees()),
        });
        fs::write(folder.join(name), text).expect("a file");
    }
    let (process, url) = lab_page::serve(&session, "lab");
    let browser = Browser::start(1280, 800);
    browser.open(&url);
    browser.click("[data-path='monday_bench_with_a_long_name.csv']");
    let read = |what: &str| {
        let state =
            format!("return document.querySelector('#reading')?.dataset.state === '{what}'");
        browser.until(what, lab_page::LONG, &state);
    };
    let choose = |menu: &str, value: &str| {
        let script = format!(
            "const own = document.querySelector('{menu}'); own.value = '{value}'; own.dispatchEvent(new Event('change'))"
        );
        browser.run(&script, Vec::new());
    };
    read("read");
    choose("#add-recording", "tuesday.csv");
    read("read");
    // With a unit that is doubted, something that cannot be read, and curves.
    choose("#unit-position", "rad");
    read("read");
    choose("#signal-temperature", "remark");
    read("refused");
    assert_eq!(browser.misfits(), Vec::<String>::new());
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn the_forms_for_contacts_arms_and_extra_signals_are_read_at_every_width() {
    let files = [
        ("edge.csv", lab_subjects::edge(6000)),
        ("run.csv", lab_subjects::arm_run(6000)),
        ("three.urdf", arm_of_three::URDF.to_owned()),
    ];
    let bench = Bench::new(&files.each_ref().map(|(name, text)| (*name, text.as_str())));
    let browser = &bench.browser;
    bench.open_as("edge.csv", "contact");
    bench.comes_out("asking");
    bench.choose("#by-tip", "tip");
    bench.comes_out("asking");
    bench.write("#contour", "0.2 0.1, 0.2866025404 0.15, 0.3732050808 0.2");
    browser.click("#add-extra");
    bench.write("#extra-0-name", "temperature_of_the_oil");
    bench.choose("#extra-0-column", "tip_x_mm");
    browser.click("#add-extra");
    bench.comes_out("read");
    assert_eq!(browser.misfits(), Vec::<String>::new());
    bench.open_as("run.csv", "arm");
    bench.comes_out("read");
    // With a question of one joint.
    bench.choose("[id='signal-position@elbow_joint']", "elbow_tau");
    bench.comes_out("read");
    assert_eq!(browser.misfits(), Vec::<String>::new());
    bench.end();
}

/// A page that cannot be read is found: else the tests above say nothing.
#[test]
fn what_is_cut_off_is_found() {
    let session = Session::new();
    let page = session.folder().join("cut.html");
    let text = r#"<!doctype html><meta name=viewport content="width=device-width"><body style="margin:0">
        <div style="width:90px;overflow:hidden;white-space:nowrap">a label that is too long for its box</div>
        <div style="overflow-x:auto"><table style="width:1400px"><td>first<td style="text-align:right">last column</table></div>
        <svg width=60 height=20><text x=30 y=15>too far to the right</text></svg>
        <canvas id=c width=80 height=40></canvas>
        <script>addEventListener('resize', () => { const pen = c.getContext('2d'); pen.clearRect(0, 0, 80, 40);
            pen.fillText('beyond the edge', 40, 20); pen.fillText('one', 5, 35); pen.fillText('other', 8, 35); });</script>"#;
    fs::write(&page, text).expect("a page");
    let browser = Browser::start(1280, 800);
    browser.open(&format!("file://{}", page.display()));
    browser.watch_words();
    browser.show_as((700, 600), "light");
    let found = browser.misfits();
    let tells = |width: &str, words: &str| {
        let told = found
            .iter()
            .any(|own| own.starts_with(width) && own.contains(words));
        assert!(told, "{width}, {words}: {found:#?}");
    };
    tells("1280", "too long for its box” is cut off by div");
    tells("1280", "“last column” has to be scrolled to");
    tells("1280", "to the right” is cut off by svg");
    tells("1280", "“beyond the edge” is cut off by the canvas c");
    tells("1280", "“one” lies on “other”");
    let scrolled = |own: &String| own.contains("last column");
    assert!(
        !found
            .iter()
            .any(|own| own.starts_with("1920") && scrolled(own))
    );
    assert!(
        !found
            .iter()
            .any(|own| own.starts_with("390") && scrolled(own)),
        "a phone's table is drawn along"
    );
}

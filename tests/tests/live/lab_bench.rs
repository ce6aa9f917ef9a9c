//! A bench with one joint: tables that it writes, and the lab's page on their folder.

use std::{fmt::Write as _, fs};

use ferntast_tests::{Browser, PATIENCE, Process, Session, run};
use serde_json::{Value, json};

use super::lab_page::{LONG, serve};

/// Position \[rad\] and motor torque \[Nm\] at a time \[s\]: two sines, J = 0.8 kg m²,
/// 1.5 Nm and 2 Nm s/rad of friction.
pub fn joint(t: f64) -> (f64, f64) {
    let parts = [(0.6, 2.1), (0.25, 5.3)];
    let (mut position, mut velocity, mut acceleration) = (0.0, 0.0, 0.0);
    for (a, w) in parts {
        let (sine, cosine) = f64::sin_cos(w * t);
        position += a * sine;
        velocity += a * w * cosine;
        acceleration -= a * w * w * sine;
    }
    let friction = 1.5 * velocity.signum() + 2.0 * velocity;
    (position, 0.8 * acceleration + friction)
}

/// A table of `count` rows at 500 Hz, each by its number, time, position and torque.
pub fn table(head: &str, count: u32, row: impl Fn(u32, f64, f64, f64) -> String) -> String {
    let mut text = format!("{head}\n");
    for n in 0..count {
        let t = f64::from(n) * 0.002;
        let (q, tau) = joint(t);
        let line = row(n, t, q, tau);
        if !line.is_empty() {
            writeln!(text, "{line}").expect("a string");
        }
    }
    text
}

/// Half a minute.
pub const COUNT: u32 = 15_000;

/// The lab's page on a folder with these files.
pub struct Bench {
    session: Session,
    process: Process,
    /// Its window is that of a desk.
    pub browser: Browser,
}

impl Bench {
    pub fn new(files: &[(&str, &str)]) -> Bench {
        let session = Session::new();
        let folder = session.folder().join("lab");
        fs::create_dir(&folder).expect("a folder");
        for (name, text) in files {
            fs::write(folder.join(name), text).expect("a file");
        }
        let (process, url) = serve(&session, "lab");
        let browser = Browser::start(1280, 900);
        browser.open(&url);
        Bench {
            session,
            process,
            browser,
        }
    }

    pub fn path(&self, name: &str) -> std::path::PathBuf {
        self.session.folder().join("lab").join(name)
    }

    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("it is there")
    }

    /// Names of the experiment files in the folder.
    pub fn experiments(&self) -> Vec<String> {
        let files = fs::read_dir(self.path("")).expect("a folder");
        let names = files.map(|file| file.expect("a file").file_name().into_string());
        let mut names: Vec<String> = names.map(|own| own.expect("a name")).collect();
        names.retain(|own| own.ends_with(".toml"));
        names.sort();
        names
    }

    pub fn open(&self, name: &str) {
        self.browser.click(&format!("[data-path='{name}']"));
    }

    /// Opens a recording that is about another kind than a joint: `contact` or `arm`.
    pub fn open_as(&self, name: &str, kind: &str) {
        self.open(name);
        let looked = "return ['asking', 'refused', 'read'].includes(document.querySelector('#reading')?.dataset.state)";
        self.browser.until("it is looked at", LONG, looked);
        self.choose("#joint-kind", kind);
    }

    /// What was said last has been tried, and came out so.
    pub fn comes_out(&self, state: &str) {
        let script =
            format!("return document.querySelector('#reading')?.dataset.state === '{state}'");
        self.browser.until(state, LONG, &script);
    }

    /// Chooses a value of a menu, as a person does.
    pub fn choose(&self, selector: &str, value: &str) {
        self.browser.find(selector);
        let there = self.browser.run(
            "const menu = document.querySelector(arguments[0]); menu.value = arguments[1];
             menu.dispatchEvent(new Event('change')); return menu.value === arguments[1]",
            vec![json!(selector), json!(value)],
        );
        assert_eq!(there, json!(true), "{selector} has no {value}");
    }

    /// Writes into a field, as a person does who has ended.
    pub fn write(&self, selector: &str, text: &str) {
        self.browser.find(selector);
        self.browser.run(
            "const field = document.querySelector(arguments[0]); field.value = arguments[1];
             for (const name of ['input', 'change']) field.dispatchEvent(new Event(name))",
            vec![json!(selector), json!(text)],
        );
    }

    pub fn value(&self, selector: &str) -> String {
        let script = "return document.querySelector(arguments[0])?.value ?? 'nothing'";
        let value = self.browser.run(script, vec![json!(selector)]);
        value.as_str().unwrap_or_default().to_owned()
    }

    /// A cell of the table of what is read.
    pub fn read(&self, signal: &str, what: &str) -> String {
        let selector = format!("#reading [data-signal='{signal}'] [data-what='{what}']");
        self.browser.text(&selector)
    }

    /// The greatest value of a drawn curve, and its axis.
    pub fn curve(&self, number: u32) -> (f64, String) {
        let script = format!(
            "const chart = document.querySelector('#chart-reading'), own = chart.data[{number}];
             const axis = chart.layout['yaxis' + (own.yaxis ?? 'y').slice(1)];
             return [Math.max(...own.y.filter(Number.isFinite)), axis.title.text]"
        );
        let told = self.browser.run(&script, Vec::new());
        let text = told[1].as_str().unwrap_or_default().to_owned();
        (told[0].as_f64().unwrap_or(f64::NAN), text)
    }

    pub fn begun(&self) {
        self.browser.click("#begin");
        self.browser.until(
            "the experiment is compared",
            LONG,
            "return document.querySelector('#lab-head .figures b') !== null && document.querySelector('#mapping') === null",
        );
    }

    pub fn compared(&self, experiment: &str) -> Value {
        let file = self.path(experiment);
        let file = file.to_str().expect("a name");
        run(&self.session, &["lab", "compare", file, "--json"])
            .success()
            .json()
    }

    pub fn end(self) {
        assert_eq!(self.browser.complaints(), Vec::<String>::new());
        drop(self.browser);
        self.process.interrupt();
        self.process.wait(PATIENCE).success();
    }
}

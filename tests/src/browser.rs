//! A browser without a window, driven as a person would.

use std::{path::Path, process::Command, time::Duration};

use fantoccini::{
    Client, ClientBuilder, Locator,
    actions::{InputSource, MOUSE_BUTTON_LEFT, MOUSE_BUTTON_RIGHT, MouseActions, PointerAction},
    elements::Element,
    wd::{Capabilities, WebDriverCompatibleCommand},
};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio::runtime::Runtime;
use url::{ParseError, Url};

use crate::{Process, free_tcp_port, wait_for};

/// How long the driver may take to come up, and a page to show something.
const PATIENCE: Duration = Duration::from_secs(40);

/// Headless Chromium, by Debian's `chromium` and `chromium-driver`.
pub struct Browser {
    runtime: Runtime,
    client: Option<Client>,
    _profile: TempDir,
    driver: Process,
}

/// What the page said on its console, and asks for it.
#[derive(Debug)]
struct ConsoleLog;

impl WebDriverCompatibleCommand for ConsoleLog {
    fn endpoint(&self, base: &Url, session: Option<&str>) -> Result<Url, ParseError> {
        base.join(&format!("session/{}/se/log", session.unwrap_or_default()))
    }

    fn method_and_body(&self, _: &Url) -> (http::Method, Option<String>) {
        (
            http::Method::POST,
            Some(json!({"type": "browser"}).to_string()),
        )
    }
}

/// A command of the Chrome DevTools Protocol.
#[derive(Debug)]
struct DevTools(&'static str, Value);

impl WebDriverCompatibleCommand for DevTools {
    fn endpoint(&self, base: &Url, session: Option<&str>) -> Result<Url, ParseError> {
        base.join(&format!(
            "session/{}/goog/cdp/execute",
            session.unwrap_or_default()
        ))
    }

    fn method_and_body(&self, _: &Url) -> (http::Method, Option<String>) {
        let DevTools(command, parameters) = self;
        let body = json!({"cmd": command, "params": parameters});
        (http::Method::POST, Some(body.to_string()))
    }
}

/// What finds texts that are cut off.
const LAYOUT: &str = include_str!("layout.js");
/// So long a page may take to lay itself out anew.
const SETTLED: Duration = Duration::from_millis(900);
/// A desk's small and large window, and a phone's \[pixels\].
const SIZES: [(u32, u32); 3] = [(1280, 800), (1920, 1080), (390, 844)];

/// With these nothing computes what a graphics card would do, of which no test machine has one:
/// that takes more of the processor than all else in the browser.
const WITHOUT_GRAPHICS_CARD: [&str; 2] = ["--disable-gpu", "--disable-software-rasterizer"];
/// Has pages believe in a graphics card.
const A_GRAPHICS_CARD: &str = "const real = WebGLRenderingContext.prototype.getExtension;
    WebGLRenderingContext.prototype.getExtension = function (name) {
        return name === 'WEBGL_debug_renderer_info' ? null : real.call(this, name);
    };";

impl Browser {
    /// Starts one with a window of that many pixels.
    ///
    /// # Panics
    ///
    /// `chromedriver` or `chromium` is missing.
    pub fn start(width: u32, height: u32) -> Browser {
        Browser::launch(width, height, &WITHOUT_GRAPHICS_CARD)
    }

    /// The same on a machine with a graphics card, as pages see it; it is computed.
    ///
    /// # Panics
    ///
    /// As [`Browser::start`].
    pub fn with_graphics_card(width: u32, height: u32) -> Browser {
        let browser = Browser::launch(width, height, &[]);
        let script = json!({"source": A_GRAPHICS_CARD});
        browser.dev_tools("Page.addScriptToEvaluateOnNewDocument", script);
        browser
    }

    fn launch(width: u32, height: u32, more: &[&str]) -> Browser {
        let port = free_tcp_port();
        let mut command = Command::new("chromedriver");
        command.arg(format!("--port={port}"));
        let driver = Process::spawn(command);
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap_or_else(|error| panic!("no runtime: {error}"));
        let profile = TempDir::new().unwrap_or_else(|error| panic!("no scratch folder: {error}"));
        let mut arguments = vec![
            "--headless=new".to_owned(),
            "--no-sandbox".to_owned(),
            "--disable-dev-shm-usage".to_owned(),
            "--disable-background-networking".to_owned(),
            "--force-color-profile=srgb".to_owned(),
            "--hide-scrollbars".to_owned(),
            format!("--user-data-dir={}", profile.path().display()),
            format!("--window-size={width},{height}"),
        ];
        arguments.extend(more.iter().map(|own| (*own).to_owned()));
        let capabilities = json!({
            // Charts are drawn in software here, beside other tests.
            "timeouts": {"script": 180_000, "pageLoad": 300_000},
            "goog:loggingPrefs": {"browser": "ALL"},
            "goog:chromeOptions": {"args": arguments},
        });
        let mut capabilities = capabilities;
        if width < 500 {
            // No window is that narrow: a phone's screen is.
            capabilities["goog:chromeOptions"]["mobileEmulation"] =
                json!({"deviceMetrics": {"width": width, "height": height, "pixelRatio": 1.0}});
        }
        let Value::Object(capabilities) = capabilities else {
            unreachable!("an object was written");
        };
        let address = format!("http://127.0.0.1:{port}");
        let client = wait_for(PATIENCE, || {
            let mut builder = ClientBuilder::new(HttpConnector::new());
            builder.capabilities(Capabilities::from_iter(capabilities.clone()));
            runtime.block_on(builder.connect(&address)).ok()
        });
        let client = client.unwrap_or_else(|| {
            panic!(
                "no browser (apt-get install chromium chromium-driver):\n{}",
                driver.stderr()
            )
        });
        Browser {
            runtime,
            client: Some(client),
            _profile: profile,
            driver,
        }
    }

    fn client(&self) -> &Client {
        self.client
            .as_ref()
            .unwrap_or_else(|| unreachable!("it is there until it is dropped"))
    }

    fn wait<T, E: std::fmt::Debug>(
        &self,
        what: &str,
        future: impl Future<Output = Result<T, E>>,
    ) -> T {
        self.runtime
            .block_on(future)
            .unwrap_or_else(|error| panic!("{what}: {error:?}"))
    }

    /// The driver's process, of which the browser's are descendants.
    pub fn process(&self) -> u32 {
        self.driver.id()
    }

    /// Opens an address.
    pub fn open(&self, url: &str) {
        self.wait(url, self.client().goto(url));
    }

    /// The element of that selector, once it is there.
    pub fn find(&self, selector: &str) -> Element {
        let found = wait_for(PATIENCE, || {
            self.runtime
                .block_on(self.client().find(Locator::Css(selector)))
                .ok()
        });
        found.unwrap_or_else(|| panic!("no {selector} on the page:\n{}", self.text("body")))
    }

    /// Clicks on the element of that selector, once that can be done.
    pub fn click(&self, selector: &str) {
        let done = wait_for(PATIENCE, || {
            let element = self.find(selector);
            let enabled = self.runtime.block_on(element.is_enabled()).unwrap_or(false);
            let clicked = enabled && self.runtime.block_on(element.click()).is_ok();
            if !clicked {
                // What sticks to the window's top may lie on it.
                let middle =
                    "document.querySelector(arguments[0])?.scrollIntoView({ block: 'center' })";
                self.run(middle, vec![json!(selector)]);
            }
            clicked.then_some(())
        });
        assert!(
            done.is_some(),
            "cannot click on {selector}:\n{}",
            self.text("body")
        );
    }

    /// Types into the element of that selector.
    pub fn type_into(&self, selector: &str, text: &str) {
        self.wait(selector, self.find(selector).send_keys(text));
    }

    /// What a person reads in the element of that selector.
    pub fn text(&self, selector: &str) -> String {
        self.run(
            "return document.querySelector(arguments[0])?.innerText ?? ''",
            vec![json!(selector)],
        )
        .as_str()
        .unwrap_or_default()
        .to_owned()
    }

    /// What a script returns.
    pub fn run(&self, script: &str, arguments: Vec<Value>) -> Value {
        self.wait(script, self.client().execute(script, arguments))
    }

    /// A number that a script returns; NaN while it returns none.
    pub fn number(&self, script: &str) -> f64 {
        self.run(script, Vec::new()).as_f64().unwrap_or(f64::NAN)
    }

    /// Waits until a script returns `true`.
    pub fn until(&self, what: &str, limit: Duration, script: &str) {
        let seen = wait_for(limit, || {
            (self.run(script, Vec::new()) == true).then_some(())
        });
        assert!(
            seen.is_some(),
            "{what}: not within {limit:?}; the page:\n{}",
            self.text("body")
        );
    }

    /// Presses the pointer in the middle of an element and draws it along
    /// `path`, pixels from the middle, each in `step`. The button stays down.
    pub fn drag(&self, selector: &str, path: &[(f64, f64)], step: Duration) {
        self.drag_with(MOUSE_BUTTON_LEFT, selector, path, step);
    }

    /// The same with the right button.
    pub fn drag_right(&self, selector: &str, path: &[(f64, f64)], step: Duration) {
        self.drag_with(MOUSE_BUTTON_RIGHT, selector, path, step);
    }

    fn drag_with(&self, button: u64, selector: &str, path: &[(f64, f64)], step: Duration) {
        let element = self.find(selector);
        let at = |x: f64, y: f64, duration: Duration| PointerAction::MoveToElement {
            element: element.clone(),
            duration: Some(duration),
            x,
            y,
        };
        let mut mouse = MouseActions::new("mouse".to_owned())
            .then(at(0.0, 0.0, Duration::ZERO))
            .then(PointerAction::Down { button });
        for &(x, y) in path {
            mouse = mouse.then(at(x, y, step));
        }
        self.wait("drag", self.client().perform_actions(mouse));
    }

    /// Lets the pointer go.
    pub fn release(&self) {
        self.wait("release", self.client().release_actions());
    }

    fn dev_tools(&self, command: &'static str, parameters: Value) {
        let done = self.client().issue_cmd(DevTools(command, parameters));
        self.wait(command, done);
    }

    /// Shows the page in another size and theme.
    pub fn show_as(&self, (width, height): (u32, u32), theme: &str) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500});
        self.dev_tools("Emulation.setDeviceMetricsOverride", metrics);
        let features = json!({"features": [{"name": "prefers-color-scheme", "value": theme}]});
        self.dev_tools("Emulation.setEmulatedMedia", features);
        std::thread::sleep(SETTLED);
    }

    /// From now on it is noted which words are drawn where, for [`Browser::misfits`].
    pub fn watch_words(&self) {
        self.run(&format!("{LAYOUT}; watchCanvases()"), Vec::new());
    }

    /// Texts that cannot be read, cut off or on top of each other, in small and large windows, on
    /// a phone, in both themes; each with where that is.
    pub fn misfits(&self) -> Vec<String> {
        let mut found = Vec::new();
        for theme in ["light", "dark"] {
            for size in SIZES {
                self.show_as(size, theme);
                let told = self.run(&format!("{LAYOUT}; return misfits()"), Vec::new());
                let told = told.as_array().cloned().unwrap_or_default();
                let words = told.iter().filter_map(Value::as_str);
                found.extend(words.map(|text| format!("{} px, {theme}: {text}", size.0)));
            }
        }
        found
    }

    /// How many words have been drawn on canvases since [`Browser::watch_words`].
    pub fn words_drawn(&self) -> f64 {
        self.number(
            "return [...window.drawnWords.values()].reduce((sum, own) => sum + own.length, 0)",
        )
    }

    /// Writes what is seen into `file`, as PNG.
    pub fn screenshot(&self, file: &Path) {
        let image = self.wait("screenshot", self.client().screenshot());
        std::fs::write(file, image).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    }

    /// Errors on the browser's console since the last call.
    pub fn complaints(&self) -> Vec<String> {
        let log = self.wait("log", self.client().issue_cmd(ConsoleLog));
        let entries = log.as_array().cloned().unwrap_or_default();
        entries
            .iter()
            .filter(|entry| entry["level"] == "SEVERE")
            .map(|entry| entry["message"].as_str().unwrap_or_default().to_owned())
            .collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if let Some(client) = self.client.take() {
            // What cannot be closed is killed with its driver.
            let _ = self.runtime.block_on(client.close());
        }
    }
}

//! The console in a real browser: a person drives a session with the mouse.

use std::{
    io::{Read, Write},
    net::TcpStream,
    path::PathBuf,
    thread,
    time::Duration,
};

use ferntast_msgs::{
    sample::{OperatingState, RecorderAction},
    topics,
};
use ferntast_tests::{
    Browser, PATIENCE, Process, Session, Stranger, await_armed, free_tcp_port, messages, node,
    rearmed, run, signal, start, state_of_follower, wait_for,
};

/// A session with its console, and where that is.
pub fn session_with_page(session: &Session, more: &[&str]) -> (Process, String) {
    let address = format!("127.0.0.1:{}", free_tcp_port());
    let mut arguments = vec!["--listen", &address];
    arguments.extend(more);
    let mut process = start(session, &arguments);
    process.await_stderr("console: http://", PATIENCE);
    await_armed(session, &mut process);
    (process, address)
}

/// The largest contact force in the chart.
const NORMAL_FORCE: &str =
    "return Number(document.querySelector('#strip-force canvas').dataset.largest)";

/// The status of an HTTP answer, with these headers in the request.
fn status(address: &str, request: &str, headers: &[(&str, &str)]) -> u16 {
    let mut stream = TcpStream::connect(address).expect("the page is served");
    let mut text = format!("{request} HTTP/1.1\r\nConnection: close\r\n");
    for (name, value) in headers {
        text.push_str(&format!("{name}: {value}\r\n"));
    }
    text.push_str("\r\n");
    stream.write_all(text.as_bytes()).expect("a request");
    let mut answer = String::new();
    let mut head = [0; 64];
    let count = stream.read(&mut head).expect("an answer");
    answer.push_str(&String::from_utf8_lossy(&head[..count]));
    let code = answer.split(' ').nth(1).and_then(|code| code.parse().ok());
    code.unwrap_or_else(|| panic!("no status in {answer:?}"))
}

/// Clicks on the banner's button, each time the one that is there, until arm and master are
/// enabled; gives what it said each time.
pub fn led_back(browser: &Browser) -> Vec<String> {
    let mut words = Vec::new();
    let look = "const status = document.querySelector('#status').textContent;
        if (status.includes('arm ENABLED') && status.includes('master ENABLED')) return 'enabled';
        const act = document.querySelector('#act');
        return document.querySelector('#banner').hidden || act.hidden ? '' : act.dataset.word";
    let led = wait_for(PATIENCE, || {
        match browser.run(look, Vec::new()).as_str().unwrap_or_default() {
            "enabled" => return Some(()),
            "" => {}
            word => {
                words.push(word.to_owned());
                browser.run("document.querySelector('#act').click()", Vec::new());
                // As long as a person takes to see what came of it.
                thread::sleep(Duration::from_millis(700));
            }
        }
        None
    });
    assert!(
        led.is_some(),
        "after {words:?} it is not enabled; the page:\n{}",
        browser.text("body")
    );
    words.dedup();
    words
}

/// The page's hand, drawn along a path.
pub struct Stroke<'a> {
    pub browser: &'a Browser,
    pub path: Vec<(f64, f64)>,
}

impl Stroke<'_> {
    pub fn draw(&self) {
        let step = Duration::from_millis(60);
        self.browser.drag("#scene", &self.path, step);
    }

    /// Waits until `look` is true. Where the machine was held up, which pauses the arm or is a
    /// fault, it is armed again, and drawn anew: the page's hand goes to the arm then.
    pub fn until(&self, what: &str, look: &str) {
        let browser = self.browser;
        let seen = wait_for(PATIENCE, || {
            let status = browser.run(
                "return document.querySelector('#status').textContent",
                Vec::new(),
            );
            let status = status.as_str().unwrap_or_default();
            if ["arm PAUSED", "arm FAULT"]
                .iter()
                .any(|state| status.contains(state))
            {
                browser.release();
                led_back(browser);
                self.draw();
            }
            (browser.run(look, Vec::new()) == true).then_some(())
        });
        let page = || browser.text("body");
        assert!(
            seen.is_some(),
            "{what}: not within {PATIENCE:?}; the page:\n{}",
            page()
        );
    }
}

#[test]
fn a_session_is_driven_by_dragging_and_the_stop_stops() {
    let session = Session::alone();
    let (process, address) = session_with_page(&session, &[]);
    let browser = Browser::start(1280, 800);
    browser.open(&format!("http://{address}"));
    browser.until(
        "the arm is drawn",
        PATIENCE,
        "return Number(document.querySelector('#scene').dataset.drawn) > 20",
    );
    browser.click("#operate");
    browser.until(
        "this page operates",
        PATIENCE,
        "return document.querySelector('#operate').textContent.startsWith('Give up')",
    );

    // To the bare edge, 30 mm to the right, and 8 mm into it.
    let scale = browser.number("const c = document.querySelector('#scene'); return Math.min(c.clientWidth, c.clientHeight) / 0.136");
    let path: Vec<(f64, f64)> = (1..=20)
        .map(|step| (f64::from(step) * 0.0019 * scale, 0.0))
        .collect();
    let stroke = Stroke {
        browser: &browser,
        path,
    };
    stroke.draw();
    browser.until(
        "this page's hand holds the authority",
        PATIENCE,
        "return document.querySelector('#holder').textContent === 'this page'",
    );
    stroke.until(
        "the contact is felt",
        "return Number(document.querySelector('#strip-force canvas').dataset.newest) > 5",
    );
    let felt = browser.number(NORMAL_FORCE);
    // A calm stroke has some 50 N; a machine that stalls for 45 ms just then had 205.
    assert!((5.0..400.0).contains(&felt), "{felt} N");
    stroke.until(
        "the bar shows it",
        "return parseFloat(document.querySelector('#force-bar').style.width) > 2",
    );

    // A delay is set and seen.
    browser.run(
        "const s = document.querySelector('#link-delay'); s.value = 200; s.dispatchEvent(new Event('input'))",
        Vec::new(),
    );
    browser.until(
        "the round trip is measured",
        PATIENCE,
        "const d = Number(document.querySelector('#strip-delay canvas').dataset.newest); return d > 190 && d < 215",
    );

    // So is another law.
    browser.run(
        "const s = document.querySelector('#law'); s.value = 'tdpa'; s.dispatchEvent(new Event('change'))",
        Vec::new(),
    );
    let told = wait_for(PATIENCE, || {
        let told = run(&session, &["link", "law", "--session", session.name()]);
        (told.stdout.trim() == "tdpa").then_some(())
    });
    assert!(told.is_some(), "the link keeps its law");

    browser.click("#stop");
    browser.until(
        "the arm is off",
        PATIENCE,
        "return document.querySelector('#status').textContent.includes('DISABLED')",
    );
    assert_eq!(state_of_follower(&session), "DISABLED");
    browser.release();
    browser.click("#arm");
    browser.until(
        "the arm is on again",
        PATIENCE,
        "return document.querySelector('#status').textContent.includes('arm ENABLED')",
    );
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);

    process.interrupt();
    process.wait(PATIENCE).success();
    let states = messages(
        &session.folder().join("run"),
        topics::FOLLOWER_OPERATING_STATE,
    );
    assert!(
        states
            .iter()
            .any(|own| own.message.state == OperatingState::DISABLED)
    );
    let hands = messages(&session.folder().join("run"), topics::LEADER_SETPOINT_CP);
    let farthest = hands
        .iter()
        .map(|own| own.message.position[0])
        .fold(0.0, f64::max);
    assert!((0.028..0.061).contains(&farthest), "{farthest} m");
}

#[test]
fn a_page_that_freezes_does_not_hold_the_arm() {
    let session = Session::alone();
    let (process, address) = session_with_page(&session, &[]);
    let browser = Browser::start(900, 700);
    browser.open(&format!("http://{address}"));
    browser.click("#operate");
    browser.until(
        "this page operates",
        PATIENCE,
        "return document.querySelector('#operate').textContent.startsWith('Give up')",
    );
    browser.drag(
        "#scene",
        &[(5.0, 5.0), (15.0, 10.0)],
        Duration::from_millis(100),
    );
    browser.until(
        "the hand is held",
        PATIENCE,
        "return document.querySelector('#holder').textContent === 'this page'",
    );
    // The tab does not come back for four seconds.
    browser.run(
        "setTimeout(() => { const end = Date.now() + 4000; while (Date.now() < end); }, 0)",
        Vec::new(),
    );
    let paused = wait_for(Duration::from_secs(3), || {
        (state_of_follower(&session) == "PAUSED").then_some(())
    });
    assert!(paused.is_some(), "{}", state_of_follower(&session));
    browser.until(
        "the page says so",
        PATIENCE,
        "return document.querySelector('#why').textContent.includes('stood still')",
    );
    process.interrupt();
    process.wait(PATIENCE).success();
    // What was so before the connection was lost is not shown as if it still were.
    browser.until(
        "only the loss is told",
        PATIENCE,
        "const own = document.querySelector('#status').children; return own.length === 1 && own[0].textContent.includes('no connection')",
    );
}

#[test]
fn the_page_names_strangers_and_a_scenario_that_re_arms_by_itself() {
    let session = Session::alone();
    let (process, address) = session_with_page(&session, &["--scenario", "kontur_2"]);
    let browser = Browser::start(900, 900);
    browser.open(&format!("http://{address}"));
    browser.until(
        "the page says that the arm goes on by itself",
        PATIENCE,
        "return document.querySelector('#rearms')?.textContent.includes('up to 0.5 s')",
    );
    browser.until(
        "nobody is there yet",
        PATIENCE,
        "return !document.querySelector('#told').textContent.includes('stranger')",
    );
    let told = "return document.querySelector('#told')?.textContent.includes('link_follower: stranger on the link') ? 1 : 0";
    // Who has no connection, stranger or page, begins again.
    let seen = (0..4).any(|_| {
        browser.open(&format!("http://{address}"));
        let mut stranger = Stranger::new(session.name(), &session.link_endpoint(), None);
        let named = || {
            // For a tenth of a second: looking at the page takes as long.
            for _ in 0..50 {
                stranger.send(&[0x7f; 60]);
                thread::sleep(Duration::from_millis(2));
            }
            (browser.number(told) == 1.0).then_some(())
        };
        wait_for(PATIENCE / 4, named).is_some()
    });
    assert!(
        seen,
        "the stranger is not named, but told is: {} ({})",
        browser.text("#told"),
        browser.text("#status")
    );
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
}

/// Ends the page's recording.
pub fn end_recording(browser: &Browser) {
    browser.click("#record");
    browser.until(
        "it ended",
        PATIENCE,
        "return document.querySelector('#recording').textContent.startsWith('last:')",
    );
}

/// The recording that a page began.
pub fn recorded_by_a_page(session: &Session) -> PathBuf {
    let folder = std::fs::read_dir(session.folder().join("recordings")).expect("recordings");
    folder.flatten().next().expect("a recording").path()
}

#[test]
fn recordings_are_begun_marked_and_ended_by_the_page() {
    let session = Session::alone();
    let address = format!("127.0.0.1:{}", free_tcp_port());
    let mut process = Process::spawn(session.ferntast_here(&["session", "--listen", &address]));
    await_armed(&session, &mut process);
    let browser = Browser::start(900, 900);
    browser.open(&format!("http://{address}"));
    browser.click("#operate");
    browser.click("#record");
    browser.until("it records", PATIENCE, "return /[1-9][0-9]* messages in recordings/.test(document.querySelector('#recording').textContent)");
    browser.type_into("#mark-label", "second contact");
    browser.click("#mark");
    end_recording(&browser);
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
    let told = messages(&recorded_by_a_page(&session), topics::RECORDER_COMMAND);
    let mark = told
        .iter()
        .find(|own| own.message.action == RecorderAction::MARK);
    assert_eq!(
        mark.map(|own| own.message.label.to_string()),
        Some("second contact".to_owned())
    );
}

#[test]
fn others_are_kept_out() {
    let session = Session::new();
    let (process, address) = session_with_page(&session, &["--token", "0123456789abcdef"]);
    let host = ("Host", address.as_str());
    let files = "GET /api/lab/files";
    assert_eq!(status(&address, "GET /", &[host]), 200);
    assert_eq!(status(&address, files, &[host]), 401);
    assert_eq!(
        status(
            &address,
            files,
            &[host, ("Authorization", "Bearer 0123456789abcdef")]
        ),
        200
    );
    assert_eq!(
        status(
            &address,
            "GET /api/lab/files?token=0123456789abcdef",
            &[host]
        ),
        200
    );
    assert_eq!(status(&address, "GET /", &[("Host", "evil.example")]), 403);
    let upgrade = [
        ("Upgrade", "websocket"),
        ("Connection", "Upgrade"),
        ("Sec-WebSocket-Version", "13"),
        ("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="),
    ];
    let connect = |origin: &str, token: &str| {
        let mut headers = vec![host, ("Origin", origin)];
        headers.extend(upgrade);
        status(
            &address,
            &format!("GET /api/session?token={token}"),
            &headers,
        )
    };
    assert_eq!(connect("http://evil.example", "0123456789abcdef"), 403);
    assert_eq!(connect(&format!("http://{address}"), "wrong"), 401);
    // A console that is killed comes back and the session goes on.
    signal(node(&session, "console"), libc::SIGKILL);
    let back = wait_for(PATIENCE, || TcpStream::connect(&address).ok().map(drop));
    assert!(back.is_some());
    rearmed(&session);
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn beyond_loopback_a_token_is_needed() {
    let session = Session::new();
    for arguments in [
        &["session", "--listen", "0.0.0.0:0"][..],
        &["lab", "serve", "--listen", "0.0.0.0:0"],
        &["lab", "serve", "--listen", "0.0.0.0:0", "--token", "short"],
    ] {
        ferntast_tests::refused(&session, arguments, &["--token"]);
    }
}

/// Where the ends are on two hosts, each page tells what is known on its own, and not that
/// the rest is free, at zero or nobody's.
#[test]
fn a_page_of_one_end_tells_what_is_known_there() {
    let known = |end: &str, link: &str| {
        let session = Session::alone();
        let address = format!("127.0.0.1:{}", free_tcp_port());
        let mut process = start(&session, &["--end", end, "--listen", &address]);
        process.await_stderr("console: http://", PATIENCE);
        let browser = Browser::start(1300, 900);
        browser.open(&format!("http://{address}/"));
        let text = |selector: &str| {
            let script = format!("return document.querySelector('{selector}')?.textContent");
            let told = browser.run(&script, Vec::new());
            told.as_str().unwrap_or_default().to_owned()
        };
        let shown = wait_for(PATIENCE, || text("#status").contains(link).then_some(()));
        assert!(shown.is_some(), "{end}: {}", text("#status"));
        let told = [text("#status"), text("#scene-hint")];
        drop(browser);
        process.interrupt();
        process.wait(PATIENCE);
        told
    };
    // Nobody is at the other end: neither is up.
    let [arm, beside] = known("arm", "link down");
    assert!(arm.contains("arm ") && arm.contains("contact "), "{arm}");
    assert!(!arm.contains("master") && !arm.contains("hand"), "{arm}");
    assert_eq!(beside, "The hand is on the other host.");
    let [operator, beside] = known("operator", "master DISABLED");
    assert!(operator.contains("hand "), "{operator}");
    assert!(!operator.contains("contact"), "{operator}");
    assert!(beside.contains("The arm is on the other host"), "{beside}");
}

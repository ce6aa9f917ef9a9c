//! The console in trouble: whatever stopped the arm, the page leads back, and nothing moves
//! that nobody moves.

use std::{thread, time::Duration};

use ferntast_msgs::{sample::OperatingState, topics};
use ferntast_tests::{
    Browser, PATIENCE, Process, Session, await_armed, free_tcp_port, messages, node, recording,
    signal, wait_for,
};

use crate::console::{end_recording, led_back, recorded_by_a_page, session_with_page};

/// A session with its console, which nothing records and nobody but the page arms again.
fn unrecorded(session: &Session) -> (Process, String) {
    let address = format!("127.0.0.1:{}", free_tcp_port());
    let arguments = ["session", "--no-rearm", "--listen", &address];
    let mut process = Process::spawn(session.ferntast_here(&arguments));
    await_armed(session, &mut process);
    (process, address)
}

/// Waits until the banner says `words`, of what happened or why.
fn told(browser: &Browser, words: &str) {
    let look = format!(
        "return !document.querySelector('#banner').hidden
            && document.querySelector('#banner').textContent.includes({words:?})"
    );
    browser.until(words, PATIENCE, &look);
}

#[test]
fn out_of_every_crash_the_banner_leads_back() {
    let session = Session::alone();
    let (mut process, address) = unrecorded(&session);
    let browser = Browser::start(1280, 800);
    browser.open(&format!("http://{address}"));
    // A machine that stalls makes a fault, or a hold, of its own: each is led out of, too.
    for (victim, what, first, needed) in [
        ("arm", "The arm is in fault", "reset", "arm"),
        ("servo", "The arm is off", "", "arm"),
        ("master", "The master is off", "", "rearm"),
    ] {
        led_back(&browser);
        let before = node(&session, victim);
        signal(before, libc::SIGKILL);
        process.await_stderr(&format!("node {victim} died"), PATIENCE);
        told(&browser, what);
        let words = led_back(&browser);
        println!("{victim}: {words:?}");
        assert!(
            words.iter().any(|word| word == needed),
            "{victim}: {words:?}"
        );
        assert!(words[0].starts_with(first), "{victim}: {words:?}");
    }
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
}

/// What the log of the page says, the newest first.
const LOG: &str = "return document.querySelector('#log').innerText";

#[test]
fn what_happens_is_told_alike_in_the_page_on_diagnostics_in_the_terminal_and_to_who_follows() {
    let session = Session::alone();
    let (mut process, address) = session_with_page(&session, &[]);
    let arguments = ["state", "--follow", "--json", "--session", session.name()];
    let follows = Process::spawn(session.ferntast(&arguments));
    let browser = Browser::start(1280, 900);
    browser.open(&format!("http://{address}"));
    led_back(&browser);
    signal(node(&session, "servo"), libc::SIGKILL);
    let words = [
        "node servo died (signal: 9 (SIGKILL)); it is started again",
        "arm DISABLED: started; send enable",
    ];
    process.await_stderr(words[0], PATIENCE);
    for word in words {
        let look = format!("{LOG}.includes({word:?})");
        browser.until(word, PATIENCE, &look);
        process.await_stderr(word, PATIENCE);
    }
    // The banner says what it was.
    told(&browser, "Node servo died");
    // A page that is opened later knows of it, too.
    browser.open(&format!("http://{address}"));
    browser.until(
        "the log of a new page",
        PATIENCE,
        &format!("{LOG}.includes({:?})", words[0]),
    );
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();

    // Who follows ends with the session.
    let followed = follows.wait(PATIENCE).success().stdout;
    let said = messages(&recording(&session), topics::DIAGNOSTICS);
    for word in words {
        let line = followed.lines().find(|line| line.contains(word));
        let line = line.unwrap_or_else(|| panic!("no {word:?} in {followed}"));
        let event: serde_json::Value = serde_json::from_str(line).expect("one JSON object a line");
        let on_diagnostics = said.iter().find(|own| {
            own.message.node.as_str() == "session" && own.message.message.as_str() == word
        });
        let at = on_diagnostics.expect("on /diagnostics").message.stamp;
        let told = event["time"].as_f64().expect("a time");
        assert!(
            (at.nanos() as f64 * 1e-9 - told).abs() < 1e-3,
            "{at:?} {line}"
        );
    }
}

#[test]
fn a_page_that_is_opened_anew_shows_the_link_as_it_is() {
    let session = Session::alone();
    let (process, address) = unrecorded(&session);
    let first = Browser::start(1280, 900);
    first.open(&format!("http://{address}"));
    let shows = |browser: &Browser, delay: u32, preset: &str, law: &str| {
        let look = format!(
            "const at = (id) => document.querySelector(id);
             return at('#link-delay')?.value === '{delay}' && at('[for=link-delay] + output')?.textContent === '{delay} ms'
                && at('#preset')?.value === {preset:?} && at('#law')?.value === {law:?}"
        );
        browser.until(preset, PATIENCE, &look);
    };
    shows(&first, 20, "rokviss_20ms", "position_force");
    first.click("#operate");
    let choose =
        "const [id, value] = arguments; const s = document.querySelector(id); s.value = value;
        s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change'))";
    let choose = |id: &str, value: &str| {
        first.until(
            "it may be chosen",
            PATIENCE,
            &format!("return !document.querySelector({id:?}).disabled"),
        );
        first.run(choose, vec![id.into(), value.into()]);
    };
    choose("#link-delay", "200");
    choose("#law", "wave");
    // A second page, which only watches.
    let second = Browser::start(900, 900);
    second.open(&format!("http://{address}"));
    shows(&second, 200, "", "wave");
    choose("#preset", "relay_600ms");
    for browser in [&first, &second] {
        shows(browser, 600, "relay_600ms", "wave");
    }
    second.until(
        "so it is measured",
        PATIENCE,
        "const d = Number(document.querySelector('#strip-delay canvas').dataset.newest); return d > 585 && d < 640",
    );
    // The page is no place where it is kept.
    first.open(&format!("http://{address}"));
    shows(&first, 600, "relay_600ms", "wave");
    for browser in [first, second] {
        assert_eq!(browser.complaints(), Vec::<String>::new());
    }
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn who_watches_records_and_marks_and_reads_the_charts() {
    let session = Session::alone();
    let (process, address) = unrecorded(&session);
    let browser = Browser::start(1280, 1000);
    browser.open(&format!("http://{address}"));
    browser.click("#record");
    browser.until("it records", PATIENCE, "return /[1-9][0-9]* messages in recordings/.test(document.querySelector('#recording').textContent)");
    browser.type_into("#mark-label", "seen by a watcher");
    browser.click("#mark");
    browser.until(
        "it is an event",
        PATIENCE,
        &format!("{LOG}.includes('mark: seen by a watcher')"),
    );
    // Where the mark is, charts say so, with values and units.
    let point = "const c = document.querySelector('#strip-force canvas'), b = c.getBoundingClientRect();
        const ages = [...document.querySelectorAll('#log li')].map((li) => li.innerText);
        for (let x = b.right - 31; x > b.left + 40; x -= 2) {
          c.dispatchEvent(new PointerEvent('pointermove', { clientX: x, clientY: b.top + 20, bubbles: true }));
          const tip = document.querySelector('#strip-force .tip');
          if (!tip.hidden && tip.innerText.includes('seen by a watcher')) return tip.innerText;
        }
        return ''";
    let read = wait_for(PATIENCE, || {
        let text = browser.run(point, Vec::new());
        text.as_str()
            .filter(|text| !text.is_empty())
            .map(str::to_owned)
    });
    let read = read.unwrap_or_else(|| panic!("no mark in the charts:\n{}", browser.text("body")));
    let number = |name: &str| {
        let line = read
            .lines()
            .find_map(|line| line.strip_prefix(name)?.trim().strip_suffix(" N"));
        line.map(|value| value.parse::<f64>().is_ok() || value == "–")
    };
    assert_eq!(
        (number("contact"), number("hand")),
        (Some(true), Some(true)),
        "{read}"
    );
    // Paused charts stand still, and go on.
    let drawn = || {
        browser.run(
            "return document.querySelector('#strip-delay canvas').toDataURL()",
            Vec::new(),
        )
    };
    browser.click("#pause");
    let still = drawn();
    thread::sleep(Duration::from_secs(1));
    assert_eq!(drawn(), still);
    browser.click("#pause");
    assert!(wait_for(PATIENCE, || (drawn() != still).then_some(())).is_some());
    end_recording(&browser);
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    let ended = process.wait(PATIENCE).success();
    assert!(ended.stdout.contains("recorded  "), "{}", ended.stdout);
    assert!(!ended.stdout.contains("not recorded"), "{}", ended.stdout);
    let marks = messages(&recorded_by_a_page(&session), topics::RECORDER_COMMAND);
    assert!(
        marks
            .iter()
            .any(|own| own.message.label.as_str() == "seen by a watcher")
    );
}

/// Draws the page's hand by so many pixels to the right.
fn draw(browser: &Browser, pixels: f64) {
    let path: Vec<(f64, f64)> = (1..=10)
        .map(|step| (f64::from(step) * 0.1 * pixels, 0.0))
        .collect();
    browser.drag("#scene", &path, Duration::from_millis(60));
}

#[test]
fn who_releases_the_mouse_lets_go_whatever_the_arm_does() {
    let session = Session::alone();
    let (process, address) = session_with_page(&session, &[]);
    let browser = Browser::start(1280, 800);
    browser.open(&format!("http://{address}"));
    browser.click("#operate");
    let holds = "return document.querySelector('#holder').textContent === 'this page'";
    let scale = browser.number("const c = document.querySelector('#scene'); return Math.min(c.clientWidth, c.clientHeight) / 0.136");
    // While it follows, the arm holds when the hand lets go; it begins anew where it stands.
    let why = "return document.querySelector('#why').textContent.includes('let go')";
    let let_go = wait_for(PATIENCE, || {
        led_back(&browser);
        draw(&browser, 0.005 * scale);
        let taken = browser.run(holds, Vec::new()) == true;
        browser.release();
        let told = || (browser.run(why, Vec::new()) == true).then_some(());
        taken.then(|| wait_for(Duration::from_secs(3), told))?
    });
    assert!(let_go.is_some(), "{}", browser.text("body"));
    browser.click("#stop");
    told(&browser, "off");
    // Far behind the wall, which is 30 mm away, and let go there.
    draw(&browser, 0.060 * scale);
    told(&browser, " mm apart");
    browser.release();
    told(&browser, "The hand begins where the tip is");
    let words = led_back(&browser);
    assert!(words.iter().any(|word| word == "arm"), "{words:?}");
    thread::sleep(Duration::from_secs(3));
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();

    let states = messages(&recording(&session), topics::FOLLOWER_OPERATING_STATE);
    let off = states
        .iter()
        .rposition(|own| own.message.state == OperatingState::DISABLED);
    let armed = states[off.expect("it was off") + 1..].iter();
    let armed = armed
        .map(|own| own.message)
        .find(|own| own.state == OperatingState::ENABLED)
        .expect("it was armed");
    let tips = messages(&recording(&session), topics::FOLLOWER_MEASURED_CP);
    let mut after = tips
        .iter()
        .map(|own| own.message)
        .filter(|own| own.stamp >= armed.stamp)
        .map(|own| own.position);
    let begun = after.next().expect("a tip");
    let farthest = after
        .map(|[x, y, _]| (x - begun[0]).hypot(y - begun[1]))
        .fold(0.0, f64::max);
    assert!(
        farthest < 0.003,
        "nobody moved it, and it went {farthest} m"
    );
}

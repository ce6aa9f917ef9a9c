//! A gamepad in front of the page, which the browser is told of: it moves the hand while its trigger
//! is held, and lets go where that is released, the pad is unplugged, or its button stops.

use std::{
    thread,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use ferntast_msgs::{Time, topics};
use ferntast_tests::{
    Browser, PATIENCE, Session, messages, recording, state_of_follower, wait_for, wait_until,
};

use crate::console::{led_back, session_with_page};

/// A pad as browsers tell of one, in the second place, and what it was made to rumble.
const PAD: &str = "const button = () => ({ pressed: false, touched: false, value: 0 });
    window.rumbled = { count: 0, strongest: 0 };
    const playEffect = (kind, { strongMagnitude }) => {
        window.rumbled = { count: window.rumbled.count + 1, strongest: Math.max(window.rumbled.strongest, strongMagnitude) };
    };
    window.pad = { index: 1, id: 'a stub', connected: true, mapping: 'standard', timestamp: 0, axes: [0, 0, 0, 0],
        buttons: Array.from({ length: 17 }, button), vibrationActuator: { playEffect } };
    navigator.getGamepads = () => [null, window.pad];";
/// Where the page wants the hand \[m\]; `null` where it does not hold it.
const WANTED: &str = "return import('/console/hand.js').then((hand) => hand.wanted())";
/// Begins a look at that place, `own`, where it holds it.
const WANTED_AT: &str = "return import('/console/hand.js').then((hand) => {
    const own = hand.wanted();
    return own !== null && ";
const HOLDS: &str = "return document.querySelector('#scene').dataset.pad === '1'";
const LETS_GO: &str = "return document.querySelector('#scene').dataset.pad === ''
        && document.querySelector('#holder').textContent !== 'this page'";

struct Pad<'a>(&'a Browser);

impl Pad<'_> {
    fn trigger(&self, value: f64) {
        let pull = "window.pad.buttons[7].value = arguments[0];";
        self.0.run(pull, vec![value.into()]);
    }

    fn stick(&self, axis: usize, value: f64) {
        let push = "window.pad.axes[arguments[0]] = arguments[1];";
        self.0.run(push, vec![axis.into(), value.into()]);
    }

    fn wanted(&self) -> Option<Vec<f64>> {
        let told = self.0.run(WANTED, Vec::new());
        let all = told.as_array()?;
        Some(all.iter().filter_map(serde_json::Value::as_f64).collect())
    }

    /// Takes the hand, out of whatever a machine that stalls made of the session.
    fn takes(&self) {
        let held = wait_for(PATIENCE, || {
            if state_is_off(self.0) {
                self.trigger(0.0);
                led_back(self.0);
            }
            self.trigger(0.0);
            thread::sleep(Duration::from_millis(150));
            self.trigger(1.0);
            thread::sleep(Duration::from_millis(300));
            (self.0.run(HOLDS, Vec::new()) == true).then_some(())
        });
        assert!(
            held.is_some(),
            "the pad does not hold the hand: {}",
            self.0.text("body")
        );
    }

    /// Waits until `look` is true, with the hand held.
    fn until(&self, what: &str, look: &str) {
        let seen = wait_for(PATIENCE, || {
            if state_is_off(self.0) || self.0.run(HOLDS, Vec::new()) != true {
                self.takes();
            }
            (self.0.run(look, Vec::new()) == true).then_some(())
        });
        assert!(
            seen.is_some(),
            "{what}: not within {PATIENCE:?}: {}",
            self.0.text("body")
        );
    }
}

fn state_is_off(browser: &Browser) -> bool {
    let look = "const told = document.querySelector('#status').textContent;
        return told.includes('arm PAUSED') || told.includes('arm FAULT') || told.includes('arm DISABLED')";
    browser.run(look, Vec::new()) == true
}

#[test]
fn a_gamepad_drives_rumbles_and_lets_go() {
    let session = Session::alone();
    let (process, address) = session_with_page(&session, &[]);
    let browser = Browser::start(1280, 800);
    browser.open(&format!("http://{address}"));
    browser.run(PAD, Vec::new());
    let pad = Pad(&browser);
    browser.until(
        "the arm is drawn",
        PATIENCE,
        "return Number(document.querySelector('#scene').dataset.drawn) > 20",
    );

    // Who only watches moves nothing, and is told so.
    pad.trigger(1.0);
    browser.until(
        "it is refused",
        PATIENCE,
        "return document.querySelector('#toast').textContent.includes('Take the controls first')",
    );
    assert_eq!(pad.wanted(), None);
    browser.click("#operate");
    browser.until(
        "this page operates",
        PATIENCE,
        "return document.querySelector('#operate').textContent.startsWith('Give up')",
    );
    // A trigger that was pulled before takes nothing: it has to be pulled anew.
    thread::sleep(Duration::from_millis(300));
    assert_eq!(pad.wanted(), None);
    pad.takes();
    browser.until(
        "this page's hand holds the authority",
        PATIENCE,
        "return document.querySelector('#holder').textContent === 'this page'",
    );

    let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH);
    let nanos = since_epoch.expect("a time after 1970").as_nanos();
    let taken = Time::from_nanos(i64::try_from(nanos).expect("a time of this century"));

    // The session's own hand may have been anywhere, also at the end of its reach.
    pad.stick(0, -1.0);
    pad.until(
        "it goes to the left",
        &format!("{WANTED_AT} own[0] < 0; }})"),
    );
    pad.stick(0, 0.0);
    thread::sleep(Duration::from_millis(300));

    // A stick that does not quite come back is one in the middle.
    pad.stick(0, 0.12);
    pad.stick(3, -0.1);
    let before = pad.wanted().expect("it holds the hand");
    thread::sleep(Duration::from_millis(400));
    assert_eq!(pad.wanted(), Some(before.clone()));

    // To the bare edge at the right, and into it.
    pad.stick(0, 1.0);
    // In one look: a hand that was let go of is taken again from where it is then.
    let right_of = before[0] + 0.015;
    pad.until(
        "the contact is felt, to the right",
        &format!(
            "{WANTED_AT} own[0] > {right_of} && own[2] === 0
                && Number(document.querySelector('#strip-force canvas').dataset.newest) > 5; }})"
        ),
    );
    pad.until(
        "it rumbles",
        "return window.rumbled.count > 2 && window.rumbled.strongest > 0.02",
    );
    pad.stick(0, 0.0);

    pad.takes();
    pad.trigger(0.0);
    browser.until("who releases the trigger lets go", PATIENCE, LETS_GO);
    let paused = wait_until(PATIENCE, || state_of_follower(&session) == "PAUSED");
    assert!(paused, "{}", state_of_follower(&session));

    led_back(&browser);
    pad.takes();
    browser.run("window.kept = window.pad; window.pad = null", Vec::new());
    browser.until("unplugged, it lets go", PATIENCE, LETS_GO);

    browser.run("window.pad = window.kept", Vec::new());
    pad.takes();
    browser.run("window.pad.buttons[1].pressed = true", Vec::new());
    let off = wait_until(PATIENCE, || state_of_follower(&session) == "DISABLED");
    assert!(off, "{}", state_of_follower(&session));
    assert_eq!(pad.wanted(), None);
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();

    // The stick's speed, and the hand's spring, which runs no faster.
    let poses = messages(&recording(&session), topics::LEADER_MEASURED_CP);
    let own: Vec<_> = poses
        .iter()
        .map(|own| own.message)
        .filter(|own| own.stamp > taken)
        .collect();
    assert!(own.len() > 100, "{}", own.len());
    let mut fastest = 0.0_f64;
    for (place, now) in own.iter().enumerate() {
        let past = own[place..]
            .iter()
            .find(|later| later.stamp.seconds_since(now.stamp) >= 0.1);
        let Some(later) = past.filter(|later| later.stamp.seconds_since(now.stamp) < 0.13) else {
            continue;
        };
        let way: f64 = (0..3)
            .map(|axis| (later.position[axis] - now.position[axis]).powi(2))
            .sum();
        fastest = fastest.max(way.sqrt() / later.stamp.seconds_since(now.stamp));
    }
    println!("fastest {fastest:.4} m/s");
    assert!((0.02..0.08).contains(&fastest), "{fastest} m/s");
}

//! The console draws an arm in space, and a pointer moves its hand in the plane of the view.

use std::time::Duration;

use ferntast_tests::{Browser, PATIENCE, Session};
use serde_json::Value;

use super::console::{Stroke, session_with_page};

const STEP: Duration = Duration::from_millis(40);

/// Three numbers of the picture's data; NaN where they are not there.
fn data(browser: &Browser, key: &str) -> [f64; 3] {
    let script = format!(
        "return (document.querySelector('#scene').dataset.{key} || '').split(' ').map(Number)"
    );
    triple(&browser.run(&script, Vec::new()))
}

/// Three numbers of the newest snapshot.
fn snapshot(browser: &Browser, key: &str) -> [f64; 3] {
    let script =
        format!("return import('/console/connection.js').then((own) => own.session.now.{key})");
    triple(&browser.run(&script, Vec::new()))
}

fn triple(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|axis| value[axis].as_f64().unwrap_or(f64::NAN))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3)
        .map(|axis| (a[axis] - b[axis]).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// How far the tip by the page's kinematics is from where the servo's has it, of one snapshot \[m\].
fn off(browser: &Browser) -> f64 {
    let both = "const own = document.querySelector('#scene').dataset;
        return [own.tip, own.measured].map((text) => (text || '').split(' ').map(Number))";
    let both = browser.run(both, Vec::new());
    distance(triple(&both[0]), triple(&both[1]))
}

/// Shows a view.
fn choose(browser: &Browser, view: &str) {
    browser.click(&format!("#views [data-view='{view}']"));
    browser.until(
        view,
        PATIENCE,
        &format!("return document.querySelector('#scene').dataset.view === '{view}'"),
    );
}

/// The share of the picture's pixels that have the blue of a joint's housing.
const HOUSINGS: &str = "const c = document.querySelector('#scene');
    const { data } = c.getContext('2d').getImageData(0, 0, c.width, c.height);
    let blue = 0;
    for (let n = 0; n < data.length; n += 4) if (data[n + 3] > 200 && data[n + 2] - data[n] > 40) blue += 4;
    return blue / data.length";

#[test]
fn an_arm_of_seven_joints_is_seen_and_its_hand_drawn_in_the_plane_of_the_view() {
    let session = Session::alone();
    let (process, address) = session_with_page(&session, &["--arm", "panda"]);
    let browser = Browser::start(1280, 800);
    browser.open(&format!("http://{address}"));
    browser.until(
        "the arm is drawn",
        PATIENCE,
        "const own = document.querySelector('#scene').dataset; return own.view === 'orbit' && Number(own.faces) > 300",
    );
    let links = browser.number("return Number(document.querySelector('#scene').dataset.links)");
    assert!(links >= 12.0, "{links} parts of links");
    let things = browser.number("return Number(document.querySelector('#scene').dataset.things)");
    assert!(things >= 1.0, "the table");
    let blue = browser.number(HOUSINGS);
    assert!((0.005..0.5).contains(&blue), "{blue} of the picture");
    // The page's kinematics are the servo's.
    let apart = off(&browser);
    assert!(
        apart < 0.002,
        "{apart} m between the tip drawn and that measured"
    );

    // Each view is another picture; the right button turns on from any of them.
    let mut pictures = Vec::new();
    for view in ["orbit", "top", "side", "tool"] {
        choose(&browser, view);
        pictures.push(browser.run(
            "return document.querySelector('#scene').toDataURL()",
            Vec::new(),
        ));
    }
    pictures.sort_by_key(Value::to_string);
    pictures.dedup();
    assert_eq!(pictures.len(), 4);
    choose(&browser, "top");
    browser.drag_right("#scene", &[(20.0, 10.0), (60.0, 40.0)], STEP);
    browser.release();
    browser.until(
        "the view is turned",
        PATIENCE,
        "return document.querySelector('#scene').dataset.view === 'orbit'",
    );
    assert_eq!(
        browser.text("#holder"),
        "the script",
        "turning moves no hand"
    );

    browser.click("#operate");
    browser.until(
        "this page operates",
        PATIENCE,
        "return document.querySelector('#operate').textContent.startsWith('Give up')",
    );
    // Seen from the side, up is z: 20 mm away from the table, and 10 mm to the right, which is x.
    choose(&browser, "side");
    let scale = browser.number("return Number(document.querySelector('#scene').dataset.scale)");
    let path = (1..=10).map(|step| {
        let share = 0.1 * f64::from(step);
        (share * 0.010 * scale, -share * 0.020 * scale)
    });
    let stroke = Stroke {
        browser: &browser,
        path: path.collect(),
    };
    stroke.draw();
    let lifted = "return import('/console/connection.js').then(({ session: { now } }) =>
        document.querySelector('#holder').textContent === 'this page' && now.seat.target && now.hand
        && Math.hypot(...now.hand.map((value, axis) => value - now.seat.target[axis])) < 0.002
        && Math.hypot(...now.wanted.map((value, axis) => value - now.tip[axis])) < 0.003)";
    stroke.until("hand and tip are where the pointer is", lifted);
    let (grip, target) = (data(&browser, "grip"), snapshot(&browser, "seat.target"));
    let way = [0, 1, 2].map(|axis| target[axis] - grip[axis]);
    assert!(distance(way, [0.010, 0.0, 0.020]) < 0.001, "{way:?}");
    // Let go, the hand is nobody's.
    browser.release();
    browser.until(
        "it is let go",
        PATIENCE,
        "return import('/console/connection.js').then((own) => own.session.now.seat.target === null)",
    );

    // The arm as the operator sees it is drawn beside the truth, when asked for.
    assert!(data(&browser, "ghost")[2].is_nan());
    browser.click("#delayed");
    browser.until(
        "the delayed image is there",
        PATIENCE,
        "return document.querySelector('#scene').dataset.ghost !== ''",
    );
    assert!(distance(data(&browser, "ghost"), data(&browser, "tip")) < 0.2);
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn a_planar_arm_is_seen_at_its_contour_first_and_in_space_when_asked_for() {
    let session = Session::alone();
    let (process, address) = session_with_page(&session, &[]);
    let browser = Browser::start(1280, 800);
    browser.open(&format!("http://{address}"));
    browser.until(
        "the contour is drawn",
        PATIENCE,
        "return document.querySelector('#scene').dataset.view === 'contour'",
    );
    choose(&browser, "orbit");
    let things = browser.number("return Number(document.querySelector('#scene').dataset.things)");
    assert!(
        (things - 4.0).abs() < 0.5,
        "two edges and two springs: {things}"
    );
    let apart = off(&browser);
    assert!(
        apart < 0.002,
        "{apart} m between the tip drawn and that measured"
    );
    choose(&browser, "contour");
    assert_eq!(browser.complaints(), Vec::<String>::new());
    drop(browser);
    process.interrupt();
    process.wait(PATIENCE).success();
}

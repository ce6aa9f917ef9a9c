//! Runs a row on two hosts, and has it judged.

use std::{
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use ferntast_tests::{Host, Machine, Pair, PairOptions, Session, hand_through, now, wait_until};

use super::{
    contact::forces,
    fault::{CLOCK_FILE, write_clock},
    judge::{Judged, Outcome, Repetition},
    recorded::Recorded,
    rows::{Clock, Row},
};

/// The scenario of every row.
pub const SCENARIO: &str = "rokviss";
/// The arm presses with more than this \[N\].
const PRESSES: f64 = 8.0;
/// From arming to the fault: at least so long, and spread over so much more \[ms\].
const SHORTEST: u64 = 150;
const SPREAD: u64 = 200;
/// A stroke of the hand, and some more.
const STROKE: Duration = Duration::from_secs(8);
/// So often it is tried to have it armed and pressing.
const TRIES: usize = 10;
/// After the fault is over, until somebody arms again.
const SETTLES: Duration = Duration::from_millis(60);
/// The library that gives programs another clock.
const OTHER_CLOCK: &str = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";

/// The hand reaches an edge, presses, slides there and back, lets go, again and again.
pub fn sliding_hand(session: &Session) -> String {
    let stroke = [
        (0.0, 0.0, -0.024),
        (0.6, 0.0, -0.034),
        (2.0, -0.020, -0.034),
        (3.6, 0.010, -0.034),
        (4.4, 0.010, -0.024),
        (5.4, 0.0, -0.024),
    ];
    let mut points = vec![(0.0, 0.0, 0.0)];
    for number in 0..200 {
        let begin = 1.0 + 5.6 * f64::from(number);
        points.extend(stroke.map(|(t, x, y)| (begin + t, x, y)));
    }
    hand_through(session, "sliding.csv", &points)
}

/// The hand presses on an edge and stays.
pub fn pressing_hand(session: &Session) -> String {
    let points = [
        (0.0, 0.0, 0.0),
        (1.5, 0.0, -0.027),
        (2.5, 0.0, -0.034),
        (900.0, 0.0, -0.034),
    ];
    hand_through(session, "pressing.csv", &points)
}

/// Where the tests have the deputy.
pub fn deputy() -> PathBuf {
    PathBuf::from(env!("CARGO_BIN_EXE_deputy"))
}

/// A session under `law`, with the hand of that file.
pub fn options(law: &str, hand: String) -> PairOptions {
    PairOptions {
        law: law.to_owned(),
        hand,
        round_trip_ms: 0.0,
        deputy: deputy(),
        operator_environment: Vec::new(),
    }
}

/// The environment that gives a host another clock: the wall clock and the monotonic one
/// alike, since a session reads the former once and then goes by the latter.
fn environment(clock: Clock, session: &Session) -> Vec<(String, String)> {
    let file = session.folder().join(CLOCK_FILE);
    let own: &[(&str, String)] = match clock {
        Clock::Right => return Vec::new(),
        Clock::Ahead(seconds) => &[("FAKETIME", format!("{seconds:+}"))],
        Clock::Fast(millionths) => &[("FAKETIME", format!("+0 x{:.6}", 1.0 + millionths * 1e-6))],
        Clock::Jumps => {
            write_clock(&file, 0.0);
            &[
                ("FAKETIME_TIMESTAMP_FILE", file.display().to_string()),
                ("FAKETIME_CACHE_DURATION", "1".to_owned()),
            ]
        }
    };
    assert!(
        Path::new(OTHER_CLOCK).is_file(),
        "no {OTHER_CLOCK}: 'apt-get install faketime' fixes that"
    );
    let mut all = vec![("LD_PRELOAD".to_owned(), OTHER_CLOCK.to_owned())];
    all.extend(
        own.iter()
            .map(|(name, value)| ((*name).to_owned(), value.clone())),
    );
    all
}

/// Numbers that look random, the same in every run.
struct Shuffle(u64);

impl Shuffle {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) % most
    }
}

/// Armed, moving, and pressing where that is asked for.
fn set_up(pair: &mut Pair, row: &Row, shuffle: &mut Shuffle) {
    for _ in 0..TRIES {
        pair.ready();
        let wait = SHORTEST + shuffle.below(SPREAD);
        thread::sleep(Duration::from_millis(wait));
        let presses = || pair.look(Host::Arm).force > PRESSES;
        if row.pressing && !wait_until(STROKE, presses) {
            continue;
        }
        if pair.is_ready() {
            return;
        }
    }
    panic!("the arm does not stay armed, or does not press");
}

fn repeat(pair: &mut Pair, row: &Row, law: &'static str, shuffle: &mut Shuffle) -> Repetition {
    set_up(pair, row, shuffle);
    let before = now();
    let lasting = row.fault.begin(pair);
    thread::sleep(row.lasts);
    row.fault.end(pair, lasting);
    thread::sleep(SETTLES);
    Repetition {
        law,
        before,
        end: now(),
    }
}

/// Runs `row`; the arm may press with `most_force` \[N\] at most.
pub fn run(row: &Row, most_force: f64) -> Outcome {
    let machine = Machine::alone();
    let session = Session::new();
    let options = PairOptions {
        operator_environment: environment(row.clock, &session),
        ..options(row.laws[0], sliding_hand(&session))
    };
    let mut pair = Pair::start(session, options);
    let mut shuffle = Shuffle(7);
    let mut repetitions = Vec::new();
    for law in row.laws {
        pair.ready();
        pair.rule(law);
        // It is led over.
        thread::sleep(Duration::from_millis(500));
        for _ in 0..row.times {
            repetitions.push(repeat(&mut pair, row, law, &mut shuffle));
        }
    }
    pair.ready();
    let (restarts, words) = (pair.restarts(), pair.words.clone());
    let (_session, [operator, arm]) = pair.finish();
    let ahead = match row.clock {
        Clock::Ahead(seconds) => seconds,
        _ => 0.0,
    };
    let recorded = Recorded::read(&operator, &arm, ahead);
    let forces = forces(&recorded.measured);
    let judged = Judged {
        row,
        machine: &machine,
        recorded: &recorded,
        words: &words,
        repetitions: &repetitions,
        forces: &forces,
        most_force,
    };
    let mut outcome = judged.outcome();
    outcome.restarts = restarts;
    if row.clock != Clock::Right {
        remark_clock(&recorded, &mut outcome);
    }
    outcome
}

/// How far the operator's clock was said to be ahead.
fn remark_clock(recorded: &Recorded, outcome: &mut Outcome) {
    let offsets = recorded.clock_offsets.iter().map(|own| own.1);
    let (least, most) = offsets
        .filter(|own| own.is_finite() && *own != 0.0)
        .fold((f64::MAX, f64::MIN), |(least, most), own| {
            (least.min(own), most.max(own))
        });
    if least > most {
        outcome.fail("nothing was said of the operator's clock".to_owned());
        return;
    }
    outcome.remarks.push(format!(
        "clock said to be off by {least:+.4} to {most:+.4} s"
    ));
}

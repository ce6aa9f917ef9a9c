//! Recordings of one motion, each with what real ones have in them: what comes out is what the
//! clean one gives.

#![allow(clippy::unwrap_used)]

use std::{f64::consts::PI, fmt::Write as _, fs, ops::Range};

use ferntast_identification::Verdict;
use ferntast_lab::work::{Opened, open_file};

const PERIOD: f64 = 0.005;
const ROWS: usize = 16_000;
const B0: f64 = 6.0;
const B1: f64 = 12.0;

/// A row of a recording.
#[derive(Clone, Copy)]
struct Row {
    time: f64,
    q: f64,
    torque: f64,
    load: f64,
}

/// Numbers with mean 0 and deviation 1, nearly normal.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Coulomb and viscous friction, an inertia of 1.2 kg m² and a spring behind the sensor;
/// positions go from `wide` −1 to 1.
fn clean(wide: f64) -> Vec<Row> {
    let mut noise = Noise(7);
    let rows = (0..ROWS).map(|at| {
        let time = at as f64 * PERIOD;
        let (mut q, mut qd, mut qdd) = (0.0, 0.0, 0.0);
        for (amplitude, rate) in [(0.6, 0.37), (0.3, 1.13), (0.1, 3.3)] {
            let (sine, cosine) = (rate * time).sin_cos();
            q += wide * amplitude * sine;
            qd += wide * amplitude * rate * cosine;
            qdd -= wide * amplitude * rate * rate * sine;
        }
        let load = 15.0 * f64::max(q, 0.0) + 3.0 * (0.9 * time).sin();
        Row {
            time,
            q: q + 5e-6 * noise.normal(),
            torque: 1.2 * qdd + load + B0 * qd.signum() + B1 * qd + 0.1 * noise.normal(),
            load: load + 0.02 * noise.normal(),
        }
    });
    rows.collect()
}

/// What the lab makes of `rows`, read as they are or not, and what it says of the reading.
fn opened(rows: &[Row], as_recorded: bool) -> Opened {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("time,q,torque,load\n");
    for Row {
        time,
        q,
        torque,
        load,
    } in rows
    {
        writeln!(text, "{time:.7},{q:.9},{torque:.6},{load:.6}").unwrap();
    }
    fs::write(folder.path().join("run.csv"), text).unwrap();
    let readings = match as_recorded {
        true => "readings = \"as_recorded\"\n",
        false => "",
    };
    let experiment = format!(
        "recording = \"run.csv\"\n{readings}[signals]\nposition = \"q\"\nmotor_torque = \"torque\"\njoint_torque = \"load\"\n\
         [model]\ninertia = 1.2\neffects = [\"coulomb\", \"viscous\"]\n"
    );
    let path = folder.path().join("e.toml");
    fs::write(&path, experiment).unwrap();
    open_file(&path).unwrap()
}

/// Error on data held out, share of the samples used, and the error of each parameter.
fn fitted(opened: &Opened) -> (f64, f64, [f64; 2]) {
    let told = opened.compare().unwrap();
    let off = |name: &str, truth: f64| (told.parameters[name].value - truth).abs();
    (
        told.rms.held_out,
        told.used.share,
        [off("b0", B0), off("b1", B1)],
    )
}

/// Puts a wrong reading into `rows`, and says what is told of it.
fn check(what: &str, told: &[&str], spoilt: &[Row], limits: [f64; 2]) {
    let (error, share, _) = fitted(&opened(&clean(1.0), false));
    let kept = fitted(&opened(spoilt, true));
    let opened = opened(spoilt, false);
    assert_eq!(
        opened.notes.len(),
        told.len(),
        "{what}: {:#?}",
        opened.notes
    );
    for (note, told) in opened.notes.iter().zip(told) {
        assert!(note.contains(told), "{what}: {note}");
    }
    let mended = fitted(&opened);
    let [worse, least_share] = limits;
    assert!(
        kept.0 > worse * error || kept.1 < 0.8 * share,
        "{what}, as recorded: {kept:?} for {error}"
    );
    assert!(
        mended.0 < 1.1 * error && mended.0 > 0.9 * error,
        "{what}: {mended:?} for {error}"
    );
    assert!(
        mended.1 > least_share * share,
        "{what}: {mended:?} for {share}"
    );
    assert!(
        mended.2[0] < 0.03 && mended.2[1] < 0.06,
        "{what}: {mended:?}"
    );
    let diagnosis = opened.diagnose(&mut |_| ()).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::Complete, "{what}");
}

#[test]
fn a_clean_recording_is_read_as_it_is() {
    let rows = clean(1.0);
    let (left, kept) = (opened(&rows, false), opened(&rows, true));
    assert!(left.notes.is_empty(), "{:?}", left.notes);
    assert_eq!(left.dataset, kept.dataset);
}

#[test]
fn torques_that_jump_and_positions_that_read_zero_are_left_out() {
    let mut rows = clean(1.0);
    for at in (500..ROWS).step_by(900) {
        rows[at].torque += if at % 200 == 0 { 50.0 } else { -50.0 };
    }
    check(
        "spikes",
        &["signals.motor_torque jumps away and back 18 times"],
        &rows,
        [3.0, 0.98],
    );
    let mut rows = clean(1.0);
    let mut count = 0;
    let apart = rows.iter_mut().step_by(2100);
    for row in apart.filter(|row| row.q.abs() > 0.05) {
        row.q = 0.0;
        count += 1;
    }
    let told = format!("signals.position jumps away and back {count} times");
    check("zeros", &[&told], &rows, [3.0, 0.98]);
}

#[test]
fn rows_that_were_logged_twice_count_once() {
    let rows = clean(1.0);
    let mut twice = rows.clone();
    for at in (50..ROWS).step_by(50).rev() {
        twice.insert(at, twice[at]);
    }
    let (once, twice) = (opened(&rows, false), opened(&twice, false));
    assert_eq!(once.dataset, twice.dataset);
    let [tally] = twice.tallies.as_slice() else {
        panic!("{:?}", twice.tallies);
    };
    assert_eq!((tally.samples, tally.repeated_time), (ROWS + 319, 319));
    assert_eq!(twice.notes.len(), 3, "{:#?}", twice.notes);
}

/// Repeats the row before `run` all along it.
fn stale(rows: &mut [Row], run: Range<usize>, what: fn(&mut Row, &Row)) {
    let last = rows[run.start - 1];
    rows[run].iter_mut().for_each(|row| what(row, &last));
}

#[test]
fn what_is_sent_again_is_left_out() {
    let mut rows = clean(1.0);
    for at in [700, 3100, 5200, 9000, 14_000] {
        stale(&mut rows, at..at + 60, |row, last| {
            *row = Row {
                time: row.time,
                ..*last
            };
        });
    }
    let told = "signals.position stands still while the joint moves, 5 times";
    check("stale rows", &[told], &rows, [1.3, 0.95]);
    let mut rows = clean(1.0);
    for at in [700, 3100, 9100] {
        stale(&mut rows, at..at + 200, |row, last| {
            row.torque = last.torque
        });
    }
    let told = "signals.motor_torque stands still while the joint moves, 3 times";
    check("stale torque", &[told], &rows, [3.0, 0.9]);
}

#[test]
fn times_of_arrival_are_set_right() {
    let mut noise = Noise(3);
    let mut rows = clean(1.0);
    for row in &mut rows {
        row.time += 0.7 * PERIOD * (noise.uniform() - 0.5);
    }
    check(
        "arrival",
        &["about a clock of 5.000 ms"],
        &rows,
        [1.3, 0.98],
    );
}

#[test]
fn times_of_too_few_digits_are_set_right() {
    let mut rows = clean(1.0);
    for row in &mut rows {
        row.time = (row.time * 100.0).round() / 100.0;
    }
    let told = "about a clock of 5.000 ms";
    check("digits", &[told], &rows, [1.3, 0.98]);
}

#[test]
fn a_torque_that_is_held_is_read_where_it_is_measured() {
    let mut rows = clean(1.0);
    for at in 0..ROWS {
        rows[at].torque = rows[at / 4 * 4].torque;
    }
    // Every fourth measurement has twice the noise after the filter.
    let opened = opened(&rows, false);
    assert_eq!(opened.notes.len(), 1, "{:?}", opened.notes);
    assert!(opened.notes[0].contains("a new value with every 4th sample only"));
    let diagnosis = opened.diagnose(&mut |_| ()).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::Complete);
}

#[test]
fn a_position_that_begins_anew_with_each_turn_is_counted_on() {
    let whole = clean(5.0);
    let mut turned = whole.clone();
    for row in &mut turned {
        row.q = (row.q + PI).rem_euclid(2.0 * PI) - PI;
    }
    let (whole, turned) = (opened(&whole, false), opened(&turned, false));
    assert!(
        turned.notes[0].contains("jumps by a turn"),
        "{:?}",
        turned.notes
    );
    let both = whole.dataset.sessions.iter().zip(&turned.dataset.sessions);
    for (a, b) in both.flat_map(|(a, b)| a.position.iter().zip(&b.position)) {
        assert!((a - b).abs() < 1e-8);
    }
}

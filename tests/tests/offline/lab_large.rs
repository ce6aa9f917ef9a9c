//! `lab new` on a table of two gigabytes: read right, in parts, with a bound on memory.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Stdio;
use std::{ffi::CString, io, mem};

use ferntast_tests::{Session, number};
use serde_json::Value;

use super::lab_new::{COULOMB, INERTIA, VISCOUS};

/// Rows of the block that a large file repeats: 15 s at 1 kHz, in which its sines come round.
const BLOCK: u32 = 15_000;
/// How large that file is at least \[bytes\].
const LARGE: u64 = 2_000_000_000;
/// What the disk has to have left for it \[bytes\].
const ROOM: u64 = 6_000_000_000;
/// What the program may take for it \[KiB\].
const MOST_MEMORY: i64 = 1 << 20;

/// Bytes that are left on the disk of a folder.
fn room(folder: &Path) -> u64 {
    let path = CString::new(folder.as_os_str().as_encoded_bytes()).expect("a path");
    // SAFETY: all zero is a value of this struct, which the call fills; both outlive it.
    let (told, disk) = unsafe {
        let mut disk: libc::statvfs = mem::zeroed();
        (libc::statvfs(path.as_ptr(), &raw mut disk), disk)
    };
    assert_eq!(told, 0, "{}", io::Error::last_os_error());
    disk.f_bavail * disk.f_frsize
}

/// Position \[rad\] and motor torque \[Nm\] of the same joint, coming round after 15 s.
fn going_round(t: f64) -> (f64, f64) {
    let (mut position, mut velocity, mut acceleration) = (0.0, 0.0, 0.0);
    for (size, rounds) in [(0.6, 5.0), (0.25, 13.0)] {
        let rate = std::f64::consts::TAU * rounds / 15.0;
        let (sine, cosine) = f64::sin_cos(rate * t);
        position += size * sine;
        velocity += size * rate * cosine;
        acceleration -= size * rate * rate * sine;
    }
    let friction = COULOMB * velocity.signum() + VISCOUS * velocity;
    (position, INERTIA * acceleration + friction)
}

/// Writes 14 columns at 1 kHz, without time, until the file is large; gives its rows.
fn write_large(path: &Path) -> io::Result<u64> {
    let mut head = "q_deg,current_A".to_owned();
    let others: String = (2..14).map(|column| format!(",other_{column}")).collect();
    head += &others;
    let mut block = String::new();
    for n in 0..BLOCK {
        let (q, tau) = going_round(f64::from(n) * 1e-3);
        // A string takes all that is written.
        let _ = write!(block, "{:.8},{tau:.8}", q.to_degrees());
        for column in 2..14 {
            let _ = write!(
                block,
                ",{:.7}",
                f64::from(column) + f64::sin(1e-3 * f64::from(n * column))
            );
        }
        block.push('\n');
    }
    let mut file = File::create(path)?;
    writeln!(file, "{head}")?;
    let blocks = LARGE.div_ceil(block.len() as u64);
    for _ in 0..blocks {
        file.write_all(block.as_bytes())?;
    }
    Ok(blocks * u64::from(BLOCK))
}

/// Two gigabytes are read in parts all over the file, with a bound on memory. The session's folder
/// is removed with the file in it, however this ends.
#[test]
#[expect(
    clippy::zombie_processes,
    reason = "wait4 waits for it, and tells its memory, which Child does not"
)]
fn a_file_of_two_gigabytes_is_read_within_a_gibibyte() {
    let session = Session::new();
    let left = room(session.folder());
    assert!(
        left > ROOM,
        "{left} bytes are left on the disk of {}, and this test writes a file of {LARGE} there: it wants {ROOM}; set TMPDIR to a folder on a larger disk",
        session.folder().display()
    );
    let path = session.folder().join("large.csv");
    let rows = write_large(&path).unwrap_or_else(|error| panic!("large.csv: {error}"));
    let bytes = path.metadata().expect("it is there").len();
    assert!((LARGE..LARGE + (1 << 23)).contains(&bytes), "{bytes}");

    let mut command = session.ferntast(&["lab", "new", "large.csv", "--rate", "1000", "--json"]);
    let command = command.process_group(0).stdin(Stdio::null());
    let command = command.stdout(Stdio::piped()).stderr(Stdio::inherit());
    let mut child = command.spawn().expect("it starts");
    let mut told = String::new();
    let mut pipe = child.stdout.take().expect("a pipe");
    io::Read::read_to_string(&mut pipe, &mut told).expect("text");
    let mut status = 0;
    // SAFETY: all zero is a value of this struct, which the call fills; the child is ours, and
    // nobody else waits for it.
    let usage = unsafe {
        let mut usage: libc::rusage = mem::zeroed();
        let waited = libc::wait4(
            child.id() as libc::pid_t,
            &raw mut status,
            0,
            &raw mut usage,
        );
        assert_eq!(waited, child.id() as libc::pid_t);
        usage
    };
    fs::remove_file(&path).expect("it is removed");
    assert_eq!(status, 0, "{told}");
    assert!(
        (10_000..MOST_MEMORY).contains(&usage.ru_maxrss),
        "{} KiB",
        usage.ru_maxrss
    );

    let made: Value = serde_json::from_str(&told).unwrap_or_else(|error| panic!("{error}: {told}"));
    assert!((number(&made, "rate_hz") - 1000.0).abs() < 0.5, "{made:#}");
    let signals = [
        ("position", "q_deg", "deg"),
        ("motor_torque", "current_A", "A"),
    ];
    assert_eq!(
        made["signals"].as_array().map(Vec::len),
        Some(2),
        "{made:#}"
    );
    for (own, (signal, column, unit)) in made["signals"]
        .as_array()
        .into_iter()
        .flatten()
        .zip(signals)
    {
        assert_eq!(own["signal"], signal, "{made:#}");
        assert_eq!(own["column"], column, "{made:#}");
        assert_eq!(own["unit"], unit, "{made:#}");
    }
    // Least and greatest are over all rows: those of one round.
    let round: Vec<(f64, f64)> = (0..BLOCK)
        .map(|n| going_round(f64::from(n) * 1e-3))
        .collect();
    let position = round.iter().map(|(q, _)| q.to_degrees());
    let torque = round.iter().map(|(_, tau)| *tau);
    let columns: [Vec<f64>; 2] = [position.collect(), torque.collect()];
    for (at, values) in columns.iter().enumerate() {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (end, truth) in [least, greatest].into_iter().enumerate() {
            let value = made["signals"][at]["range"][end]
                .as_f64()
                .unwrap_or(f64::NAN);
            assert!((value - truth).abs() < 1e-7, "{value} {truth}");
        }
    }
    // 4 million numbers of each signal are held, in a hundred stretches all over the file.
    let recording = &made["recordings"][0];
    let share = 4e6 / rows as f64;
    assert_eq!(number(recording, "samples"), rows as f64, "{made:#}");
    assert!(
        (number(&made, "share_used") / share - 1.0).abs() < 0.02,
        "{made:#}"
    );
    let used = number(recording, "used");
    let not_read = number(recording, "too_much");
    assert_eq!(used + not_read, rows as f64, "{made:#}");
    assert!(
        (99.0..=101.0).contains(&number(recording, "stretches")),
        "{made:#}"
    );
    let warned = made["warnings"].to_string();
    assert!(warned.contains("more than are held at once"), "{warned}");
}

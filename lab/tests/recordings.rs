//! Recordings of every kind, good and bad, from file to sessions.

#![allow(clippy::unwrap_used)]

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use ferntast_lab::{
    experiment::Experiment,
    recording::{Loaded, load},
};
use mcap::{Compression, WriteOptions, records::MessageHeader};

const JOINT_STATE: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
================================================================================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
================================================================================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

const SIGNALS: &str = "[signals]\nposition = \"/js.position[0]\"\nmotor_torque = \"/js.effort[:]{name==\\\"a\\\"}\"\ntemperature = \"/temperature.data\"\n";
const MODEL: &str = "[model]\ninertia = 1.0\neffects = [\"coulomb\"]\n";

/// A folder with recordings and an experiment file.
struct Bench {
    folder: tempfile::TempDir,
}

/// One sample of the joint: stamp \[ns\], position, effort.
type Sample = (i64, f64, f64);

impl Bench {
    fn new() -> Bench {
        let folder = tempfile::tempdir().unwrap();
        Bench { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// An MCAP file with `/js` (stamped) and `/temperature` (not stamped) once
    /// every ten samples.
    fn mcap(&self, name: &str, compression: Option<Compression>, samples: &[Sample]) {
        // The recorder's clock never runs backwards.
        let mut latest = 0;
        self.logged(name, compression, samples, |stamp| {
            latest = stamp.max(latest);
            latest
        });
    }

    /// The same, with log times by `clock` from the stamps.
    fn logged(
        &self,
        name: &str,
        compression: Option<Compression>,
        samples: &[Sample],
        mut clock: impl FnMut(i64) -> i64,
    ) {
        let file = fs::File::create(self.path(name)).unwrap();
        let options = WriteOptions::new()
            .compression(compression)
            .chunk_size(Some(4096));
        let mut writer = options.profile("ros2").create(file).unwrap();
        let mut channel = |topic: &str, kind: &str, text: &str| {
            let schema = writer.add_schema(kind, "ros2msg", text.as_bytes()).unwrap();
            writer
                .add_channel(schema, topic, "cdr", &BTreeMap::new())
                .unwrap()
        };
        let js = channel("/js", "sensor_msgs/msg/JointState", JOINT_STATE);
        let temperature = channel("/temperature", "std_msgs/msg/Float32", "float32 data\n");
        for (number, &(stamp, position, effort)) in samples.iter().enumerate() {
            let logged = clock(stamp);
            let mut write = |channel_id: u16, data: &[u8]| {
                let time = u64::try_from(logged).unwrap() + 7;
                let header = MessageHeader {
                    channel_id,
                    sequence: 0,
                    log_time: time,
                    publish_time: time,
                };
                writer.write_to_known_channel(&header, data).unwrap();
            };
            write(js, &joint_state(stamp, position, effort));
            if number % 10 == 0 {
                let mut data = vec![0, 1, 0, 0];
                data.extend((20.0 + number as f32 * 0.01).to_le_bytes());
                write(temperature, &data);
            }
        }
        writer.finish().unwrap();
    }

    fn experiment(&self, recording: &str, text: &str) -> Experiment {
        let text = format!("recording = {recording}\n{text}");
        Experiment::parse(&text, &self.path("e.toml"), Path::new("/nowhere")).unwrap()
    }

    fn load(&self, recording: &str) -> Loaded {
        let experiment = self.experiment(&format!("{recording:?}"), &format!("{SIGNALS}{MODEL}"));
        load(&experiment).unwrap()
    }

    /// The message that loading fails with.
    fn refused(&self, recording: &str, text: &str) -> String {
        load(&self.experiment(recording, text))
            .unwrap_err()
            .to_string()
    }
}

/// Little-endian CDR, written by hand: names "b", "a"; the effort of "a" counts.
fn joint_state(stamp: i64, position: f64, effort: f64) -> Vec<u8> {
    let mut body: Vec<u8> = Vec::new();
    body.extend(((stamp / 1_000_000_000) as i32).to_le_bytes());
    body.extend(((stamp % 1_000_000_000) as u32).to_le_bytes());
    body.extend([2, 0, 0, 0, b'x', 0, 0, 0]);
    body.extend([2, 0, 0, 0]);
    for name in [b'b', b'a'] {
        body.extend([2, 0, 0, 0, name, 0, 0, 0]);
    }
    let mut doubles = |values: &[f64]| {
        body.extend((values.len() as u32).to_le_bytes());
        if !values.is_empty() {
            body.resize(body.len().next_multiple_of(8), 0);
        }
        values
            .iter()
            .for_each(|value| body.extend(value.to_le_bytes()));
    };
    doubles(&[position, -1.0]);
    doubles(&[]);
    doubles(&[-2.0, effort]);
    [vec![0, 1, 0, 0], body].concat()
}

/// `count` samples every millisecond from `start` \[s\] on.
fn swing(start: i64, count: i64) -> Vec<Sample> {
    let sample = |n: i64| {
        let t = n as f64 * 1e-3;
        (
            start * 1_000_000_000 + n * 1_000_000,
            (3.0 * t).sin(),
            (3.0 * t).cos(),
        )
    };
    (0..count).map(sample).collect()
}

const DAY: i64 = 86_400;
const DATE: i64 = 1_700_000_000;

#[test]
fn compressed_or_not_the_same_is_read() {
    let bench = Bench::new();
    let samples = swing(DATE, 2000);
    for (name, compression) in [
        ("plain.mcap", None),
        ("zstd.mcap", Some(Compression::Zstd)),
        ("lz4.mcap", Some(Compression::Lz4)),
    ] {
        bench.mcap(name, compression, &samples);
        let dataset = bench.load(name).dataset;
        let [session] = dataset.sessions.as_slice() else {
            panic!("{} sessions", dataset.sessions.len());
        };
        assert_eq!(
            (session.name.as_str(), session.len(), session.start),
            (name, 2000, 0.0)
        );
        assert!((session.period - 1e-3).abs() < 1e-9);
        for (n, &(_, position, effort)) in samples.iter().enumerate() {
            assert_eq!(
                (session.position[n], session.motor_torque[n]),
                (position, effort)
            );
        }
        let temperature = session.temperature.as_ref().unwrap();
        // 0.01 degC a sample, interpolated between every tenth, 7 ns late;
        // behind the last one it stands.
        assert!(
            (temperature[1000] - 30.0).abs() < 1e-4 && (temperature[1005] - 30.05).abs() < 1e-4
        );
        assert!((temperature[1999] - 39.9).abs() < 1e-4);
    }
}

#[test]
fn sessions_end_at_gaps_and_files_and_keep_their_dates() {
    let bench = Bench::new();
    let mut samples = swing(DATE + 2 * DAY, 500);
    samples.extend(swing(DATE + 2 * DAY + 20, 200));
    samples.extend(swing(DATE + 5 * DAY, 20));
    samples.extend(swing(DATE + 6 * DAY, 300));
    fs::create_dir(bench.path("bag")).unwrap();
    bench.mcap("bag/bag_0.mcap", Some(Compression::Zstd), &samples);
    bench.mcap("one.mcap", None, &swing(DATE, 100));
    bench.mcap("never.mcap", None, &swing(DATE + DAY, 120));
    let text = format!("held_out = \"never.mcap\"\n{SIGNALS}{MODEL}");
    let loaded = load(&bench.experiment("[\"bag\", \"one.mcap\"]", &text)).unwrap();
    let found: Vec<_> = loaded
        .dataset
        .sessions
        .iter()
        .map(|s| (s.name.as_str(), s.len(), s.start, s.into_recording))
        .collect();
    let day = DAY as f64;
    // What goes on after a gap of some seconds has the clocks of what was before.
    assert_eq!(
        found,
        [
            ("one.mcap", 100, 0.0, 0.0),
            ("bag, session 1", 500, 2.0 * day, 0.0),
            ("bag, session 2", 200, 2.0 * day + 20.0, 20.0),
            ("bag, session 3", 300, 6.0 * day, 0.0),
        ]
    );
    assert_eq!(loaded.dataset.held_out[0].start, day);
    assert!(
        loaded
            .notes
            .iter()
            .any(|note| note.contains("20 samples left out")),
        "{:?}",
        loaded.notes
    );
    let both = format!("held_out = \"./one.mcap\"\n{SIGNALS}{MODEL}");
    assert!(
        bench
            .refused("\"one.mcap\"", &both)
            .contains("both under recording and under held_out")
    );
}

#[test]
fn each_recording_counts_once_whatever_it_is_called() {
    let bench = Bench::new();
    fs::create_dir(bench.path("bag")).unwrap();
    bench.mcap("bag/bag_0.mcap", None, &swing(DATE, 300));
    bench.mcap("bag/bag_1.mcap", None, &swing(DATE + 1, 300));
    bench.mcap("one.mcap", None, &swing(DATE + DAY, 300));
    std::os::unix::fs::symlink(bench.path("one.mcap"), bench.path("link.mcap")).unwrap();
    let text = format!("{SIGNALS}{MODEL}");
    for (recording, more) in [
        ("[\"one.mcap\", \"one.mcap\", \"one.mcap\"]", ""),
        ("[\"one.mcap\", \"./one.mcap\"]", ""),
        ("[\"one.mcap\", \"link.mcap\"]", ""),
        ("[\"bag\", \"bag/bag_1.mcap\"]", ""),
        ("[\"bag/bag_0.mcap\", \"bag\"]", ""),
        ("\"one.mcap\"", "unloaded = \"link.mcap\"\n"),
        ("\"bag\"", "held_out = [\"one.mcap\", \"link.mcap\"]\n"),
    ] {
        let told = bench.refused(recording, &format!("{more}{text}"));
        assert!(told.contains("is there twice"), "{recording}: {told}");
    }
    for (recording, more) in [
        ("\"bag\"", "held_out = \"bag/bag_0.mcap\"\n"),
        ("\"bag/bag_0.mcap\"", "held_out = \"bag\"\n"),
    ] {
        let told = bench.refused(recording, &format!("{more}{text}"));
        assert!(told.contains("both under recording"), "{recording}: {told}");
    }
    // The files of one run, each by itself, are none of them twice.
    let parts = "[\"bag/bag_0.mcap\", \"bag/bag_1.mcap\"]";
    let more = "unloaded = \"one.mcap\"\n";
    let loaded = load(&bench.experiment(parts, &format!("{more}{text}"))).unwrap();
    assert_eq!(loaded.dataset.sessions.len(), 3);
}

#[test]
fn uneven_samples_become_even() {
    let bench = Bench::new();
    // About 190 Hz; the k-th interval is longer by up to a fifth, and every 50th is missing.
    let (mut text, mut time) = (String::from("t_s,q,v\n"), 0.0);
    for n in 0..2000 {
        time += 0.0052 * (1.0 + 0.2 * (f64::from(n) * 1.7).sin().max(0.0));
        if n % 50 != 7 {
            text.push_str(&format!("{time},{},{}\n", 2.0 * time, (time * 5.0).sin()));
        }
    }
    fs::write(bench.path("a.csv"), text).unwrap();
    let signals = "[signals]\nposition = \"q.@negative\"\nmotor_torque = \"v\"\n";
    let loaded = load(&bench.experiment("\"a.csv\"", &format!("{signals}{MODEL}"))).unwrap();
    let [session] = loaded.dataset.sessions.as_slice() else {
        panic!("{} sessions", loaded.dataset.sessions.len());
    };
    assert!(
        (0.0055..0.0058).contains(&session.period),
        "{}",
        session.period
    );
    let begin = -session.position[0] / 2.0;
    for (n, (&q, &v)) in session
        .position
        .iter()
        .zip(&session.motor_torque)
        .enumerate()
    {
        let t = begin + n as f64 * session.period;
        assert!((q + 2.0 * t).abs() < 1e-9, "{n}: {q}");
        // A straight line over two intervals of 12 ms at most: ω² h² / 8.
        assert!((v - (5.0 * t).sin()).abs() < 25.0 * 0.012f64.powi(2) / 8.0 + 1e-9);
    }
}

#[test]
fn files_whose_clock_begins_anew_lie_one_behind_the_other_or_at_their_dates() {
    let bench = Bench::new();
    for name in ["a.csv", "b.csv", "c.csv"] {
        let rows = (0..100).map(|n| format!("{},{n},{}\n", f64::from(n) * 0.01, n % 7));
        fs::write(
            bench.path(name),
            format!("time;q;u\n{}", rows.collect::<String>().replace(',', ";")),
        )
        .unwrap();
    }
    let signals =
        "[signals]\nposition = \"q\"\nmotor_torque = \"u\"\nextra.again = \"u.@mul(2)\"\n";
    let loaded =
        load(&bench.experiment("[\"a.csv\", \"b.csv\"]", &format!("{signals}{MODEL}"))).unwrap();
    let [a, b] = loaded.dataset.sessions.as_slice() else {
        panic!("{:?}", loaded.notes);
    };
    assert!(
        a.start == 0.0 && (b.start - 1.0).abs() < 1e-9,
        "{}",
        b.start
    );
    assert_eq!(b.extra["again"][3], 6.0);
    // A day and a half apart, the later one named first; the third says nothing.
    let stated = "[{ file = \"b.csv\", date = 2026-03-10T12:00:00Z }, { file = \"a.csv\", date = 2026-03-09 }, \"c.csv\"]";
    let loaded = load(&bench.experiment(stated, &format!("{signals}{MODEL}"))).unwrap();
    let names: Vec<&str> = loaded
        .dataset
        .sessions
        .iter()
        .map(|own| own.name.as_str())
        .collect();
    assert_eq!(names, ["a.csv", "b.csv", "c.csv"]);
    // Floating point keeps a microsecond of a date.
    let is_about = |own: f64, wanted: f64| (own - wanted).abs() < 1e-6;
    assert!(is_about(loaded.dataset.sessions[1].start, 1.5 * DAY as f64));
    assert!(
        loaded
            .date
            .is_some_and(|own| is_about(own, 1_773_014_400.0))
    );
    let without = loaded.notes.iter().find(|note| note.contains("no date"));
    assert!(
        without.is_some_and(|note| note.contains("c.csv")),
        "{:?}",
        loaded.notes
    );
    let undated = "[{ file = \"a.csv\", date = 14:30:00 }]";
    let told = Experiment::parse(
        &format!("recording = {undated}\n{signals}{MODEL}"),
        &bench.path("e.toml"),
        Path::new("/nowhere"),
    );
    let told = told.unwrap_err().to_string();
    assert!(
        told.contains("recording.date") && told.contains("2026-03-09"),
        "{told}"
    );
}

#[test]
fn every_fault_has_its_message() {
    let bench = Bench::new();
    let good = swing(DATE, 200);
    let with = |change: &dyn Fn(&mut Vec<Sample>)| {
        let mut samples = good.clone();
        change(&mut samples);
        samples
    };
    bench.mcap("good.mcap", None, &good);
    bench.mcap("empty.mcap", None, &[]);
    bench.mcap("short.mcap", None, &good[..30]);
    bench.mcap(
        "nan.mcap",
        None,
        &with(&|s| s.iter_mut().for_each(|s| s.1 = f64::NAN)),
    );
    bench.mcap("back.mcap", None, &with(&|s| s[150].0 -= 20_000_000));
    let back = with(&|s| s[150].0 -= 20_000_000);
    bench.logged("log_back.mcap", None, &back, |stamp| stamp);
    bench.mcap(
        "still.mcap",
        None,
        &with(&|s| s.iter_mut().for_each(|s| s.1 = 0.5)),
    );
    bench.mcap(
        "slack.mcap",
        None,
        &with(&|s| s.iter_mut().for_each(|s| s.2 = 0.0)),
    );
    let whole = fs::read(bench.path("good.mcap")).unwrap();
    fs::write(bench.path("cut.mcap"), &whole[..whole.len() / 2]).unwrap();
    fs::write(bench.path("nothing.mcap"), "").unwrap();
    fs::write(bench.path("other.mcap"), "t_s,q\n0,1\n").unwrap();
    fs::write(bench.path("run.xyz"), "x").unwrap();
    fs::create_dir(bench.path("hollow")).unwrap();
    for (file, words) in [
        ("empty.mcap", "signals.position: topic /js of "),
        (
            "short.mcap",
            "30 samples without a gap are too few, 100 are needed",
        ),
        ("nan.mcap", "signals.position: none of 200 samples in "),
        (
            "back.mcap",
            "time runs backwards by 0.019 s under signals.position in ",
        ),
        (
            "log_back.mcap",
            "time runs backwards by 0.019 s under signals.position in ",
        ),
        ("still.mcap", "signals.position is 0.5 rad in every sample"),
        ("slack.mcap", "signals.motor_torque is 0 Nm in every sample"),
        ("cut.mcap", "run `ferntast bag repair "),
        ("nothing.mcap", "is empty"),
        ("other.mcap", "is not an MCAP file"),
        ("run.xyz", "is no recording that is read"),
        ("hollow", "holds no recording"),
        ("missing.mcap", "there is no recording at "),
        ("missing.csv", "cannot read "),
    ] {
        let message = bench.refused(&format!("{file:?}"), &format!("{SIGNALS}{MODEL}"));
        assert!(
            message.contains(words) && message.contains(file),
            "{message}"
        );
    }
}

#[test]
fn a_path_that_leads_nowhere_names_those_that_do() {
    let bench = Bench::new();
    bench.mcap("a.mcap", None, &swing(DATE, 100));
    let refused = |position: &str| {
        let text = SIGNALS.replace("/js.position[0]", position);
        bench.refused("\"a.mcap\"", &format!("{text}{MODEL}"))
    };
    for (path, words) in [
        (
            "/jss.position[0]",
            "has no topic /jss; numbers that it has, nearest first: /js.position[0], /js.position[1]",
        ),
        (
            "/js.positions[0]",
            "has no field \"positions\"; numbers that ",
        ),
        (
            "/js.position",
            "/js.position is float64[], not a number; numbers that ",
        ),
        (
            "/js.header.frame_id",
            "/js.header.frame_id is string, not a number",
        ),
        ("/js.position[2]", "none of the 100 messages in "),
        ("/js.position[:]", "gives 2 numbers in message 1 of "),
        ("/js.velocity[0]", "(the array there has 0 elements)"),
        ("/js.position[0", "column 15: expected `]` or `:`"),
    ] {
        let message = refused(path);
        assert!(message.contains(words), "{message}");
        assert!(message.starts_with("signals.position"), "{message}");
    }
    // Arrays are as long as they are, and what has no numbers is not named.
    let message = refused("/js.positions[0]");
    let (_, listed) = message.split_once("nearest first: ").unwrap();
    assert!(
        listed.starts_with("/js.position[0], /js.position[1]"),
        "{listed}"
    );
    assert!(
        !listed.contains("velocity[0]") && !listed.contains("frame_id"),
        "{listed}"
    );
}

#[test]
fn signals_that_never_meet_are_refused() {
    let bench = Bench::new();
    bench.mcap("a.mcap", None, &swing(DATE, 100));
    // The stamps of /js lie a day away from the log times of /temperature: log
    // times are used then, and said so.
    let file = bench.path("two_clocks.mcap");
    let mut writer = WriteOptions::new()
        .create(fs::File::create(&file).unwrap())
        .unwrap();
    let js = writer
        .add_schema(
            "sensor_msgs/msg/JointState",
            "ros2msg",
            JOINT_STATE.as_bytes(),
        )
        .unwrap();
    let js = writer
        .add_channel(js, "/js", "cdr", &BTreeMap::new())
        .unwrap();
    let data = writer
        .add_schema("std_msgs/msg/Float32", "ros2msg", b"float32 data\n")
        .unwrap();
    let late = writer
        .add_channel(data, "/late", "cdr", &BTreeMap::new())
        .unwrap();
    let near = writer
        .add_channel(data, "/temperature", "cdr", &BTreeMap::new())
        .unwrap();
    for (n, (stamp, position, effort)) in swing(100, 100).into_iter().enumerate() {
        let time = (stamp + DAY * 1_000_000_000) as u64;
        let mut float = vec![0, 1, 0, 0];
        float.extend((n as f32).to_le_bytes());
        for (channel_id, log_time, data) in [
            (js, time, &joint_state(stamp, position, effort)),
            (near, time, &float),
            (late, time + 5_000_000_000, &float),
        ] {
            let header = MessageHeader {
                channel_id,
                sequence: 0,
                log_time,
                publish_time: log_time,
            };
            writer.write_to_known_channel(&header, data).unwrap();
        }
    }
    writer.finish().unwrap();
    let loaded = bench.load("two_clocks.mcap");
    assert_eq!(loaded.dataset.sessions[0].len(), 100);
    assert!(
        loaded
            .notes
            .iter()
            .any(|note| note.contains("log times are used")),
        "{:?}",
        loaded.notes
    );
    let text = SIGNALS.replace("/temperature", "/late");
    let message = bench.refused("\"two_clocks.mcap\"", &format!("{text}{MODEL}"));
    assert!(
        message.contains("signals.temperature (5.000 … 5.099 s, ")
            && message.contains("4.901 s apart")
            && message.contains("never overlap"),
        "{message}"
    );
}

#[test]
fn schemas_in_idl_and_messages_in_other_encodings_are_refused() {
    let bench = Bench::new();
    for (name, schema, message, words) in [
        ("idl.mcap", "ros2idl", "cdr", "only \"ros2msg\" is read"),
        ("json.mcap", "ros2msg", "json", "only \"cdr\" is read"),
    ] {
        let mut writer = WriteOptions::new()
            .create(fs::File::create(bench.path(name)).unwrap())
            .unwrap();
        let id = writer
            .add_schema("sensor_msgs/msg/JointState", schema, JOINT_STATE.as_bytes())
            .unwrap();
        writer
            .add_channel(id, "/js", message, &BTreeMap::new())
            .unwrap();
        writer.finish().unwrap();
        let text = bench.refused(&format!("{name:?}"), &format!("{SIGNALS}{MODEL}"));
        assert!(text.contains(words), "{text}");
    }
}

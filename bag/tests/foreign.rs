//! Recordings that others made: without chunks, without an index, in several
//! files, by older formats of rosbag2, with topics that are not of our table.

#![allow(clippy::unwrap_used)] // A test may.

use std::{collections::BTreeMap, fs, io::Cursor, path::Path};

use ferntast_bag::{BagReader, OpenBagError, RepairError, SelectTopicError, info, repair};
use ferntast_msgs::{Time, sample::JointSample};
use mcap::{Compression, WriteOptions, records::MessageHeader};

/// Schemas are the business of whoever reads them.
const SCHEMA: &[u8] = b"string data";

/// An MCAP file with messages on `/b` and `/a` at the given log times, whose
/// data is their log time.
fn file(options: WriteOptions, times: &[u64]) -> Vec<u8> {
    let mut writer = options
        .profile("ros2")
        .create(Cursor::new(Vec::new()))
        .unwrap();
    let schema = writer
        .add_schema("std_msgs/msg/String", "ros2msg", SCHEMA)
        .unwrap();
    let channels = ["/b", "/a"].map(|topic| {
        writer
            .add_channel(schema, topic, "cdr", &BTreeMap::new())
            .unwrap()
    });
    for (k, &log_time) in times.iter().enumerate() {
        let header = MessageHeader {
            channel_id: channels[k % 2],
            sequence: 0,
            log_time,
            publish_time: 0,
        };
        writer
            .write_to_known_channel(&header, &log_time.to_le_bytes())
            .unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

fn times(path: &Path) -> Vec<u64> {
    let reader = BagReader::open(path).unwrap();
    reader
        .raw()
        .map(|message| {
            let message = message.unwrap();
            let log_time = message.log_time.nanos() as u64;
            assert_eq!(message.bytes(), log_time.to_le_bytes());
            assert_eq!(message.publish_time, Time::INVALID);
            log_time
        })
        .collect()
}

/// Neither in order nor distinct, in many small chunks that overlap.
fn shuffled() -> Vec<u64> {
    (0..2000_u64)
        .map(|k| 1_000_000 + k * 37 % 1999 + k / 3)
        .collect()
}

fn all_options() -> Vec<(&'static str, WriteOptions)> {
    let base = || WriteOptions::new().chunk_size(Some(600));
    vec![
        ("zstd", base()),
        ("lz4", base().compression(Some(Compression::Lz4))),
        ("plain_chunks", base().compression(None)),
        (
            "no_checksums",
            base()
                .calculate_chunk_crcs(false)
                .calculate_data_section_crc(false),
        ),
        ("no_chunks", base().use_chunks(false)),
        (
            "no_summary",
            base()
                .emit_summary_records(false)
                .emit_summary_offsets(false),
        ),
        ("no_chunk_index", base().emit_chunk_indexes(false)),
        ("no_message_index", base().emit_message_indexes(false)),
        (
            "no_repeated_schemas",
            base().repeat_schemas(false).repeat_channels(false),
        ),
        ("one_chunk", WriteOptions::new()),
    ]
}

#[test]
fn every_layout_gives_all_messages_in_the_order_of_log_time() {
    let directory = tempfile::tempdir().unwrap();
    let mut expected = shuffled();
    expected.sort_unstable();
    for (name, options) in all_options() {
        let path = directory.path().join(format!("{name}.mcap"));
        fs::write(&path, file(options, &shuffled())).unwrap();
        assert_eq!(times(&path), expected, "{name}");
        let reader = BagReader::open(&path).unwrap();
        let bounds = reader
            .bounds()
            .map(|(first, last)| (first.nanos(), last.nanos()));
        assert_eq!(
            bounds,
            Some((expected[0] as i64, expected[1999] as i64)),
            "{name}"
        );
        let from = Time::from_nanos(1_001_000);
        let late = expected.iter().filter(|&&time| time >= 1_001_000).count();
        assert_eq!(reader.raw_from(from).count(), late, "{name}");
        assert_eq!(
            reader.raw_topics(&["/a"], Time::INVALID).unwrap().count(),
            1000
        );
        let said = info(&path).unwrap();
        assert!(
            said.closed && said.breaks.is_empty(),
            "{name}: {:?}",
            said.breaks
        );
    }
}

#[test]
fn every_layout_can_be_cut_and_mended() {
    let directory = tempfile::tempdir().unwrap();
    for (name, options) in all_options() {
        let path = directory.path().join(format!("{name}.mcap"));
        let bytes = file(options, &shuffled());
        fs::write(&path, &bytes[..bytes.len() * 6 / 10]).unwrap();
        assert!(BagReader::open(&path).is_err(), "{name}");
        let report = repair(&path, None).unwrap();
        assert_eq!(times(&path).len() as u64, report.messages, "{name}");
        let most = if name == "one_chunk" { 2000 } else { 1999 };
        assert!(
            (400..=most).contains(&report.messages),
            "{name}: {}",
            report.messages
        );
        assert!(!directory.path().join("metadata.yaml").exists());
    }
}

#[test]
fn a_cut_chunk_gives_the_messages_in_front_of_the_cut() {
    let directory = tempfile::tempdir().unwrap();
    let many: Vec<u64> = (1..=40_000).collect();
    for compression in [None, Some(Compression::Lz4), Some(Compression::Zstd)] {
        let options = WriteOptions::new()
            .chunk_size(None)
            .compression(compression);
        let bytes = file(options, &many);
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        let chunk = &summary.chunk_indexes[0];
        let inside = chunk.compressed_data_offset().unwrap() + chunk.compressed_size * 8 / 10;
        let path = directory.path().join(format!("{compression:?}.mcap"));
        fs::write(&path, &bytes[..inside as usize]).unwrap();
        let report = repair(&path, None).unwrap();
        // Compressed data can be unpacked block by block only.
        assert!(
            (20_000..40_000).contains(&report.messages),
            "{}",
            report.messages
        );
        assert_eq!(times(&path), many[..report.messages as usize]);
    }
}

#[test]
fn several_files_are_one_recording() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    fs::create_dir(&path).unwrap();
    for (name, times) in [
        ("run_0", [10, 40, 50]),
        ("run_1", [20, 30, 60]),
        ("run_10", [5, 70, 80]),
    ] {
        fs::write(
            path.join(format!("{name}.mcap")),
            file(WriteOptions::new(), &times),
        )
        .unwrap();
    }
    let expected = [5, 10, 20, 30, 40, 50, 60, 70, 80];
    // Without metadata.yaml by the directory's content, then by what it says.
    assert_eq!(times(&path), expected);
    let report = repair(&path, None).unwrap();
    assert_eq!((report.messages, report.metadata_written), (9, true));
    assert_eq!(times(&path), expected);
    assert_eq!(BagReader::open(&path).unwrap().topics().count(), 2);

    // Version 4 of the format, as rosbag2 wrote it in Foxy and Galactic.
    let old = "rosbag2_bagfile_information:\n  version: 4\n  storage_identifier: mcap\n  relative_file_paths:\n    - run/run_1.mcap\n  duration:\n    nanoseconds: 40\n";
    fs::write(path.join("metadata.yaml"), old).unwrap();
    assert_eq!(times(&path), [20, 30, 60]);
}

#[test]
fn a_folder_of_unrelated_files_is_not_made_one_recording() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["monday.mcap", "tuesday_0.mcap"] {
        let path = directory.path().join(name);
        fs::write(path, file(WriteOptions::new(), &[10])).unwrap();
    }
    for output in [None, Some(directory.path().join("out"))] {
        let error = repair(directory.path(), output.as_deref()).unwrap_err();
        assert!(
            matches!(error, RepairError::Unrelated { files: 2, .. }),
            "{error}"
        );
    }
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 2);
    // Each by its own name.
    let one = directory.path().join("monday.mcap");
    assert_eq!(repair(&one, None).unwrap().messages, 1);
}

#[test]
fn one_broken_file_of_several_is_mended_and_the_others_left() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    fs::create_dir(&path).unwrap();
    let whole = file(WriteOptions::new(), &[10, 20]);
    let cut = file(WriteOptions::new(), &[30, 40]);
    fs::write(path.join("run_0.mcap"), &whole).unwrap();
    fs::write(path.join("run_1.mcap"), &cut[..cut.len() - 1]).unwrap();
    match BagReader::open(&path).unwrap_err() {
        OpenBagError::Truncated { path: broken } => assert_eq!(broken, path.join("run_1.mcap")),
        error => panic!("{error}"),
    }
    let report = repair(&path, None).unwrap();
    assert_eq!(report.messages, 4);
    assert_eq!(fs::read(path.join("run_0.mcap")).unwrap(), whole);
    assert_eq!(times(&path), [10, 20, 30, 40]);
}

#[test]
fn a_type_of_the_same_name_and_another_hash_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("other.mcap");
    let mut writer = WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    let schema = writer
        .add_schema("sensor_msgs/msg/JointState", "ros2msg", SCHEMA)
        .unwrap();
    let metadata = BTreeMap::from([("topic_type_hash".to_owned(), format!("RIHS01_{:064}", 0))]);
    writer
        .add_channel(schema, "/joints", "cdr", &metadata)
        .unwrap();
    writer
        .add_channel(schema, "/encoded", "json", &BTreeMap::new())
        .unwrap();
    writer
        .add_channel(schema, "/fine", "cdr", &BTreeMap::new())
        .unwrap();
    writer.finish().unwrap();
    fs::write(&path, writer.into_inner().into_inner()).unwrap();
    let reader = BagReader::open(&path).unwrap();
    let error = reader.messages::<JointSample>("/joints").unwrap_err();
    assert!(
        matches!(error, SelectTopicError::WrongType { .. }),
        "{error}"
    );
    let error = reader.messages::<JointSample>("/encoded").unwrap_err();
    assert!(matches!(error, SelectTopicError::NotCdr { .. }), "{error}");
    assert_eq!(reader.messages::<JointSample>("/fine").unwrap().count(), 0);
}

//! Mending what was cut off, and saying what a recording holds.

#![allow(clippy::unwrap_used)] // A test may.

mod samples;

use std::{
    fs,
    path::{Path, PathBuf},
};

use ferntast_bag::{BagReader, BagWriter, OpenBagError, RepairError, info, repair};
use ferntast_msgs::{Time, topics::FOLLOWER_MEASURED_JS};
use samples::{START, joint, options, topic_count, write_sample_bag};

/// What stands in a recording, comparable.
fn content(path: &Path) -> Vec<(String, Time, Time, u32, Vec<u8>)> {
    let reader = BagReader::open(path).unwrap();
    reader
        .raw()
        .map(|message| {
            let message = message.unwrap();
            (
                message.topic.name.clone(),
                message.log_time,
                message.publish_time,
                message.sequence,
                message.bytes().to_vec(),
            )
        })
        .collect()
}

/// A recording of 300 rounds in 6 chunks: its folder, where it is, the bytes of its file and
/// their summary.
fn six_chunks() -> (tempfile::TempDir, PathBuf, Vec<u8>, mcap::Summary) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 300).unwrap();
    let bytes = fs::read(path.join("run_0.mcap")).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    (directory, path, bytes, summary)
}

#[test]
fn a_file_cut_anywhere_gives_all_whole_chunks_and_more() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 300).unwrap();
    let whole = content(&path);
    let bytes = fs::read(path.join("run_0.mcap")).unwrap();
    let mut recovered = Vec::new();
    for part in [0.3, 0.5, 0.7, 0.9, 0.999] {
        let cut = directory.path().join(format!("cut_{part}.mcap"));
        fs::write(&cut, &bytes[..(bytes.len() as f64 * part) as usize]).unwrap();
        assert!(matches!(
            BagReader::open(&cut),
            Err(OpenBagError::Truncated { .. })
        ));
        let mended = directory.path().join(format!("mended_{part}.mcap"));
        let report = repair(&cut, Some(&mended)).unwrap();
        let messages = content(&mended);
        assert_eq!(messages.len() as u64, report.messages);
        assert_eq!(messages, whole[..messages.len()]);
        assert_eq!(report.files[0].breaks.len(), 1);
        recovered.push(report.messages);
        // The original is as it was.
        assert!(BagReader::open(&cut).is_err());
    }
    assert!(recovered.is_sorted(), "{recovered:?}");
    // Of 300 rounds in 6 chunks: with 0.3 of the bytes at least the first
    // chunk is there, with 0.999 all.
    let round = topic_count() as u64;
    assert!(
        (50 * round..150 * round).contains(&recovered[0]),
        "{recovered:?}"
    );
    assert_eq!(recovered[4], 300 * round);
}

#[test]
fn a_directory_is_mended_in_place_and_the_broken_file_kept() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 100).unwrap();
    let file = path.join("run_0.mcap");
    let whole = content(&path);
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[..bytes.len() - 100]).unwrap();
    fs::remove_file(path.join("metadata.yaml")).unwrap();

    assert!(!info(&path).unwrap().closed);
    // By the file's name: that is what a message says to run.
    let report = repair(&file, None).unwrap();
    assert!(report.metadata_written);
    let messages = 100 * topic_count() as u64;
    assert_eq!(report.messages, messages);
    let backup = report.files[0].backup.clone().unwrap();
    assert_eq!(fs::read(&backup).unwrap(), bytes[..bytes.len() - 100]);
    assert_eq!(content(&path), whole);
    assert_eq!(BagReader::open(&path).unwrap().metadata(), options().custom);
    let said = info(&path).unwrap();
    assert!(said.closed && said.breaks.is_empty());
    let metadata = fs::read_to_string(path.join("metadata.yaml")).unwrap();
    assert!(metadata.contains(&format!("message_count: {messages}")));
    assert!(metadata.contains("ros_distro: jazzy"));

    // Nothing to do the second time.
    let again = repair(&path, None).unwrap();
    assert!(!again.metadata_written && again.files[0].backup.is_none());
    assert_eq!(fs::read_dir(&path).unwrap().count(), 3);
}

#[test]
fn behind_a_damaged_head_in_a_file_that_was_not_closed_the_rest_is_found() {
    let (directory, path, bytes, summary) = six_chunks();
    let whole = content(&path);
    let chunks = &summary.chunk_indexes;
    let third = chunks[2].chunk_start_offset as usize;
    let last = chunks.last().unwrap();
    let end = (last.chunk_start_offset + last.chunk_length) as usize;
    // Opcode, lengths shorter, longer and beyond the file, the name of the compression.
    for (place, flip) in [
        (0, 0x70),
        (0, 0x02),
        (1, 0x04),
        (3, 0x01),
        (7, 0x80),
        (45, 0x20),
    ] {
        let mut damaged = bytes[..end].to_vec();
        damaged[third + place] ^= flip;
        let file = directory.path().join("damaged.mcap");
        let mended = directory.path().join("mended.mcap");
        fs::write(&file, damaged).unwrap();
        let report = repair(&file, Some(&mended)).unwrap();
        assert!(!report.files[0].breaks.is_empty());
        let messages = content(&mended);
        let lost = whole.len() - messages.len();
        // A chunk holds half a second: 50 rounds.
        assert!(lost <= 51 * topic_count(), "{place}: {lost} lost");
        assert_eq!(messages.last(), whole.last());
        fs::remove_file(&mended).unwrap();
    }
}

#[test]
fn a_damaged_chunk_is_left_out_and_the_rest_kept() {
    let (_directory, path, mut bytes, summary) = six_chunks();
    let file = path.join("run_0.mcap");
    let third = &summary.chunk_indexes[2];
    let inside = third.compressed_data_offset().unwrap() + third.compressed_size / 2;
    bytes[inside as usize] ^= 0x10;
    fs::write(&file, bytes).unwrap();

    let reader = BagReader::open(&path).unwrap();
    let (read, failed): (Vec<_>, Vec<_>) = reader.raw().partition(Result::is_ok);
    assert_eq!(failed.len(), 1);
    assert!(
        failed[0]
            .as_ref()
            .unwrap_err()
            .to_string()
            .contains("damaged at byte")
    );
    let said = info(&path).unwrap();
    // The chunk's own checksum and that of all data.
    assert_eq!((said.breaks.len(), said.closed), (2, true));

    let report = repair(&path, None).unwrap();
    assert_eq!(report.messages, read.len() as u64);
    assert!(
        (208 * topic_count() as u64..300 * topic_count() as u64).contains(&report.messages),
        "{}",
        report.messages
    );
    assert!(
        BagReader::open(&path)
            .unwrap()
            .raw()
            .all(|message| message.is_ok())
    );
}

/// The first chunk alone used to say what the messages of all chunks are.
#[test]
fn a_damaged_chunk_of_a_file_that_was_cut_off_takes_no_other_along() {
    let (directory, path, bytes, summary) = six_chunks();
    let whole = content(&path);
    let chunks = &summary.chunk_indexes;
    let messages = |chunk: &mcap::records::ChunkIndex| {
        let indexes = summary.read_message_indexes(&bytes, chunk).unwrap();
        indexes.values().map(Vec::len).sum::<usize>()
    };
    assert!(chunks.len() >= 5, "{}", chunks.len());
    let last = chunks
        .iter()
        .map(|chunk| chunk.chunk_start_offset + chunk.chunk_length + chunk.message_index_length);
    let end = last.max().unwrap() as usize;
    for (k, chunk) in chunks.iter().enumerate() {
        let mut cut = bytes[..end].to_vec();
        let inside = chunk.compressed_data_offset().unwrap() + chunk.compressed_size / 2;
        cut[inside as usize] ^= 0x10;
        let file = directory.path().join(format!("cut_{k}.mcap"));
        fs::write(&file, cut).unwrap();
        let report = repair(&file, None).unwrap();
        let kept = whole.len() - messages(chunk);
        assert_eq!(report.messages as usize, kept, "without chunk {k}");
        assert_eq!(content(&file).len(), kept);
    }
}

/// A copy of a schema outside the chunks has no checksum: the one within counts.
#[test]
fn a_damaged_copy_of_a_schema_is_told_and_does_not_count() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 300).unwrap();
    let whole = content(&path);
    let file = path.join("run_0.mcap");
    let mut bytes = fs::read(&file).unwrap();
    // Chunks are compressed: in clear the text stands in a copy and in the summary.
    let text = b"float64[] position";
    let found = bytes.windows(text.len()).position(|window| window == text);
    bytes[found.unwrap()] = b'g';
    bytes.truncate(bytes.len() - 100);
    fs::write(&file, bytes).unwrap();
    let report = repair(&path, None).unwrap();
    let reasons = &report.files[0].breaks;
    assert!(
        reasons.iter().any(|one| one.reason.contains("unlike")),
        "{reasons:?}"
    );
    assert_eq!(content(&path), whole);
    let topics = BagReader::open(&path).unwrap();
    assert!(topics.raw().all(|message| message.is_ok()));
}

#[test]
fn damage_outside_the_messages_is_told_and_mended() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 100).unwrap();
    let file = path.join("run_0.mcap");
    let mut bytes = fs::read(&file).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let index = summary.chunk_indexes[0]
        .message_index_offsets
        .values()
        .next()
        .unwrap();
    bytes[*index as usize + 20] ^= 1;
    fs::write(&file, bytes).unwrap();
    assert_eq!(info(&path).unwrap().breaks.len(), 1);
    assert_eq!(
        repair(&path, None).unwrap().messages,
        100 * topic_count() as u64
    );
    assert_eq!(info(&path).unwrap().breaks, []);
}

#[test]
fn an_output_directory_gets_the_whole_recording() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 50).unwrap();
    fs::write(path.join("metadata.yaml"), "][").unwrap();
    assert!(matches!(
        BagReader::open(&path),
        Err(OpenBagError::Metadata { .. })
    ));
    let output = directory.path().join("mended");
    let report = repair(&path, Some(&output)).unwrap();
    let messages = 50 * topic_count();
    assert_eq!(
        (report.messages, report.metadata_written),
        (messages as u64, true)
    );
    assert_eq!(content(&output).len(), messages);
    assert_eq!(
        fs::read_to_string(path.join("metadata.yaml")).unwrap(),
        "]["
    );
    let error = repair(&path, Some(&output)).unwrap_err();
    assert!(matches!(error, RepairError::OutputExists { .. }), "{error}");
}

#[test]
fn what_is_no_recording_is_said_to_be_none() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str, content: &[u8]| {
        let path = directory.path().join(name);
        fs::write(&path, content).unwrap();
        path
    };
    let missing = directory.path().join("missing");
    let empty = at("empty.mcap", b"");
    let other = at("other.mcap", b"#ROSBAG V2.0\n");
    let begun = at("begun.mcap", b"\x89MCAP0\r");
    let magic = at("magic.mcap", b"\x89MCAP0\r\n");
    let open = |path: &Path| BagReader::open(path).unwrap_err();
    assert!(matches!(open(&missing), OpenBagError::Missing { .. }));
    assert!(matches!(open(&empty), OpenBagError::Empty { .. }));
    assert!(matches!(open(&other), OpenBagError::NotMcap { .. }));
    assert!(matches!(open(&begun), OpenBagError::Truncated { .. }));
    assert!(matches!(open(&magic), OpenBagError::Truncated { .. }));
    let bare = directory.path().join("bare");
    fs::create_dir(&bare).unwrap();
    assert!(matches!(open(&bare), OpenBagError::NoRecording { .. }));
    fs::write(bare.join("metadata.yaml"), "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  relative_file_paths: [gone.mcap]\n").unwrap();
    match open(&bare) {
        OpenBagError::Missing { path } => assert_eq!(path, bare.join("gone.mcap")),
        error => panic!("{error}"),
    }
    for path in [&missing, &empty, &other, &bare] {
        assert!(matches!(repair(path, None), Err(RepairError::Open(_))));
        assert!(info(path).is_err());
    }
    let report = repair(&magic, None).unwrap();
    assert_eq!(report.messages, 0);
    assert_eq!(BagReader::open(&magic).unwrap().raw().count(), 0);
}

#[test]
fn info_tells_rates_and_gaps() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    let mut writer = BagWriter::create(&path, options()).unwrap();
    let channel = writer.topic(FOLLOWER_MEASURED_JS).unwrap();
    // 1 kHz for 2 s, silence of 0.75 s in between.
    for k in 0..2000_i64 {
        let pause = if k < 1000 { 0 } else { 749_000_000 };
        let now = START.plus_nanos(k * 1_000_000 + pause);
        writer.write(channel, now, now, &joint(0.0, now)).unwrap();
    }
    writer.finish().unwrap();
    let said = info(&path).unwrap();
    assert_eq!(said.messages, 2000);
    assert!(
        (said.duration_s - 2.748).abs() < 1e-9,
        "{}",
        said.duration_s
    );
    let [topic] = &said.topics[..] else {
        panic!("{:?}", said.topics);
    };
    assert_eq!(topic.interface, "sensor_msgs/msg/JointState");
    assert!((topic.rate_hz - 1999.0 / 2.748).abs() < 1e-6);
    assert!((topic.longest_interval_s - 0.75).abs() < 1e-9);
    assert_eq!((topic.gap_count, topic.gaps.len()), (1, 1));
    assert_eq!(topic.gaps[0].start, START.plus_nanos(999_000_000));
    assert!((topic.gaps[0].duration_s - 0.75).abs() < 1e-9);
    assert_eq!(said.metadata, options().custom);
    let json = serde_json::to_value(&said).unwrap();
    assert_eq!(json["topics"][0]["messages"], 2000);
}

//! Recording, and reading the recording back.

#![allow(clippy::unwrap_used)] // A test may.

mod samples;

use std::{collections::BTreeSet, fs};

use ferntast_bag::{
    BagOptions, BagReader, BagWriter, ChunkCompression, CreateBagError, OpenBagError,
    SelectTopicError, WriteBagError, info,
};
use ferntast_msgs::{
    Message, RosMessage, Time, interface,
    sample::{JointNames, JointSample, PoseSample},
    topics::{self, Delivery, FOLLOWER_MEASURED_JS, LEADER_MEASURED_CP, Topic, Visitor},
};
use samples::{START, joint, log_time, options, record, sample, topic_count, write_sample_bag};

struct Compare<'a> {
    reader: &'a BagReader,
    topics: usize,
}

impl Visitor for Compare<'_> {
    fn topic<M: Message>(&mut self, topic: Topic<M>) {
        self.topics += 1;
        let messages: Vec<_> = self.reader.messages::<M>(&topic.name).unwrap().collect();
        assert_eq!(messages.len(), 30, "{}", topic.name);
        for (k, read) in (0..).zip(messages) {
            let read = read.unwrap();
            let written: M = sample(k, log_time(k)).unwrap();
            assert_eq!(read.message, M::from_ros(&written.to_ros()).unwrap());
            assert_eq!(read.log_time, log_time(k));
            assert_eq!(read.publish_time, log_time(k).plus_nanos(-1000));
        }
        let described = self
            .reader
            .topics()
            .find(|found| topic.name == *found.name)
            .unwrap();
        let interface = M::Ros::INTERFACE;
        assert_eq!(described.schema_name, interface);
        assert_eq!(described.schema_encoding, "ros2msg");
        assert_eq!(described.schema_text, interface::schema(interface).unwrap());
        assert_eq!(
            described.type_hash,
            interface::type_hash(interface).unwrap()
        );
        let (reliability, durability, depth) = match topic.delivery {
            Delivery::Stream => ("best_effort", "volatile", 1),
            Delivery::State => ("reliable", "transient_local", 1),
            Delivery::Event => ("reliable", "volatile", 64),
        };
        let [qos] = &described.offered_qos[..] else {
            panic!("{} offers {:?}", topic.name, described.offered_qos);
        };
        assert_eq!(
            (qos.reliability.as_str(), qos.durability.as_str(), qos.depth),
            (reliability, durability, depth)
        );
    }
}

#[test]
fn every_topic_of_the_table_comes_back() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    let summary = write_sample_bag(&path, 30).unwrap();
    let reader = BagReader::open(&path).unwrap();
    let mut compare = Compare {
        reader: &reader,
        topics: 0,
    };
    topics::visit(&JointNames::numbered(2), &mut compare).unwrap();
    assert!(compare.topics >= 24);
    assert_eq!(summary.messages, 30 * compare.topics as u64);
    assert_eq!(reader.raw().count() as u64, summary.messages);
    assert_eq!(reader.bounds(), Some((log_time(0), log_time(29))));
    assert_eq!(
        (summary.start, summary.end),
        (Some(log_time(0)), Some(log_time(29)))
    );
    assert_eq!(
        summary.bytes,
        fs::metadata(path.join("run_0.mcap")).unwrap().len()
    );
    assert_eq!(reader.metadata(), options().custom);
}

#[test]
fn the_same_messages_give_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let bytes: BTreeSet<_> = ["a", "b", "c"]
        .map(|parent| {
            let path = directory.path().join(parent).join("run");
            write_sample_bag(&path, 200).unwrap();
            let mcap = fs::read(path.join("run_0.mcap")).unwrap();
            (mcap, fs::read(path.join("metadata.yaml")).unwrap())
        })
        .into();
    assert_eq!(bytes.len(), 1);
}

#[test]
fn a_file_that_is_full_is_followed_by_another() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        let path = directory.path().join(name).join("run");
        let mut writer = BagWriter::create(
            &path,
            BagOptions {
                max_file_size: 100_000,
                flush_interval_ns: 20_000_000,
                ..options()
            },
        )
        .unwrap();
        record(&mut writer, 0..600).unwrap();
        (path, writer.finish().unwrap())
    };
    let (path, summary) = write("a");
    let info = info(&path).unwrap();
    assert!((3..40).contains(&info.files.len()), "{}", info.files.len());
    assert!(info.closed && info.breaks.is_empty(), "{info:?}");
    assert_eq!(summary.messages, 600 * topic_count() as u64);
    assert_eq!(info.messages, summary.messages);
    assert_eq!(
        (summary.start, summary.end),
        (Some(log_time(0)), Some(log_time(599)))
    );
    let mut bytes = 0;
    let mut alone = 0;
    for number in 0..info.files.len() {
        let file = path.join(format!("run_{number}.mcap"));
        let length = fs::metadata(&file).unwrap().len();
        let last = number + 1 == info.files.len();
        assert!(last || (100_000..200_000).contains(&length), "{length}");
        bytes += length;
        // Each can be read without the others, and says what the recording is.
        let reader = BagReader::open(&file).unwrap();
        assert_eq!(reader.metadata(), options().custom);
        let all: Result<Vec<_>, _> = reader.raw().collect();
        alone += all.unwrap().len();
    }
    assert_eq!(bytes, summary.bytes);
    assert_eq!(alone as u64, summary.messages);
    // As one, in order.
    let reader = BagReader::open(&path).unwrap();
    let times: Vec<_> = reader.raw().map(|own| own.unwrap().log_time).collect();
    assert_eq!(times.len() as u64, summary.messages);
    assert!(times.is_sorted());

    let (again, _) = write("b");
    for entry in fs::read_dir(&path).unwrap() {
        let name = entry.unwrap().file_name();
        let [one, other] = [&path, &again].map(|own| fs::read(own.join(&name)).unwrap());
        assert!(one == other, "{name:?}");
    }
}

#[test]
fn every_compression_can_be_read() {
    let directory = tempfile::tempdir().unwrap();
    let mut sizes = Vec::new();
    for compression in [
        ChunkCompression::None,
        ChunkCompression::Lz4,
        ChunkCompression::Zstd,
    ] {
        let path = directory.path().join(format!("{compression:?}"));
        let mut writer = BagWriter::create(
            &path,
            BagOptions {
                compression,
                ..options()
            },
        )
        .unwrap();
        record(&mut writer, 0..100).unwrap();
        sizes.push(writer.finish().unwrap().bytes);
        let reader = BagReader::open(&path).unwrap();
        assert!(reader.raw().all(|message| message.is_ok()));
        assert_eq!(reader.raw().count(), 100 * topic_count());
    }
    assert!(sizes[0] > sizes[1] && sizes[1] > sizes[2], "{sizes:?}");
}

#[test]
fn a_directory_that_holds_something_is_not_touched() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 3).unwrap();
    let before = fs::read(path.join("run_0.mcap")).unwrap();
    let error = BagWriter::create(&path, BagOptions::default())
        .err()
        .unwrap();
    assert!(matches!(error, CreateBagError::NotEmpty { .. }), "{error}");
    assert!(error.to_string().contains("run exists and is not empty"));
    assert_eq!(fs::read(path.join("run_0.mcap")).unwrap(), before);

    let file = directory.path().join("file");
    fs::write(&file, "x").unwrap();
    let error = BagWriter::create(&file.join("run"), BagOptions::default())
        .err()
        .unwrap();
    assert!(matches!(error, CreateBagError::Io { .. }), "{error}");
    let error = BagWriter::create("/".as_ref(), BagOptions::default())
        .err()
        .unwrap();
    assert!(matches!(error, CreateBagError::NoName { .. }), "{error}");
}

#[test]
fn a_recording_without_messages_can_be_read() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    let mut writer = BagWriter::create(&path, BagOptions::default()).unwrap();
    writer.topic(FOLLOWER_MEASURED_JS).unwrap();
    let summary = writer.finish().unwrap();
    assert_eq!((summary.messages, summary.start), (0, None));
    let reader = BagReader::open(&path).unwrap();
    assert_eq!(
        reader
            .messages::<JointSample>("/follower/measured_js")
            .unwrap()
            .count(),
        0
    );
    assert_eq!(reader.bounds(), None);
}

#[test]
fn what_does_not_fit_is_refused_and_the_recording_goes_on() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    let mut writer = BagWriter::create(&path, BagOptions::default()).unwrap();
    let joints = writer.topic(FOLLOWER_MEASURED_JS).unwrap();
    let poses = writer.topic(LEADER_MEASURED_CP).unwrap();
    assert_eq!(writer.topic(FOLLOWER_MEASURED_JS).unwrap(), joints);

    let stolen = Topic::<PoseSample>::new(FOLLOWER_MEASURED_JS.name, Delivery::Stream);
    let error = writer.topic(stolen).unwrap_err();
    assert!(matches!(error, WriteBagError::WrongType { .. }), "{error}");
    let message = joint(0.0, START);
    let error = writer.write(poses, START, START, &message).unwrap_err();
    assert!(matches!(error, WriteBagError::WrongType { .. }), "{error}");
    for bad in [Time::INVALID, Time::from_nanos(-5)] {
        let error = writer.write(joints, bad, START, &message).unwrap_err();
        assert!(matches!(error, WriteBagError::NoTime { .. }), "{error}");
    }
    writer.write(joints, START, START, &message).unwrap();
    assert_eq!(writer.finish().unwrap().messages, 1);

    let other = directory.path().join("other");
    let mut other = BagWriter::create(&other, BagOptions::default()).unwrap();
    let error = other.write(poses, START, START, &message).unwrap_err();
    assert!(
        matches!(error, WriteBagError::UnknownChannel { .. }),
        "{error}"
    );
}

#[test]
fn a_dropped_writer_closes_its_recording() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    let mut writer = BagWriter::create(&path, options()).unwrap();
    record(&mut writer, 0..5).unwrap();
    drop(writer);
    assert_eq!(
        BagReader::open(&path).unwrap().raw().count(),
        5 * topic_count()
    );
    assert!(path.join("metadata.yaml").exists());
}

#[test]
fn a_killed_recording_has_lost_half_a_second_at_most() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    let mut writer = BagWriter::create(&path, options()).unwrap();
    record(&mut writer, 0..1000).unwrap();
    // As if killed: nothing more is written, nothing is closed. But what it took goes to the disk
    // behind it, and a second of messages was written at once here.
    std::mem::forget(writer);
    let length = || -> u64 {
        let files = fs::read_dir(&path).unwrap();
        files
            .map(|own| own.unwrap().metadata().unwrap().len())
            .sum()
    };
    let mut last = 0;
    while last < length() {
        last = length();
        std::thread::sleep(std::time::Duration::from_millis(300));
    }
    let error = BagReader::open(&path).unwrap_err();
    assert!(matches!(error, OpenBagError::Truncated { .. }), "{error}");
    assert!(error.to_string().contains("ferntast bag repair"), "{error}");

    let report = ferntast_bag::repair(&path, None).unwrap();
    assert!(
        (950 * topic_count() as u64..1000 * topic_count() as u64).contains(&report.messages),
        "{}",
        report.messages
    );
}

#[test]
fn wrong_topics_and_types_are_refused_by_name() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run");
    write_sample_bag(&path, 2).unwrap();
    let reader = BagReader::open(&path).unwrap();
    match reader
        .messages::<JointSample>("/follower/measured_jp")
        .unwrap_err()
    {
        SelectTopicError::NoSuchTopic { topic, available } => {
            assert_eq!(topic, "/follower/measured_jp");
            assert!(available.contains(&"/follower/measured_js".to_owned()));
        }
        error => panic!("{error}"),
    }
    let error = reader
        .messages::<JointSample>("/leader/servo_cf")
        .unwrap_err();
    assert!(
        matches!(error, SelectTopicError::WrongType { .. }),
        "{error}"
    );
    assert!(
        error
            .to_string()
            .contains("geometry_msgs/msg/WrenchStamped"),
        "{error}"
    );
    assert!(reader.raw_topics(&["/nowhere"], START).is_err());
    assert_eq!(
        reader
            .raw_topics(&["/diagnostics"], log_time(1))
            .unwrap()
            .count(),
        1
    );
}

//! What a recording holds.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ferntast_msgs::Time;
use serde::Serialize;

use super::{
    directory::bag_files,
    error::{InfoError, ReadMessageError},
    layout::Layout,
    metadata::METADATA_FILE,
    reader::BagReader,
    topic::BagTopic,
};

/// An interval without a message is a gap when it is that many times the
/// topic's median interval …
const GAP_FACTOR: i64 = 5;

/// … and longer than this \[ns\] …
const SHORTEST_GAP: i64 = 100_000_000;

/// … on a topic with at least so many messages.
const MIN_MESSAGES: usize = 10;

/// So many gaps of a topic are listed, the longest first.
const LISTED_GAPS: usize = 10;

/// What a recording holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BagInfo {
    /// The rosbag2 directory or MCAP file.
    pub path: PathBuf,
    /// Its MCAP files.
    pub files: Vec<FileInfo>,
    /// Size of all files \[bytes\].
    pub bytes: u64,
    /// Whether every file was closed, and `metadata.yaml` written if this is
    /// a directory.
    pub closed: bool,
    /// Where files are broken; empty for a recording that is whole.
    pub breaks: Vec<Break>,
    /// Messages that can be read.
    pub messages: u64,
    /// Log time of the first message.
    pub start: Option<Time>,
    /// Log time of the last message.
    pub end: Option<Time>,
    /// From the first message to the last \[s\].
    pub duration_s: f64,
    /// The topics, in the order of the files.
    pub topics: Vec<TopicInfo>,
    /// Metadata records by name.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
}

/// One MCAP file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileInfo {
    /// The file.
    pub path: PathBuf,
    /// Its size \[bytes\].
    pub bytes: u64,
    /// Whether it was closed.
    pub closed: bool,
}

/// A place where a file is broken.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Break {
    /// The file.
    pub path: PathBuf,
    /// Where \[byte\].
    pub offset: u64,
    /// What is wrong there.
    pub reason: String,
}

/// One topic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TopicInfo {
    /// Its name.
    pub name: String,
    /// Its type, `package/msg/Type`.
    pub interface: String,
    /// Messages that can be read.
    pub messages: u64,
    /// Messages a second between the first and the last \[Hz\]; 0 with fewer
    /// than two.
    pub rate_hz: f64,
    /// Log time of the first message.
    pub start: Option<Time>,
    /// Log time of the last message.
    pub end: Option<Time>,
    /// Longest interval between two messages \[s\].
    pub longest_interval_s: f64,
    /// Number of gaps: intervals more than 5 times the median one and longer
    /// than 0.1 s, on a topic with 10 messages or more.
    pub gap_count: usize,
    /// The ten longest gaps, the longest first.
    pub gaps: Vec<Gap>,
}

/// An interval in which a topic was silent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// Log time of the last message before.
    pub start: Time,
    /// How long \[s\].
    pub duration_s: f64,
}

/// Says what the recording at `path` holds, whole or not. Every message's
/// header is looked at, and the checksums with them.
///
/// # Errors
///
/// [`InfoError`] when there is nothing that could be read in part.
pub fn info(path: &Path) -> Result<BagInfo, InfoError> {
    let mut layouts = Vec::new();
    for file in bag_files(path)? {
        layouts.push(Layout::salvage(&file)?);
    }
    let files: Vec<FileInfo> = layouts
        .iter()
        .map(|layout| FileInfo {
            path: layout.path.clone(),
            bytes: layout.length,
            closed: layout.closed,
        })
        .collect();
    let mut breaks: Vec<Break> = layouts.iter().flat_map(breaks_of).collect();
    let reader = BagReader::over(path, layouts);

    let mut times: BTreeMap<&str, Vec<Time>> = BTreeMap::new();
    let mut raw = reader.raw();
    let mut messages = 0;
    let mut bounds: Option<(Time, Time)> = None;
    let names: BTreeMap<String, &str> = reader
        .topics()
        .map(|topic| (topic.name.clone(), topic.name.as_str()))
        .collect();
    for message in &mut raw {
        match message {
            Ok(message) => {
                messages += 1;
                let (first, last) = bounds.unwrap_or((message.log_time, message.log_time));
                bounds = Some((first.min(message.log_time), last.max(message.log_time)));
                if let Some(name) = names.get(&message.topic.name) {
                    times.entry(name).or_default().push(message.log_time);
                }
            }
            Err(error) => breaks.push(break_of(path, error)),
        }
    }
    let mut seen = Vec::new();
    let mut topics = Vec::new();
    for topic in reader.topics() {
        if !seen.contains(&topic.name.as_str()) {
            seen.push(&topic.name);
            let times = times
                .get(topic.name.as_str())
                .map_or(&[][..], Vec::as_slice);
            topics.push(topic_info(topic, times));
        }
    }
    let has_metadata = !path.is_dir() || path.join(METADATA_FILE).exists();
    Ok(BagInfo {
        path: path.to_owned(),
        bytes: files.iter().map(|file| file.bytes).sum(),
        closed: has_metadata && files.iter().all(|file| file.closed),
        files,
        breaks,
        messages,
        start: bounds.map(|(first, _)| first),
        end: bounds.map(|(_, last)| last),
        duration_s: bounds.map_or(0.0, |(first, last)| last.seconds_since(first)),
        topics,
        metadata: reader.metadata(),
    })
}

/// The places where a file is known to be broken.
pub(crate) fn breaks_of(layout: &Layout) -> Vec<Break> {
    layout
        .faults
        .iter()
        .map(|fault| Break {
            path: layout.path.clone(),
            offset: fault.offset,
            reason: fault.reason.clone(),
        })
        .collect()
}

fn break_of(path: &Path, error: ReadMessageError) -> Break {
    match error {
        ReadMessageError::Damaged {
            path,
            offset,
            reason,
        } => Break {
            path,
            offset,
            reason,
        },
        error => Break {
            path: path.to_owned(),
            offset: 0,
            reason: error.to_string(),
        },
    }
}

/// `times` in ascending order.
fn topic_info(topic: &BagTopic, times: &[Time]) -> TopicInfo {
    let start = times.first().copied();
    let end = times.last().copied();
    let duration = match (start, end) {
        (Some(start), Some(end)) => end.seconds_since(start),
        _ => 0.0,
    };
    let intervals: Vec<(i64, Time)> = times
        .windows(2)
        .map(|pair| (pair[1].nanos_since(pair[0]), pair[0]))
        .collect();
    let mut sorted: Vec<i64> = intervals.iter().map(|(interval, _)| *interval).collect();
    sorted.sort_unstable();
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0);
    let shortest = median.saturating_mul(GAP_FACTOR).max(SHORTEST_GAP);
    let mut gaps: Vec<(i64, Time)> = intervals
        .into_iter()
        .filter(|(interval, _)| times.len() >= MIN_MESSAGES && *interval > shortest)
        .collect();
    gaps.sort_by_key(|&(interval, start)| (std::cmp::Reverse(interval), start));
    TopicInfo {
        name: topic.name.clone(),
        interface: topic.schema_name.clone(),
        messages: times.len() as u64,
        rate_hz: if duration > 0.0 {
            (times.len() - 1) as f64 / duration
        } else {
            0.0
        },
        start,
        end,
        longest_interval_s: sorted
            .last()
            .map_or(0.0, |&interval| interval as f64 * 1e-9),
        gap_count: gaps.len(),
        gaps: gaps
            .iter()
            .take(LISTED_GAPS)
            .map(|&(interval, start)| Gap {
                start,
                duration_s: interval as f64 * 1e-9,
            })
            .collect(),
    }
}

//! How to record, and what was recorded.

use std::{collections::BTreeMap, path::PathBuf};

use ferntast_msgs::Time;
use serde::{Deserialize, Serialize};

/// How a chunk of a recording is compressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ChunkCompression {
    /// Not at all.
    None,
    /// By zstd at its usual level.
    #[default]
    Zstd,
    /// By lz4: larger and faster.
    Lz4,
}

/// How to record.
#[derive(Clone, Debug, PartialEq)]
pub struct BagOptions {
    /// A chunk is closed when it holds that much before compression \[bytes\].
    pub chunk_size: u64,
    /// A chunk is closed, and handed to the system, at the latest when its
    /// first message is that old in log time \[ns\]: more than that is not
    /// lost when the process is killed.
    pub flush_interval_ns: u64,
    /// When a file has grown so large \[bytes\] the recording goes on in another, as
    /// rosbag2's `max_bagfile_size` has it; a file's index is kept in memory until then.
    pub max_file_size: u64,
    /// How chunks are compressed.
    pub compression: ChunkCompression,
    /// Metadata records by name, each a map: the scenario's text, the
    /// program's version and the like. They stand in the MCAP file under
    /// their name, and in `custom_data` of `metadata.yaml` as `name.key`.
    pub custom: BTreeMap<String, BTreeMap<String, String>>,
    /// The ROS 2 distribution that the recording is made with.
    pub ros_distro: String,
}

impl Default for BagOptions {
    /// Chunks of 1 MiB or half a second, zstd, files of 128 MiB, Jazzy.
    fn default() -> Self {
        BagOptions {
            chunk_size: 1 << 20,
            flush_interval_ns: 500_000_000,
            max_file_size: 128 << 20,
            compression: ChunkCompression::Zstd,
            custom: BTreeMap::new(),
            ros_distro: "jazzy".to_owned(),
        }
    }
}

/// What was recorded.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BagSummary {
    /// The rosbag2 directory.
    pub path: PathBuf,
    /// Size of its MCAP files \[bytes\].
    pub bytes: u64,
    /// Messages on all topics.
    pub messages: u64,
    /// Log time of the first message; `None` without one.
    pub start: Option<Time>,
    /// Log time of the last message; `None` without one.
    pub end: Option<Time>,
    /// Messages by topic, in the order of registration.
    pub topics: Vec<TopicCount>,
}

/// Messages on one topic.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TopicCount {
    /// The topic.
    pub topic: String,
    /// Interface name, `package/msg/Type`.
    pub interface: String,
    /// Messages recorded.
    pub messages: u64,
}

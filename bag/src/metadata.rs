//! `metadata.yaml` of a rosbag2 directory.
//!
//! It is written as text in the form that rosbag2 gives it: a serializer of
//! YAML would need more lines of structures, one for each of the nested maps.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::qos::{QosProfile, indented, to_yaml};

/// The file's name in a rosbag2 directory.
pub(crate) const METADATA_FILE: &str = "metadata.yaml";

/// rosbag2's format of the metadata that is written (Jazzy, Kilted).
const VERSION: u32 = 9;

/// The newest format that is read.
pub(crate) const NEWEST_VERSION: u32 = 9;

/// What `metadata.yaml` says of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BagMetadata {
    pub(crate) files: Vec<FileEntry>,
    pub(crate) topics: Vec<TopicEntry>,
    pub(crate) custom_data: BTreeMap<String, String>,
    pub(crate) ros_distro: String,
}

/// One MCAP file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FileEntry {
    /// Name, relative to the directory.
    pub(crate) name: String,
    /// First and last log time; `None` without a message \[ns\].
    pub(crate) bounds: Option<(u64, u64)>,
    pub(crate) messages: u64,
}

/// One topic.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TopicEntry {
    pub(crate) name: String,
    pub(crate) schema_name: String,
    pub(crate) message_encoding: String,
    pub(crate) qos: Vec<QosProfile>,
    pub(crate) type_hash: String,
    pub(crate) messages: u64,
}

/// First and last of several bounds.
pub(crate) fn join_bounds(
    bounds: impl IntoIterator<Item = Option<(u64, u64)>>,
) -> Option<(u64, u64)> {
    bounds
        .into_iter()
        .flatten()
        .reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)))
}

impl BagMetadata {
    /// The content of `metadata.yaml`.
    pub(crate) fn to_file(&self) -> String {
        let content = indented(&self.to_yaml(), 2);
        format!("rosbag2_bagfile_information:\n{content}")
    }

    /// The same without the outermost key, as in the MCAP record `rosbag2`.
    pub(crate) fn to_yaml(&self) -> String {
        let messages: u64 = self.files.iter().map(|file| file.messages).sum();
        let (start, duration) = times(join_bounds(self.files.iter().map(|file| file.bounds)));
        let topics = self.topics.iter().map(TopicEntry::to_yaml).collect();
        let path = |file: &FileEntry| format!("  - {}\n", scalar(&file.name));
        let paths = self.files.iter().map(path).collect();
        let files = self.files.iter().map(FileEntry::to_yaml).collect();
        let entry =
            |(key, value): (&String, &String)| format!("  {}: {}\n", quoted(key), quoted(value));
        let custom_data = self.custom_data.iter().map(entry).collect();
        [
            format!("version: {VERSION}\nstorage_identifier: mcap\n"),
            format!("{duration}{start}message_count: {messages}\n"),
            block("topics_with_message_count", topics, "[]"),
            "compression_format: \"\"\ncompression_mode: \"\"\n".to_owned(),
            block("relative_file_paths", paths, "[]"),
            block("files", files, "[]"),
            block("custom_data", custom_data, "~"),
            format!("ros_distro: {}\n", scalar(&self.ros_distro)),
        ]
        .concat()
    }
}

impl TopicEntry {
    fn to_yaml(&self) -> String {
        let metadata = [
            format!("name: {}\n", scalar(&self.name)),
            format!("type: {}\n", scalar(&self.schema_name)),
            format!("serialization_format: {}\n", scalar(&self.message_encoding)),
            block(
                "offered_qos_profiles",
                indented(&to_yaml(&self.qos), 2),
                "[]",
            ),
            format!("type_description_hash: {}\n", scalar(&self.type_hash)),
        ]
        .concat();
        let metadata = indented(&metadata, 6);
        let messages = self.messages;
        format!("  - topic_metadata:\n{metadata}    message_count: {messages}\n")
    }
}

impl FileEntry {
    fn to_yaml(&self) -> String {
        let (start, duration) = times(self.bounds);
        let times = indented(&format!("{start}{duration}"), 4);
        let (name, messages) = (scalar(&self.name), self.messages);
        format!("  - path: {name}\n{times}    message_count: {messages}\n")
    }
}

/// A list or map behind its key; `empty` stands for one without `lines`.
fn block(key: &str, lines: String, empty: &str) -> String {
    if lines.is_empty() {
        return format!("{key}: {empty}\n");
    }
    format!("{key}:\n{lines}")
}

/// Start and duration; rosbag2 writes the largest number as start of nothing.
fn times(bounds: Option<(u64, u64)>) -> (String, String) {
    let (start, last) = bounds.unwrap_or((i64::MAX as u64, 0));
    let duration = last.saturating_sub(start);
    (
        format!("starting_time:\n  nanoseconds_since_epoch: {start}\n"),
        format!("duration:\n  nanoseconds: {duration}\n"),
    )
}

/// Plain where YAML reads it as a text for sure, else quoted.
fn scalar(text: &str) -> String {
    let plain = text.starts_with(|c: char| c == '/' || c.is_ascii_alphabetic())
        && text
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "/_.-".contains(c))
        && !["true", "false", "yes", "no", "on", "off", "null", "y", "n"]
            .contains(&text.to_ascii_lowercase().as_str());
    if plain { text.to_owned() } else { quoted(text) }
}

/// In double quotes: JSON's escapes are YAML's.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// What a reader needs of `metadata.yaml`.
#[derive(Debug, Deserialize)]
pub(crate) struct FileList {
    rosbag2_bagfile_information: Information,
}

#[derive(Debug, Deserialize)]
struct Information {
    version: u32,
    storage_identifier: String,
    #[serde(default)]
    compression_mode: Option<String>,
    relative_file_paths: Vec<String>,
}

impl FileList {
    /// The names of the recording's files, in order.
    ///
    /// # Errors
    ///
    /// What is wrong with the text, or what it asks for that is not
    /// supported.
    pub(crate) fn parse(text: &str) -> Result<Vec<String>, String> {
        let list: FileList = serde_saphyr::from_str(text).map_err(|error| error.to_string())?;
        let information = list.rosbag2_bagfile_information;
        if information.version > NEWEST_VERSION {
            return Err(format!(
                "version {} is newer than {NEWEST_VERSION}, the newest that is known",
                information.version
            ));
        }
        if information.storage_identifier != "mcap" {
            return Err(format!(
                "the storage is {:?}; convert the recording to mcap with `ros2 bag convert` or `rosbags-convert`",
                information.storage_identifier
            ));
        }
        let mode = information.compression_mode.unwrap_or_default();
        if !mode.is_empty() && !mode.eq_ignore_ascii_case("none") {
            return Err(format!(
                "compression by {mode} is not supported (compression by chunk is); convert the recording with `ros2 bag convert`"
            ));
        }
        if information.relative_file_paths.is_empty() {
            return Err("relative_file_paths names no file".to_owned());
        }
        information
            .relative_file_paths
            .iter()
            .map(|path| {
                // As rosbag2 and rosbags do: the directory may have moved, and
                // old formats repeat its name in front.
                let name = path.rsplit('/').next().unwrap_or_default();
                if name.is_empty() || name == ".." {
                    return Err(format!(
                        "relative_file_paths has {path:?}, which names no file"
                    ));
                }
                Ok(name.to_owned())
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use ferntast_msgs::topics::Delivery;

    use super::*;

    fn sample() -> BagMetadata {
        BagMetadata {
            files: vec![FileEntry {
                name: "run_0.mcap".to_owned(),
                bounds: Some((100, 350)),
                messages: 3,
            }],
            topics: vec![TopicEntry {
                name: "/link/status".to_owned(),
                schema_name: "ferntast_msgs/msg/LinkStatus".to_owned(),
                message_encoding: "cdr".to_owned(),
                qos: vec![QosProfile::for_delivery(Delivery::Stream)],
                type_hash: "RIHS01_00".to_owned(),
                messages: 3,
            }],
            custom_data: BTreeMap::from([("a \"b\"".to_owned(), "1: x\n# y\n".to_owned())]),
            ros_distro: "jazzy".to_owned(),
        }
    }

    #[test]
    fn what_is_written_is_yaml_with_every_field_in_place() {
        let value: serde_json::Value = serde_saphyr::from_str(&sample().to_file()).unwrap();
        let bag = &value["rosbag2_bagfile_information"];
        assert_eq!(bag["version"], 9);
        assert_eq!(bag["duration"]["nanoseconds"], 250);
        assert_eq!(bag["starting_time"]["nanoseconds_since_epoch"], 100);
        assert_eq!(bag["message_count"], 3);
        let topic = &bag["topics_with_message_count"][0];
        assert_eq!(topic["message_count"], 3);
        assert_eq!(
            topic["topic_metadata"]["type"],
            "ferntast_msgs/msg/LinkStatus"
        );
        let qos = &topic["topic_metadata"]["offered_qos_profiles"][0];
        assert_eq!(qos["reliability"], "best_effort");
        assert_eq!(qos["lifespan"]["nsec"], 854_775_807);
        assert_eq!(bag["files"][0]["path"], "run_0.mcap");
        assert_eq!(bag["files"][0]["duration"]["nanoseconds"], 250);
        assert_eq!(bag["custom_data"]["a \"b\""], "1: x\n# y\n");
    }

    #[test]
    fn the_file_list_is_read_back() {
        assert_eq!(
            FileList::parse(&sample().to_file()).unwrap(),
            ["run_0.mcap"]
        );
    }

    #[test]
    fn a_recording_without_messages_is_yaml() {
        let value: serde_json::Value =
            serde_saphyr::from_str(&BagMetadata::default().to_file()).unwrap();
        let bag = &value["rosbag2_bagfile_information"];
        assert_eq!(bag["duration"]["nanoseconds"], 0);
        assert_eq!(bag["topics_with_message_count"], serde_json::json!([]));
    }

    #[test]
    fn what_cannot_be_read_says_why() {
        let text = |storage: &str, version: u32, paths: &str| {
            format!(
                "rosbag2_bagfile_information:\n  version: {version}\n  storage_identifier: {storage}\n  relative_file_paths: {paths}\n"
            )
        };
        let refused = |text: String| FileList::parse(&text).unwrap_err();
        assert!(refused(text("sqlite3", 5, "[a.db3]")).contains("convert"));
        assert!(refused(text("mcap", 99, "[a.mcap]")).contains("99"));
        assert!(refused(text("mcap", 9, "[]")).contains("no file"));
        assert!(refused(text("mcap", 9, "['..']")).contains("names no file"));
        assert!(!refused("][".to_owned()).is_empty());
        assert_eq!(
            FileList::parse(&text("mcap", 2, "[old/a.mcap, /tmp/b.mcap]")).unwrap(),
            ["a.mcap", "b.mcap"]
        );
    }
}

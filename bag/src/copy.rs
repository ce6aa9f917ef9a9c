//! Copying what can be read of a file into a new one.

use std::{collections::BTreeMap, fs, io, path::Path};

use mcap::records::MessageHeader;
use serde::Deserialize;

use super::{
    block::{BlockError, decode},
    error::WriteBagError,
    file_writer::FileWriter,
    info::{Break, breaks_of},
    layout::Layout,
    metadata::{BagMetadata, FileEntry, TopicEntry},
    options::BagOptions,
    rosbag2_record::{ROSBAG2_RECORD, custom_data, rosbag2_record},
    topic::topic_of,
};

/// Copies all readable messages into a new file at `part`, which is to be
/// named `target`.
pub(crate) fn copy(
    layout: &Layout,
    target: &Path,
    part: &Path,
) -> Result<(Vec<Break>, BagMetadata), WriteBagError> {
    let io_error = |error: io::Error| WriteBagError::Io {
        path: part.to_owned(),
        reason: error.to_string(),
    };
    match fs::remove_file(part) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(io_error(error)),
        _ => {}
    }
    let mut breaks = breaks_of(layout);
    let mut writer = FileWriter::create(part, &BagOptions::default()).map_err(io_error)?;
    let mut custom = BTreeMap::new();
    for record in layout
        .metadata
        .iter()
        .filter(|record| record.name != ROSBAG2_RECORD)
    {
        writer.metadata(record)?;
        custom.insert(record.name.clone(), record.metadata.clone());
    }
    let mut channels = BTreeMap::new();
    for channel in layout.channels.values() {
        let schema = match layout.schemas.get(&channel.schema_id) {
            Some(schema) => writer.schema(&schema.name, &schema.encoding, &schema.data)?,
            None => 0,
        };
        let id = writer.channel(
            schema,
            &channel.topic,
            &channel.message_encoding,
            &channel.metadata,
        )?;
        channels.insert(channel.id, id);
    }
    for block in &layout.blocks {
        let decoded = match decode(&layout.file, block, &mut Vec::new()) {
            Ok(decoded) => decoded,
            Err(BlockError::Io(error)) => return Err(io_error(error)),
            Err(BlockError::Fault(fault)) => {
                breaks.push(Break {
                    path: layout.path.clone(),
                    offset: fault.offset,
                    reason: fault.reason,
                });
                continue;
            }
        };
        for entry in &decoded.entries {
            // Without a description nobody could read it.
            let Some(&channel_id) = channels.get(&entry.header.channel_id) else {
                continue;
            };
            let header = MessageHeader {
                channel_id,
                ..entry.header
            };
            writer.message(&header, decoded.data(entry))?;
        }
    }
    let metadata = BagMetadata {
        files: vec![FileEntry {
            name: file_name(target),
            ..writer.entry()
        }],
        topics: topics(layout, &channels, writer.counts()),
        custom_data: custom_data(&custom),
        ros_distro: ros_distro(layout),
    };
    writer.metadata(&rosbag2_record(&metadata))?;
    writer.finish()?;
    Ok((breaks, metadata))
}

fn topics(
    layout: &Layout,
    channels: &BTreeMap<u16, u16>,
    counts: &BTreeMap<u16, u64>,
) -> Vec<TopicEntry> {
    let mut topics: Vec<TopicEntry> = Vec::new();
    let mut counted = Vec::new();
    for (old, new) in channels {
        let Some(topic) = topic_of(layout, *old).filter(|_| !counted.contains(new)) else {
            continue;
        };
        counted.push(*new);
        add_topic(
            &mut topics,
            TopicEntry {
                name: topic.name,
                schema_name: topic.schema_name,
                message_encoding: topic.message_encoding,
                qos: topic.offered_qos,
                type_hash: topic.type_hash,
                messages: counts.get(new).copied().unwrap_or(0),
            },
        );
    }
    topics
}

/// Several channels of one topic are one entry.
fn add_topic(topics: &mut Vec<TopicEntry>, topic: TopicEntry) {
    match topics.iter_mut().find(|known| known.name == topic.name) {
        Some(known) => known.messages += topic.messages,
        None => topics.push(topic),
    }
}

/// What two files say together.
pub(crate) fn join(mut first: BagMetadata, second: BagMetadata) -> BagMetadata {
    first.files.extend(second.files);
    for topic in second.topics {
        add_topic(&mut first.topics, topic);
    }
    first.custom_data.extend(second.custom_data);
    first
}

/// The distribution that rosbag2's record names; empty without one.
fn ros_distro(layout: &Layout) -> String {
    #[derive(Deserialize)]
    struct Named {
        #[serde(default)]
        ros_distro: Option<String>,
    }
    let records = layout
        .metadata
        .iter()
        .rev()
        .filter(|record| record.name == ROSBAG2_RECORD);
    records
        .filter_map(|record| record.metadata.get("serialized_metadata"))
        .filter_map(|text| serde_saphyr::from_str::<Named>(text).ok()?.ros_distro)
        .next()
        .unwrap_or_default()
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default()
}

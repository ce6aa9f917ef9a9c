//! rosbag2's own record in an MCAP file: what `metadata.yaml` says, of that file alone. It
//! begins the file, without counts, and ends it.

use std::collections::BTreeMap;

use mcap::records::Metadata;

use super::{error::FinishBagError, file_writer::FileWriter, metadata::BagMetadata};

/// Writes what `metadata` says of the file into it, and closes it; gives its bytes.
pub(crate) fn finish_file(
    file: &mut FileWriter,
    metadata: &BagMetadata,
) -> Result<u64, FinishBagError> {
    file.metadata(&rosbag2_record(metadata))
        .and_then(|()| file.finish())
        .map_err(|source| FinishBagError::File {
            path: file.path().to_owned(),
            source,
        })
}

/// rosbag2's own record inside the MCAP file.
pub(crate) fn rosbag2_record(metadata: &BagMetadata) -> Metadata {
    Metadata {
        name: ROSBAG2_RECORD.to_owned(),
        metadata: BTreeMap::from([("serialized_metadata".to_owned(), metadata.to_yaml())]),
    }
}

/// The name of that record.
pub(crate) const ROSBAG2_RECORD: &str = "rosbag2";

/// Metadata records in one map, `name.key`.
pub(crate) fn custom_data(
    records: &BTreeMap<String, BTreeMap<String, String>>,
) -> BTreeMap<String, String> {
    records
        .iter()
        .flat_map(|(name, entries)| {
            entries
                .iter()
                .map(move |(key, value)| (format!("{name}.{key}"), value.clone()))
        })
        .collect()
}

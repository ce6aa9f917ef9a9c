//! The numbers of a recording that a signal can be.

use ferntast_bus::mcap::{BagReader, RawMessage};
use ferntast_msgs::Time;

use crate::schema::{Layout, Reader, numeric_paths};

/// The paths of all numbers in the recording, arrays as long as in the first
/// message of their topic. Topics that cannot be read are left out.
pub(crate) fn numbers_of(bag: &BagReader) -> Vec<String> {
    let mut paths = Vec::new();
    for topic in bag.topics() {
        let encodings = (topic.schema_encoding.as_str(), topic.schema_text.as_str());
        let Ok(layout) = Layout::of_schema(&topic.schema_name, encodings.0, encodings.1) else {
            continue;
        };
        let from = Time::from_nanos(0);
        let first = bag
            .raw_topics(&[topic.name.as_str()], from)
            .ok()
            .and_then(|mut messages| messages.next()?.ok());
        let bytes = first.as_ref().map(RawMessage::bytes);
        paths.extend(numeric_paths(&mut Reader::new(layout), &topic.name, bytes));
    }
    paths
}

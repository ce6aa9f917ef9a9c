//! The numbers of a recording that a signal can be.

use ferntast_bag::{BagReader, RawMessage};
use ferntast_msgs::Time;

use crate::schema::{Layout, Reader, numeric_paths};

/// The arrays of an arm's joints in the recording, which say by names of which: those of
/// `sensor_msgs/JointState`.
pub(crate) fn joint_arrays_of(bag: &BagReader) -> Vec<String> {
    let states = bag.topics().filter(|topic| {
        let name = topic.schema_name.as_str();
        name == "sensor_msgs/msg/JointState" || name == "sensor_msgs/JointState"
    });
    let arrays = states.flat_map(|topic| {
        ["position", "velocity", "effort"].map(|array| format!("{}.{array}", topic.name))
    });
    arrays.collect()
}

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

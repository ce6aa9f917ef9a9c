//! A topic of a recording, as the recording tells of it.

use ferntast_msgs::Time;

use super::{layout::Layout, qos::QosProfile};

/// A topic of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct BagTopic {
    /// Its name.
    pub name: String,
    /// Name of its type, for ROS 2 `package/msg/Type`; empty without a schema.
    pub schema_name: String,
    /// How the schema is written: `ros2msg`, `ros2idl`.
    pub schema_encoding: String,
    /// The schema, with all types that it uses.
    pub schema_text: String,
    /// How messages are written: `cdr`.
    pub message_encoding: String,
    /// RIHS01 hash of the type; empty where the recording has none.
    pub type_hash: String,
    /// What publishers offered; empty where the recording does not say.
    pub offered_qos: Vec<QosProfile>,
}

/// The topic of a channel.
pub(crate) fn topic_of(layout: &Layout, channel: u16) -> Option<BagTopic> {
    let channel = layout.channels.get(&channel)?;
    let schema = layout.schemas.get(&channel.schema_id);
    let entry = |key: &str| channel.metadata.get(key).cloned().unwrap_or_default();
    Some(BagTopic {
        name: channel.topic.clone(),
        schema_name: schema.map(|schema| schema.name.clone()).unwrap_or_default(),
        schema_encoding: schema
            .map(|schema| schema.encoding.clone())
            .unwrap_or_default(),
        schema_text: schema
            .map(|schema| String::from_utf8_lossy(&schema.data).into_owned())
            .unwrap_or_default(),
        message_encoding: channel.message_encoding.clone(),
        type_hash: entry("topic_type_hash"),
        offered_qos: QosProfile::parse(&entry("offered_qos_profiles")),
    })
}

/// MCAP's time; what does not fit is the end of all time.
pub(crate) fn time(nanos: u64) -> Time {
    Time::from_nanos(i64::try_from(nanos).unwrap_or(i64::MAX))
}

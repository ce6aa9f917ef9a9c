//! Bytes in place of a message type.
//!
//! hiroz decodes for itself when it knows the type; here it only carries
//! bytes, so that the bounds of [`crate::cdr`] hold for all that comes in.

use ferntast_msgs::{Message, RosMessage, interface};
use hiroz::{
    entity::{TypeHash, TypeInfo},
    msg::{SerdeCdrSerdes, ZMessage},
};
use serde::{Deserialize, Serialize};

/// Stands for whatever type the topic carries; never a value on the wire.
#[derive(Serialize, Deserialize)]
pub(super) struct Raw;

impl ZMessage for Raw {
    type Serdes = SerdeCdrSerdes<Raw>;
}

/// Name and hash of the topic's ROS 2 type, as they stand in its key.
pub(super) fn type_info<M: Message>() -> Result<TypeInfo, String> {
    let interface = M::Ros::INTERFACE;
    let (package, kind) = interface
        .split_once("/msg/")
        .ok_or_else(|| format!("{interface} is not of the form package/msg/Type"))?;
    let text = interface::type_hash(interface).map_err(|error| error.to_string())?;
    let hash = TypeHash::from_rihs_string(&text)
        .ok_or_else(|| format!("{text} is no RIHS01 type hash"))?;
    Ok(TypeInfo::new(
        &format!("{package}::msg::dds_::{kind}_"),
        hash,
    ))
}

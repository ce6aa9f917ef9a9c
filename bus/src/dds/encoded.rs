//! A message in CDR, in place of a message type.
//!
//! Messages are encoded before, so that what ros2-client and RustDDS make of a type is compiled
//! once.

use ferntast_msgs::cdr;
use serde::{Serialize, Serializer, ser::SerializeTuple};

/// With its header, which RustDDS writes itself. To the serializer of ros2-client the rest is a
/// tuple of octets, which CDR writes as they are, one after the other.
#[derive(Clone)]
pub(super) struct Encoded(pub(super) Vec<u8>);

impl Serialize for Encoded {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let body = cdr::body(&self.0);
        let mut tuple = serializer.serialize_tuple(body.len())?;
        for byte in body {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

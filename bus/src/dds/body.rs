//! The body of a message, in place of a message type.
//!
//! Messages are encoded before, so that what ros2-client and RustDDS make of a type is compiled
//! once.

use serde::{Serialize, Serializer, ser::SerializeTuple};

/// What follows the header in CDR. To the serializer of ros2-client it is a tuple of octets,
/// which CDR writes as they are, one after the other.
#[derive(Clone)]
pub(super) struct Body(pub(super) Vec<u8>);

impl Serialize for Body {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

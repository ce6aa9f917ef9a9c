//! What can go wrong between a schema and its messages.

use ferntast_msgs::interface::InterfaceError;

/// Why the messages of a topic cannot be understood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SchemaError {
    /// The schema is written in a language that is not read.
    #[error(
        "its schema is written as {encoding:?}, and only \"ros2msg\" is read; record it with rosbag2's mcap storage, or convert it with `ros2 bag convert`"
    )]
    Encoding {
        /// The language, as the recording names it.
        encoding: String,
    },
    /// The messages are not CDR.
    #[error("its messages are encoded as {encoding:?}, and only \"cdr\" is read")]
    NotCdr {
        /// The encoding, as the recording names it.
        encoding: String,
    },
    /// The schema itself is wrong.
    #[error("its schema cannot be used: {0}")]
    Definition(#[from] InterfaceError),
    /// A type contains itself.
    #[error("its schema cannot be used: {interface} contains itself")]
    Circle {
        /// The type.
        interface: String,
    },
    /// Types within types without an end in sight.
    #[error("its schema cannot be used: types stand within each other more than {limit} deep")]
    TooDeep {
        /// How deep they may.
        limit: usize,
    },
}

/// Why a message path does not fit a schema.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SelectError {
    /// A type has no such field.
    #[error("{interface} has no field {field:?}")]
    NoField {
        /// The type.
        interface: String,
        /// The field asked for.
        field: String,
    },
    /// A field asked of what has none.
    #[error("{place} is {kind}, which has no field {field:?}")]
    NotAMessage {
        /// The path up to there.
        place: String,
        /// Its type.
        kind: String,
        /// The field asked for.
        field: String,
    },
    /// Brackets behind what is no array.
    #[error("{place} is {kind}, no array: leave {brackets} out")]
    NotAnArray {
        /// The path up to there.
        place: String,
        /// Its type.
        kind: String,
        /// The brackets.
        brackets: String,
    },
    /// An element that an array of fixed size never has.
    #[error("{place} is {kind}: it has no element {index}")]
    NoElement {
        /// The path up to there.
        place: String,
        /// Its type.
        kind: String,
        /// The element asked for.
        index: i64,
    },
    /// The path ends at something that is no number.
    #[error("{place} is {kind}, not a number")]
    NotANumber {
        /// The path.
        place: String,
        /// Its type.
        kind: String,
    },
    /// A filter that cannot be asked.
    #[error("filter {filter}: {reason}")]
    Filter {
        /// The filter.
        filter: String,
        /// Why not.
        reason: String,
    },
}

/// Why a message cannot be read by its schema.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// Shorter than the header of four bytes.
    #[error("{length} bytes are too few for a CDR message")]
    NoHeader {
        /// Its length \[bytes\].
        length: usize,
    },
    /// Encoded in a form of CDR that ROS 2 does not use for messages.
    #[error("its header {identifier:#06x} is none of plain CDR")]
    NotPlainCdr {
        /// The representation identifier.
        identifier: u16,
    },
    /// The bytes end before the message does.
    #[error("it ends at byte {offset}, in the middle of {what}: it does not fit its schema")]
    TooShort {
        /// Where \[byte\].
        offset: usize,
        /// What was being read.
        what: &'static str,
    },
    /// A sequence or text is longer than the schema allows.
    #[error("byte {offset} says {length} elements where the schema allows {bound}")]
    OverBound {
        /// Where \[byte\].
        offset: usize,
        /// The length found.
        length: u64,
        /// The length allowed.
        bound: u64,
    },
}

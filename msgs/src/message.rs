//! What every message can do.

use serde::{Serialize, de::DeserializeOwned};

use crate::{
    cdr::{DecodeError, EncodeError},
    layout::Sample,
    time::Time,
};

/// A message in its ROS 2 form: a serde struct whose fields follow the
/// `.msg` definition in order, so that CDR comes out right.
pub trait RosMessage:
    Serialize + DeserializeOwned + Clone + std::fmt::Debug + PartialEq + Send + Sync + 'static
{
    /// Full interface name, `package/msg/Type`.
    const INTERFACE: &'static str;
    /// The `.msg` text, where the message is declared in Rust; those of other
    /// packages are in `msgs/standard/`.
    const DEFINITION: Option<&'static str>;

    /// Writes it in CDR with its header into `bytes`, replacing what was there.
    /// The buffer grows on the first messages only.
    ///
    /// # Errors
    ///
    /// [`EncodeError`]; `bytes` is then of no use.
    fn encode(&self, bytes: &mut Vec<u8>) -> Result<(), EncodeError>;

    /// Bytes that it takes in CDR with its header; nothing is written.
    ///
    /// # Errors
    ///
    /// As [`encode`](Self::encode).
    fn encoded_length(&self) -> Result<usize, EncodeError>;

    /// The message in `bytes` of CDR, header included, little- or big-endian.
    ///
    /// # Errors
    ///
    /// [`DecodeError`], whatever the bytes are.
    fn decode(bytes: &[u8]) -> Result<Self, DecodeError>;
}

/// Says of a struct which interface it is. Its way into CDR and out of it is thereby compiled
/// here, once; what is generic is compiled again in each crate that uses it.
macro_rules! ros_message {
    ($message:ty, $interface:literal) => {
        $crate::message::ros_message!($message, $interface, None);
    };
    ($message:ty, $interface:literal, $definition:expr) => {
        impl $crate::RosMessage for $message {
            const INTERFACE: &'static str = $interface;
            const DEFINITION: Option<&'static str> = $definition;

            fn encode(&self, bytes: &mut Vec<u8>) -> Result<(), $crate::cdr::EncodeError> {
                $crate::cdr::encode(self, bytes)
            }

            fn encoded_length(&self) -> Result<usize, $crate::cdr::EncodeError> {
                $crate::cdr::length(self)
            }

            fn decode(bytes: &[u8]) -> Result<Self, $crate::cdr::DecodeError> {
                $crate::cdr::decode(bytes)
            }
        }
    };
}
pub(crate) use ros_message;

/// A message: the sample that nodes read and write, and its ROS 2 form.
/// Shared memory is read as found there: what is wrong with a sample,
/// [`Message::check`] says.
pub trait Message: Sample {
    /// The same message as ROS 2 knows it.
    type Ros: RosMessage;

    /// When the content was measured or commanded.
    fn stamp(&self) -> Time;

    /// Notes who sent it, as the middleware tells senders apart, where the
    /// message has a place for that.
    fn set_source(&mut self, _source: u64) {}

    /// Whether all that this command can do is stop something: whoever asks for that
    /// is heard.
    fn stops(&self) -> bool {
        false
    }

    /// The ROS 2 form. Allocates: not for the control path.
    fn to_ros(&self) -> Self::Ros;

    /// The sample in a ROS 2 message.
    ///
    /// # Errors
    ///
    /// What makes it no sample of ours: wrong number of joints, unknown
    /// frame, and everything that [`Message::check`] refuses.
    fn from_ros(ros: &Self::Ros) -> Result<Self, InvalidMessage>;

    /// Whether the content can be acted on.
    ///
    /// # Errors
    ///
    /// A stamp that is zero or beyond ROS 2's, a number that is not finite, an
    /// unknown code, an orientation that is none.
    fn check(&self) -> Result<(), InvalidMessage>;

    /// The same where `before` is known to be valid: what is as it was there is not looked
    /// at again.
    ///
    /// # Errors
    ///
    /// As [`Message::check`].
    fn check_after(&self, _before: &Self) -> Result<(), InvalidMessage> {
        self.check()
    }
}

/// Why a message cannot be acted on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InvalidMessage {
    /// The stamp is zero or before 1970.
    #[error("stamp is zero: set header.stamp to the time of the measurement")]
    ZeroStamp,
    /// The stamp is later than ROS 2 can say (32 bit seconds).
    #[error(
        "stamp is {nanos} ns since 1970, later than builtin_interfaces/Time can hold: is the clock set?"
    )]
    LateStamp {
        /// What it held \[ns\].
        nanos: i64,
    },
    /// A number is NaN or infinite.
    #[error("{field} is {value}, not a finite number")]
    NotFinite {
        /// The field, as in the `.msg` file.
        field: &'static str,
        /// What it held.
        value: f64,
    },
    /// A sequence has the wrong length.
    #[error("{field} has {found} entries where {expected} are needed")]
    WrongLength {
        /// The field, as in the `.msg` file.
        field: &'static str,
        /// Entries found.
        found: usize,
        /// Entries needed.
        expected: usize,
    },
    /// A joint is missing or named otherwise.
    #[error("joint names {found:?} where 1 to 8 different names of at most 16 bytes are needed")]
    WrongJoints {
        /// The names found.
        found: Vec<String>,
    },
    /// A word or code that this message does not know.
    #[error("{field} is {found:?}; known are: {known}")]
    Unknown {
        /// The field, as in the `.msg` file.
        field: &'static str,
        /// What it held.
        found: String,
        /// What it may hold.
        known: &'static str,
    },
    /// An orientation that is not a unit quaternion.
    #[error("orientation has norm {norm}, not 1")]
    NotUnit {
        /// The norm found.
        norm: f64,
    },
}

//! Messages as bytes: plain CDR with its header of four bytes, as it stands
//! on the wire of DDS and Zenoh and in recordings.
//!
//! Whatever comes in is bounded: nothing longer than [`MAX_LENGTH`] is looked
//! at, every length in it is checked against the bytes that are there, and no
//! memory is set aside by what a length field says.
//!
//! What is generic here is compiled for each message where that is said to be one
//! (`ros_message!`), and nowhere else.

use std::io;

use byteorder::{BigEndian, LittleEndian};

use crate::{InvalidMessage, Message, RosMessage};

/// Longest message with its header \[byte\].
pub const MAX_LENGTH: usize = 64 * 1024;

/// Header of plain little-endian CDR: representation identifier 0x0001, options zero.
const HEADER_LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];

/// RTPS pads a payload to a multiple of four bytes; more left over than that is no padding \[byte\].
pub const MAX_PADDING: usize = 3;

/// Why a message does not go into CDR.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EncodeError {
    /// Longer than [`MAX_LENGTH`].
    #[error("{interface} takes {length} bytes in CDR, more than the {limit} allowed")]
    TooLarge {
        /// Interface name.
        interface: &'static str,
        /// Bytes needed.
        length: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// A field that CDR has no form for.
    #[error("{interface} has no CDR form: {reason}")]
    NotCdr {
        /// Interface name.
        interface: &'static str,
        /// What the encoder said.
        reason: String,
    },
}

/// Why received bytes are no message.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DecodeError {
    /// Longer than [`MAX_LENGTH`].
    #[error("{length} bytes are more than the {limit} allowed for a message")]
    TooLarge {
        /// Bytes received.
        length: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// Shorter than the header of four bytes.
    #[error("{length} bytes are too short for a CDR header")]
    NoHeader {
        /// Bytes received.
        length: usize,
    },
    /// An encoding other than plain CDR.
    #[error("representation {identifier:#06x} is not plain CDR (0x0000 or 0x0001)")]
    NotPlainCdr {
        /// Representation identifier, the header's first two bytes.
        identifier: u16,
    },
    /// The content does not fit the type.
    #[error("not a {interface}: {reason}")]
    NotThisType {
        /// Interface name.
        interface: &'static str,
        /// What the decoder said.
        reason: String,
    },
    /// Bytes are left over.
    #[error("not a {interface}: {left} bytes are left over")]
    LeftOver {
        /// Interface name.
        interface: &'static str,
        /// Bytes left over.
        left: usize,
    },
    /// Readable, but nothing that can be acted on.
    #[error(transparent)]
    Invalid(#[from] InvalidMessage),
}

/// As [`RosMessage::encode`].
pub(crate) fn encode<R: RosMessage>(message: &R, bytes: &mut Vec<u8>) -> Result<(), EncodeError> {
    bytes.clear();
    bytes.extend_from_slice(&HEADER_LITTLE_ENDIAN);
    cdr_encoding::to_writer::<R, LittleEndian, _>(&mut *bytes, message).map_err(not_cdr::<R>)?;
    bounded::<R>(bytes.len()).map(|_length| ())
}

/// As [`RosMessage::encoded_length`].
pub(crate) fn length<R: RosMessage>(message: &R) -> Result<usize, EncodeError> {
    let mut count = Count(HEADER_LITTLE_ENDIAN.len());
    cdr_encoding::to_writer::<R, LittleEndian, _>(&mut count, message).map_err(not_cdr::<R>)?;
    bounded::<R>(count.0)
}

/// What follows the header in `bytes`, nothing where they are shorter than that.
pub fn body(bytes: &[u8]) -> &[u8] {
    bytes.get(HEADER_LITTLE_ENDIAN.len()..).unwrap_or_default()
}

/// Whether `bytes` begin as a message in little-endian CDR does, of whatever type.
pub fn is_little_endian(bytes: &[u8]) -> bool {
    // The header's last two bytes are options.
    bytes.len() >= HEADER_LITTLE_ENDIAN.len() && bytes.starts_with(&HEADER_LITTLE_ENDIAN[..2])
}

/// Counts what is written to it.
struct Count(usize);

impl io::Write for Count {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn not_cdr<R: RosMessage>(error: cdr_encoding::Error) -> EncodeError {
    EncodeError::NotCdr {
        interface: R::INTERFACE,
        reason: error.to_string(),
    }
}

fn bounded<R: RosMessage>(length: usize) -> Result<usize, EncodeError> {
    if length > MAX_LENGTH {
        return Err(EncodeError::TooLarge {
            interface: R::INTERFACE,
            length,
            limit: MAX_LENGTH,
        });
    }
    Ok(length)
}

/// As [`RosMessage::decode`].
pub(crate) fn decode<R: RosMessage>(bytes: &[u8]) -> Result<R, DecodeError> {
    if bytes.len() > MAX_LENGTH {
        return Err(DecodeError::TooLarge {
            length: bytes.len(),
            limit: MAX_LENGTH,
        });
    }
    // The header's last two bytes (options) carry nothing for plain CDR.
    let [high, low, _, _, body @ ..] = bytes else {
        return Err(DecodeError::NoHeader {
            length: bytes.len(),
        });
    };
    let identifier = u16::from_be_bytes([*high, *low]);
    let decoded = match identifier {
        0x0000 => cdr_encoding::from_bytes::<R, BigEndian>(body),
        0x0001 => cdr_encoding::from_bytes::<R, LittleEndian>(body),
        _ => return Err(DecodeError::NotPlainCdr { identifier }),
    };
    let (message, used) = decoded.map_err(|error| DecodeError::NotThisType {
        interface: R::INTERFACE,
        reason: error.to_string(),
    })?;
    let left = body.len().saturating_sub(used);
    if left > MAX_PADDING {
        return Err(DecodeError::LeftOver {
            interface: R::INTERFACE,
            left,
        });
    }
    Ok(message)
}

/// The message in `bytes`, as [`RosMessage::decode`] reads it, as a sample that can be
/// acted on, which [`Message::from_ros`] has checked.
///
/// # Errors
///
/// [`DecodeError`]: also [`DecodeError::Invalid`].
pub fn decode_sample<M: Message>(bytes: &[u8]) -> Result<M, DecodeError> {
    Ok(M::from_ros(&M::Ros::decode(bytes)?)?)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        Time,
        ros::sensor_msgs::JointState,
        sample::{JointNames, JointSample},
    };

    fn joint_state() -> JointState {
        JointSample::empty(JointNames::numbered(2), Time::from_ros(1, 2))
            .with_position([0.5, -1.0])
            .to_ros()
    }

    /// By hand from the CDR rules (OMG CORBA 3.4, 9.3): alignment counts from the end of the header.
    #[test]
    fn bytes_of_a_joint_state() {
        let mut bytes = vec![1, 2, 3];
        encode(&joint_state(), &mut bytes).unwrap();
        let mut expected = vec![0, 1, 0, 0];
        expected.extend(1_i32.to_le_bytes()); // sec
        expected.extend(2_u32.to_le_bytes()); // nanosec
        expected.extend([1, 0, 0, 0, 0, 0, 0, 0]); // frame_id "", padded to 4
        expected.extend(2_u32.to_le_bytes()); // two names
        expected.extend([8, 0, 0, 0]);
        expected.extend(b"joint_1\0");
        expected.extend([8, 0, 0, 0]);
        expected.extend(b"joint_2\0");
        expected.extend(2_u32.to_le_bytes()); // two positions, from 48 on: aligned to 8
        expected.extend(0.5_f64.to_le_bytes());
        expected.extend((-1.0_f64).to_le_bytes());
        expected.extend([0; 8]); // no velocity, no effort
        assert_eq!(bytes, expected);
        assert_eq!(length(&joint_state()), Ok(expected.len()));
        assert_eq!(decode(&bytes), Ok(joint_state()));
    }

    #[test]
    fn big_endian_is_read() {
        let body = cdr_encoding::to_vec::<JointState, BigEndian>(&joint_state()).unwrap();
        let bytes = [&[0, 0, 0, 0], body.as_slice()].concat();
        assert_eq!(decode(&bytes), Ok(joint_state()));
    }

    #[test]
    fn padding_is_allowed_and_more_is_not() {
        let mut bytes = Vec::new();
        encode(&joint_state(), &mut bytes).unwrap();
        bytes.extend([0; 3]);
        assert_eq!(decode(&bytes), Ok(joint_state()));
        bytes.push(0);
        assert_eq!(
            decode::<JointState>(&bytes),
            Err(DecodeError::LeftOver {
                interface: "sensor_msgs/msg/JointState",
                left: 4
            })
        );
    }

    #[test]
    fn headers_and_lengths_are_checked() {
        for short in 0..4 {
            assert_eq!(
                decode::<JointState>(&[0, 1, 0][..short.min(3)]),
                Err(DecodeError::NoHeader {
                    length: short.min(3)
                })
            );
        }
        assert_eq!(
            decode::<JointState>(&[0, 7, 0, 0]),
            Err(DecodeError::NotPlainCdr { identifier: 7 })
        );
        let long = vec![0; MAX_LENGTH + 1];
        assert!(matches!(
            decode::<JointState>(&long),
            Err(DecodeError::TooLarge { .. })
        ));
        let mut message = joint_state();
        message.header.frame_id = "x".repeat(MAX_LENGTH);
        assert!(matches!(
            encode(&message, &mut Vec::new()),
            Err(EncodeError::TooLarge { .. })
        ));
        assert!(matches!(
            length(&message),
            Err(EncodeError::TooLarge { .. })
        ));
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(mut bytes in proptest::collection::vec(any::<u8>(), 0..400), header in 0_u8..3) {
            if bytes.len() >= 4 {
                bytes[..4].copy_from_slice(&[0, header, 0, 0]);
            }
            let _ = decode::<JointState>(&bytes);
        }

        #[test]
        fn changed_bytes_are_read_or_refused(at in 4_usize..80, value in any::<u8>()) {
            let mut bytes = Vec::new();
            encode(&joint_state(), &mut bytes).unwrap();
            let at = at.min(bytes.len() - 1);
            bytes[at] = value;
            if let Ok(message) = decode::<JointState>(&bytes) {
                // What was read is no longer than what it was read from.
                prop_assert!(length(&message).unwrap() <= bytes.len() + MAX_PADDING);
            }
        }
    }
}

//! The link's binary frame: 60 bytes, little-endian. At 500 Hz that is
//! 240 kbit/s: ROKVISS's uplink of 256 kbit/s then drains what a late frame
//! left waiting, which it would not at 64 bytes.
//!
//! | offset | type | content |
//! |---:|---|---|
//! | 0 | u8 | bits 0–3 version of the format, 3; bits 4–7 code of the delay law whose packet it carries |
//! | 1 | u8 | flags: bit 0 content valid, bit 1 hold, bits 2–3 operating state of the sender's device, bits 4–7 arming counter |
//! | 2 | u16 | identity of the session |
//! | 4 | u32 | sequence number, one more with every frame sent |
//! | 8 | i64 | sent \[ns since the UNIX epoch, sender's clock\] |
//! | 16 | u32 | echo: `sent` of the newest frame received by the sender, in units of 4 ns, the low 32 bits (17 s) |
//! | 20 | u32 | how long the sender had held that frame \[ns\]; 2³² − 1: there is none |
//! | 24 | f32 × 3 | position \[m\] |
//! | 36 | f32 × 3 | velocity \[m/s\] or force \[N\], as the delay law has it |
//! | 48 | f32 × 2 | energy that entered and left the sender's port \[J\] |
//! | 56 | u32 | CRC-32 (IEEE 802.3) of the 56 bytes before |
//!
//! Echo and hold time give the round trip without clocks that agree
//! (RFC 3550, section 6.4.1, fields LSR and DLSR):
//! round trip = now − echo − held.

use crate::delay::{ENERGY_LIMIT, POSITION_LIMIT, Packet, VECTOR_LIMIT};
use crate::operating::OperatingState;
use crate::{nanoseconds, seconds};

/// Length of a frame \[bytes\].
pub const FRAME_LENGTH: usize = 60;
/// Where the checksum is.
const CHECKSUM: usize = FRAME_LENGTH - 4;
/// Unit of the echo's time \[ns\].
const ECHO_UNIT: i64 = 4;
/// The held time that says that there is no echo.
const NO_ECHO: u32 = u32::MAX;
/// Version of the format.
pub const FRAME_VERSION: u8 = 3;
/// Largest code of a delay law: it has four bits.
pub const LAST_LAW_CODE: u8 = 15;

/// Frames stamped further ahead than this are refused \[s\].
pub const FUTURE_TOLERANCE: f64 = 0.050;
/// Frames sent longer ago than this are refused \[s\].
pub const LONGEST_LIFE: f64 = 10.0;

const VALID: u8 = 1;
const HOLD: u8 = 2;

/// One frame of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkFrame {
    /// Identity of the session.
    pub session: u16,
    /// One more with every frame sent; wraps.
    pub sequence: u32,
    /// When it was sent \[ns since the UNIX epoch, sender's clock\].
    pub sent_ns: i64,
    /// What comes back to where it was sent from.
    pub echo: Option<Echo>,
    /// The sender asks the other end to hold (it is paused, disabled or faulty).
    pub hold: bool,
    /// Operating state of the sender's device.
    pub state: OperatingState,
    /// Count of the operator's words to arm again, see [`crate::arming`].
    pub arming: u8,
    /// Code of the law that made the packet, 0 … [`LAST_LAW_CODE`]: while the
    /// laws are being switched, frames of both are on their way, and a packet
    /// means nothing to the other law.
    pub law: u8,
    /// What the delay law sends.
    pub packet: Packet,
}

/// The newest frame that the sender had received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Echo {
    /// Its `sent_ns`, in the clock of the end that the frame goes to, to 4 ns \[ns\].
    pub sent_ns: i64,
    /// How long it had been held when this frame was sent \[ns\].
    pub held_ns: u32,
}

/// Why a frame was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// Not 60 bytes.
    #[error("a frame has {FRAME_LENGTH} bytes, this has {found}; is the peer another program?")]
    Length {
        /// Bytes received.
        found: usize,
    },
    /// Checksum wrong: damaged on the way.
    #[error(
        "the frame's checksum is {found:#010x}, its content gives {expected:#010x}; it was damaged on the way"
    )]
    Checksum {
        /// In the frame.
        found: u32,
        /// Of its content.
        expected: u32,
    },
    /// Another version of the format.
    #[error(
        "the frame has version {found}, this end speaks {FRAME_VERSION}; run the same version at both ends"
    )]
    Version {
        /// In the frame.
        found: u8,
    },
    /// Another session.
    #[error(
        "the frame belongs to session {found}, not {expected}; is another pair of ends on the same link?"
    )]
    Session {
        /// In the frame.
        found: u16,
        /// This one.
        expected: u16,
    },
    /// Sent in the future, or longer ago than a frame can live.
    #[error(
        "the frame was sent {age:.3} s ago (allowed: −{FUTURE_TOLERANCE} … {LONGEST_LIFE} s); synchronise the clocks of both ends"
    )]
    Time {
        /// Its age \[s\]; negative when from the future.
        age: f64,
    },
    /// Not finite or out of range.
    #[error("{field} in the frame is {value}, not within ±{limit}")]
    Value {
        /// Which field.
        field: &'static str,
        /// What it holds.
        value: f32,
        /// Largest magnitude allowed.
        limit: f32,
    },
}

/// Writes `frame` into `bytes`. Values are written as they are; [`decode`]
/// refuses those that are out of range.
pub fn encode(frame: &LinkFrame, bytes: &mut [u8; FRAME_LENGTH]) {
    let mut flags = (frame.state.code() << 2) | ((frame.arming & 0x0f) << 4);
    if frame.packet.valid {
        flags |= VALID;
    }
    if frame.hold {
        flags |= HOLD;
    }
    bytes[0] = FRAME_VERSION | ((frame.law & LAST_LAW_CODE) << 4);
    bytes[1] = flags;
    bytes[2..4].copy_from_slice(&frame.session.to_le_bytes());
    bytes[4..8].copy_from_slice(&frame.sequence.to_le_bytes());
    bytes[8..16].copy_from_slice(&frame.sent_ns.to_le_bytes());
    let (echo, held) = frame.echo.map_or((0, NO_ECHO), |echo| {
        (
            (echo.sent_ns / ECHO_UNIT) as u32,
            echo.held_ns.min(NO_ECHO - 1),
        )
    });
    bytes[16..20].copy_from_slice(&echo.to_le_bytes());
    bytes[20..24].copy_from_slice(&held.to_le_bytes());
    let packet = &frame.packet;
    let numbers = packet
        .position
        .iter()
        .chain(&packet.vector)
        .chain(&packet.energy);
    for (place, number) in bytes[24..CHECKSUM].chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    let checksum = crc32fast::hash(&bytes[..CHECKSUM]);
    bytes[CHECKSUM..].copy_from_slice(&checksum.to_le_bytes());
}

/// Reads a frame of `session`, received at `now_ns` \[ns since the UNIX epoch\].
///
/// # Errors
///
/// [`FrameError`] by kind, in the order length, checksum, version, session,
/// time, value. Never panics, whatever the bytes.
pub fn decode(bytes: &[u8], session: u16, now_ns: i64) -> Result<LinkFrame, FrameError> {
    let found = bytes.len();
    let bytes: &[u8; FRAME_LENGTH] = bytes.try_into().map_err(|_| FrameError::Length { found })?;
    let (found, expected) = (
        u32::from_le_bytes(part(bytes, CHECKSUM)),
        crc32fast::hash(&bytes[..CHECKSUM]),
    );
    if found != expected {
        return Err(FrameError::Checksum { found, expected });
    }
    let found = bytes[0] & 0x0f;
    if found != FRAME_VERSION {
        return Err(FrameError::Version { found });
    }
    let found = u16::from_le_bytes(part(bytes, 2));
    if found != session {
        return Err(FrameError::Session {
            found,
            expected: session,
        });
    }
    let sent_ns = i64::from_le_bytes(part(bytes, 8));
    let age_ns = now_ns.saturating_sub(sent_ns);
    let allowed = -nanoseconds(FUTURE_TOLERANCE)..=nanoseconds(LONGEST_LIFE);
    if sent_ns <= 0 || !allowed.contains(&age_ns) {
        let age = seconds(age_ns);
        return Err(FrameError::Time { age });
    }
    let packet = Packet {
        valid: bytes[1] & VALID != 0,
        position: numbers(bytes, 24, "position", POSITION_LIMIT)?,
        vector: numbers(bytes, 36, "velocity or force", VECTOR_LIMIT)?,
        energy: numbers(bytes, 48, "energy", ENERGY_LIMIT)?,
    };
    let held_ns = u32::from_le_bytes(part(bytes, 20));
    // The newest time before now that ends in these bits.
    let ago = ((now_ns / ECHO_UNIT) as u32).wrapping_sub(u32::from_le_bytes(part(bytes, 16)));
    let echo_ns = (now_ns / ECHO_UNIT - i64::from(ago)) * ECHO_UNIT;
    Ok(LinkFrame {
        session,
        sequence: u32::from_le_bytes(part(bytes, 4)),
        sent_ns,
        echo: (held_ns != NO_ECHO).then_some(Echo {
            sent_ns: echo_ns,
            held_ns,
        }),
        hold: bytes[1] & HOLD != 0,
        // Two bits have no fifth value.
        state: OperatingState::from_code((bytes[1] >> 2) & 3).unwrap_or(OperatingState::Fault),
        arming: bytes[1] >> 4,
        law: bytes[0] >> 4,
        packet,
    })
}

fn part<const N: usize>(bytes: &[u8; FRAME_LENGTH], offset: usize) -> [u8; N] {
    std::array::from_fn(|index| bytes[offset + index])
}

fn numbers<const N: usize>(
    bytes: &[u8; FRAME_LENGTH],
    offset: usize,
    field: &'static str,
    limit: f32,
) -> Result<[f32; N], FrameError> {
    let values: [f32; N] =
        std::array::from_fn(|index| f32::from_le_bytes(part(bytes, offset + 4 * index)));
    for value in values {
        if !value.is_finite() || value.abs() > limit {
            return Err(FrameError::Value {
                field,
                value,
                limit,
            });
        }
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NOW: i64 = 1_700_000_000_000_000_000;

    fn any_frame() -> impl Strategy<Value = LinkFrame> {
        let packet = (
            any::<bool>(),
            proptest::array::uniform3(-10.0..=10.0f32),
            proptest::array::uniform3(-10_000.0..=10_000.0f32),
            proptest::array::uniform2(-1e9..=1e9f32),
        );
        let echo = proptest::option::of((0..4_000_000_000_i64, 0..u32::MAX));
        (
            (any::<u16>(), any::<u32>(), -40_000_000..9_000_000_000i64),
            (echo, any::<bool>(), 0..4u8, 0..16u8, 0..16u8),
            packet,
        )
            .prop_map(
                |((session, sequence, age), (echo, hold, state, arming, law), packet)| LinkFrame {
                    session,
                    sequence,
                    sent_ns: NOW - age,
                    echo: echo.map(|(units, held_ns)| Echo {
                        sent_ns: NOW - units * ECHO_UNIT,
                        held_ns,
                    }),
                    hold,
                    state: OperatingState::from_code(state).unwrap(),
                    arming,
                    law,
                    packet: Packet {
                        valid: packet.0,
                        position: packet.1,
                        vector: packet.2,
                        energy: packet.3,
                    },
                },
            )
    }

    fn sealed(mut bytes: [u8; FRAME_LENGTH]) -> [u8; FRAME_LENGTH] {
        let checksum = crc32fast::hash(&bytes[..CHECKSUM]);
        bytes[CHECKSUM..].copy_from_slice(&checksum.to_le_bytes());
        bytes
    }

    fn example() -> [u8; FRAME_LENGTH] {
        let mut bytes = [0; FRAME_LENGTH];
        let frame = LinkFrame {
            session: 7,
            sequence: 1,
            sent_ns: NOW,
            echo: None,
            hold: false,
            state: OperatingState::Enabled,
            arming: 3,
            law: 5,
            packet: Packet::default(),
        };
        encode(&frame, &mut bytes);
        bytes
    }

    #[test]
    fn the_rate_fits_rokviss_uplink() {
        let rate = FRAME_LENGTH * 8 * 500;
        assert!((200_000..256_000).contains(&rate), "{rate} bit/s");
    }

    #[test]
    fn the_checksum_is_the_published_crc_32() {
        // The check value of CRC-32/ISO-HDLC.
        assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn each_fault_is_refused_by_its_kind() {
        let good = example();
        assert!(decode(&good, 7, NOW).is_ok());
        assert!(matches!(
            decode(&good[..59], 7, NOW),
            Err(FrameError::Length { found: 59 })
        ));
        assert!(matches!(
            decode(&good, 8, NOW),
            Err(FrameError::Session {
                found: 7,
                expected: 8
            })
        ));
        let mut other = good;
        // Version 2 of the format, which had the whole byte.
        other[0] = 2;
        assert!(matches!(
            decode(&sealed(other), 7, NOW),
            Err(FrameError::Version { found: 2 })
        ));
        for now in [NOW - 51_000_000, NOW + 10_001_000_000] {
            assert!(matches!(
                decode(&good, 7, now),
                Err(FrameError::Time { .. })
            ));
        }
        for now in [NOW - 49_000_000, NOW + 9_999_000_000] {
            assert!(decode(&good, 7, now).is_ok());
        }
        for (offset, value) in [(24, 10.1), (36, f32::NAN), (48, f32::INFINITY), (44, -1e5)] {
            let mut other = good;
            other[offset..offset + 4].copy_from_slice(&f32::to_le_bytes(value));
            assert!(matches!(
                decode(&sealed(other), 7, NOW),
                Err(FrameError::Value { .. })
            ));
        }
    }

    proptest! {
        #[test]
        fn what_is_encoded_is_decoded(frame in any_frame()) {
            let mut bytes = [0; FRAME_LENGTH];
            encode(&frame, &mut bytes);
            prop_assert_eq!(decode(&bytes, frame.session, NOW), Ok(frame));
        }

        #[test]
        fn any_flipped_bit_is_refused(frame in any_frame(), bit in 0..FRAME_LENGTH * 8) {
            let mut bytes = [0; FRAME_LENGTH];
            encode(&frame, &mut bytes);
            bytes[bit / 8] ^= 1 << (bit % 8);
            prop_assert!(decode(&bytes, frame.session, NOW).is_err());
        }

        #[test]
        fn garbage_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200), now: i64) {
            let _ = decode(&bytes, 0, now);
        }

        #[test]
        fn sealed_garbage_never_panics(halves in proptest::array::uniform2(proptest::array::uniform32(any::<u8>())), session: u16, now: i64) {
            let mut bytes = [0; FRAME_LENGTH];
            bytes[..32].copy_from_slice(&halves[0]);
            bytes[32..].copy_from_slice(&halves[1][..FRAME_LENGTH - 32]);
            bytes[0] = FRAME_VERSION;
            if let Ok(frame) = decode(&sealed(bytes), session, now) {
                prop_assert!(frame.packet.position.iter().all(|value| value.is_finite()));
            }
        }
    }
}

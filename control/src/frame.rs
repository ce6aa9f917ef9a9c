//! What a frame of the link says: 50 bytes, little-endian. Sealed (crate
//! `ferntast-seal`) it goes over the wire in [`WIRE_LENGTH`] bytes: at 500 Hz
//! 240 kbit/s, so that ROKVISS's uplink of 256 kbit/s drains what a late frame
//! left waiting, which it would not at 64 bytes.
//!
//! Where the hand's orientation goes with it, it has 58 bytes, sealed 68: at 500 Hz 272 kbit/s.
//!
//! | offset | type | content |
//! |---:|---|---|
//! | 0 | u32 | sequence number, one more with every frame sent |
//! | 4 | u8 | bits 0–3 code of the delay law whose packet it carries; bits 4–7 arming counter |
//! | 5 | u8 | flags: bit 0 content valid, bit 1 hold, bits 2–3 operating state of the sender's device; bits 4–7 pace |
//! | 6 | u32 | sent: sender's clock in units of 8 ns, the low 32 bits (34 s) |
//! | 10 | u32 | echo: `sent` of the newest frame received by the sender |
//! | 14 | u32 | how long the sender had held that frame \[ns\]; 2³² − 1: there is none |
//! | 18 | f32 × 3 | position \[m\] |
//! | 30 | f32 × 3 | velocity \[m/s\] or force \[N\], as the delay law has it |
//! | 42 | f32 × 2 | energy that entered and left the sender's port \[J\] |
//! | 50 | 8 bytes | the hand's orientation, where it has one ([`PackedOrientation`]) |
//!
//! **Pace.** Zero: a frame is due every 2 ms. Otherwise the sender leaves out what the other end
//! can tell for itself ([`crate::codec`]), and announces that it is never silent for longer than
//! so many times 2 ms. A frame that only says so, a keep-alive, ends behind byte 17 with one that
//! says how many frames ago the content was sent (255: so many or more): 19 bytes, sealed 29.
//!
//! Echo and hold time give the round trip without clocks that agree
//! (RFC 3550, section 6.4.1, fields LSR and DLSR):
//! round trip = now − echo − held; and with `sent` how far the clocks are apart
//! ([`ClockEstimate`](crate::meter::ClockEstimate)).

use crate::delay::{ENERGY_LIMIT, POSITION_LIMIT, Packet, VECTOR_LIMIT};
use crate::operating::OperatingState;
use crate::orientation::PackedOrientation;
use crate::short_bytes::ShortBytes;
use crate::{nanoseconds, seconds};

/// Time between two frames, where none is left out \[ns\]: 500 Hz.
pub const SEND_PERIOD_NS: i64 = 2_000_000;
/// Length of a frame's content \[bytes\].
pub const FRAME_LENGTH: usize = 50;
/// Length of the content of one with the hand's orientation \[bytes\].
pub const POSE_LENGTH: usize = FRAME_LENGTH + PackedOrientation::LENGTH;
/// Length of a frame without content \[bytes\].
pub const KEEP_ALIVE_LENGTH: usize = 19;
/// What a seal adds to a frame \[bytes\].
pub const SEAL_LENGTH: usize = 10;
/// Length of a frame on the wire, sealed \[bytes\].
pub const WIRE_LENGTH: usize = FRAME_LENGTH + SEAL_LENGTH;
/// Length of the longest frame on the wire, with an orientation \[bytes\].
pub const LONGEST_WIRE_LENGTH: usize = POSE_LENGTH + SEAL_LENGTH;
/// Unit of the times of sending \[ns\].
const TIME_UNIT: i64 = 8;
/// The held time that says that there is no echo.
const NO_ECHO: u32 = u32::MAX;
/// Largest code of a delay law: it has four bits.
pub const LAST_LAW_CODE: u8 = 15;
/// Largest pace: it has four bits.
pub const LARGEST_PACE: u8 = 15;

/// Frames stamped further ahead than this are refused \[s\].
pub const FUTURE_TOLERANCE: f64 = 0.050;
/// Frames sent longer ago than this are refused \[s\].
pub const LONGEST_LIFE: f64 = 10.0;

const VALID: u8 = 1;
const HOLD: u8 = 2;

/// One frame of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkFrame {
    /// One more with every frame sent; wraps.
    pub sequence: u32,
    /// When it was sent, by the sender's clock, to 8 ns \[ns since the UNIX epoch\].
    pub stamp_ns: i64,
    /// The same by the clock of whoever has the frame, as far as it knows the
    /// sender's \[ns since the UNIX epoch\].
    pub sent_ns: i64,
    /// What comes back to where it was sent from.
    pub echo: Option<Echo>,
    /// The sender asks the other end to hold: it is paused, disabled or faulty, or
    /// hears nothing.
    pub hold: bool,
    /// Operating state of the sender's device.
    pub state: OperatingState,
    /// Count of the operator's words to arm again, see [`crate::arming`].
    pub arming: u8,
    /// Code of the law that made the packet, 0 … [`LAST_LAW_CODE`]: while the
    /// laws are being switched, frames of both are on their way, and a packet
    /// means nothing to the other law.
    pub law: u8,
    /// Longest silence that the sender announces, in times between two frames; 0: it leaves
    /// no frame out.
    pub pace: u8,
    /// How many frames ago the content was sent; 0: in this one.
    pub since_content: u8,
    /// What the delay law sends; of it a frame without content has only whether it is valid.
    pub packet: Packet,
    /// How the hand is turned, where it says so; never without content.
    pub orientation: Option<PackedOrientation>,
}

/// A frame as bytes, of one of its three lengths.
pub type FrameBytes = ShortBytes<POSE_LENGTH>;

/// The newest frame that the sender had received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Echo {
    /// Its `stamp_ns`, in the clock of the end that the frame goes to, to 8 ns \[ns\].
    pub sent_ns: i64,
    /// How long it had been held when this frame was sent \[ns\].
    pub held_ns: u32,
}

/// Why a frame was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// Neither 50 bytes, nor 58, nor a keep-alive.
    #[error(
        "a frame has {FRAME_LENGTH}, {POSE_LENGTH} or {KEEP_ALIVE_LENGTH} bytes, this has {found}; is the peer another program?"
    )]
    Length {
        /// Bytes received.
        found: usize,
    },
    /// Sent in the future, or longer ago than a frame can live.
    #[error(
        "the frame was sent {age:.3} s ago (allowed: −{FUTURE_TOLERANCE} … {LONGEST_LIFE} s): a clock jumped, or it was held back on the way"
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

impl LinkFrame {
    /// Whether it is of an age at `now_ns` at which it may be acted on.
    ///
    /// # Errors
    ///
    /// [`FrameError::Time`].
    pub fn check_age(&self, now_ns: i64) -> Result<(), FrameError> {
        let age_ns = now_ns.saturating_sub(self.sent_ns);
        let allowed = -nanoseconds(FUTURE_TOLERANCE)..=nanoseconds(LONGEST_LIFE);
        match allowed.contains(&age_ns) {
            true => Ok(()),
            false => Err(FrameError::Time {
                age: seconds(age_ns),
            }),
        }
    }
}

/// The bytes of `frame`. Values are written as they are; [`decode`] refuses those that are
/// out of range.
pub fn encode(frame: &LinkFrame) -> FrameBytes {
    let mut bytes = [0; POSE_LENGTH];
    let mut flags = frame.state.code() << 2 | frame.pace.min(LARGEST_PACE) << 4;
    if frame.packet.valid {
        flags |= VALID;
    }
    if frame.hold {
        flags |= HOLD;
    }
    bytes[0..4].copy_from_slice(&frame.sequence.to_le_bytes());
    bytes[4] = (frame.law & LAST_LAW_CODE) | ((frame.arming & 0x0f) << 4);
    bytes[5] = flags;
    bytes[6..10].copy_from_slice(&units(frame.stamp_ns).to_le_bytes());
    let (echo, held) = frame.echo.map_or((0, NO_ECHO), |echo| {
        (units(echo.sent_ns), echo.held_ns.min(NO_ECHO - 1))
    });
    bytes[10..14].copy_from_slice(&echo.to_le_bytes());
    bytes[14..18].copy_from_slice(&held.to_le_bytes());
    if frame.since_content > 0 {
        bytes[18] = frame.since_content;
        return FrameBytes::new(bytes, KEEP_ALIVE_LENGTH);
    }
    let packet = &frame.packet;
    let numbers = packet
        .position
        .iter()
        .chain(&packet.vector)
        .chain(&packet.energy);
    for (place, number) in bytes[18..].chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    if let Some(orientation) = frame.orientation {
        bytes[FRAME_LENGTH..].copy_from_slice(&orientation.to_bytes());
    }
    let length = match frame.orientation {
        Some(_) => POSE_LENGTH,
        None => FRAME_LENGTH,
    };
    FrameBytes::new(bytes, length)
}

/// Reads a frame received at `now_ns` \[ns since the UNIX epoch\] from a sender whose
/// clock is `ahead_ns` \[ns\] ahead, to some seconds. Whether it is too old is not
/// judged here ([`LinkFrame::check_age`]).
///
/// # Errors
///
/// [`FrameError::Length`], [`FrameError::Value`]. Never panics, whatever the bytes.
pub fn decode(bytes: &[u8], now_ns: i64, ahead_ns: i64) -> Result<LinkFrame, FrameError> {
    let found = bytes.len();
    let (bytes, rest) = whole(bytes).ok_or(FrameError::Length { found })?;
    let bytes = &bytes;
    let (since_content, orientation) = match rest {
        Rest::Nothing => (0, None),
        Rest::Orientation(packed) => (0, Some(orientation(packed)?)),
        Rest::SinceContent(frames) => (frames, None),
    };
    let packet = match since_content {
        0 => Packet {
            valid: bytes[5] & VALID != 0,
            position: numbers(bytes, 18, "position", POSITION_LIMIT)?,
            vector: numbers(bytes, 30, "velocity or force", VECTOR_LIMIT)?,
            energy: numbers(bytes, 42, "energy", ENERGY_LIMIT)?,
        },
        _ => Packet {
            valid: bytes[5] & VALID != 0,
            ..Packet::default()
        },
    };
    let there_ns = now_ns.saturating_add(ahead_ns);
    let stamp_ns = nearest(u32::from_le_bytes(part(bytes, 6)), there_ns);
    // The newest time before now.
    let ago = units(now_ns).wrapping_sub(u32::from_le_bytes(part(bytes, 10)));
    let echo_ns = before(now_ns, i64::from(ago));
    let held_ns = u32::from_le_bytes(part(bytes, 14));
    Ok(LinkFrame {
        sequence: u32::from_le_bytes(part(bytes, 0)),
        stamp_ns,
        sent_ns: stamp_ns.saturating_sub(ahead_ns),
        echo: (held_ns != NO_ECHO).then_some(Echo {
            sent_ns: echo_ns,
            held_ns,
        }),
        hold: bytes[5] & HOLD != 0,
        // Two bits have no fifth value.
        state: OperatingState::from_code((bytes[5] >> 2) & 3).unwrap_or(OperatingState::Fault),
        arming: bytes[4] >> 4,
        law: bytes[4] & LAST_LAW_CODE,
        pace: bytes[5] >> 4,
        since_content,
        packet,
        orientation,
    })
}

/// What a frame has beyond its 50 bytes, or in place of its content.
enum Rest {
    Nothing,
    Orientation([u8; PackedOrientation::LENGTH]),
    /// How many frames ago the content was sent.
    SinceContent(u8),
}

/// The bytes of a frame, zeros where it has no content, and the rest; `None` where they are none.
fn whole(bytes: &[u8]) -> Option<([u8; FRAME_LENGTH], Rest)> {
    if let Some((all, rest)) = bytes.split_first_chunk() {
        return match rest {
            [] => Some((*all, Rest::Nothing)),
            _ => Some((*all, Rest::Orientation(rest.try_into().ok()?))),
        };
    }
    let [header @ .., since_content] = <&[u8; KEEP_ALIVE_LENGTH]>::try_from(bytes).ok()?;
    let mut all = [0; FRAME_LENGTH];
    all[..header.len()].copy_from_slice(header);
    // Who leaves nothing out has no keep-alives.
    (*since_content > 0 && all[5] >> 4 > 0).then_some((all, Rest::SinceContent(*since_content)))
}

fn orientation(bytes: [u8; PackedOrientation::LENGTH]) -> Result<PackedOrientation, FrameError> {
    PackedOrientation::from_bytes(bytes).map_err(|sum| FrameError::Value {
        field: "sum of squares of the orientation",
        value: sum as f32,
        limit: 0.75,
    })
}

/// The time nearest to `there_ns` whose low bits in the frame's unit are `low` \[ns\].
pub(crate) fn nearest(low: u32, there_ns: i64) -> i64 {
    let ago = units(there_ns).wrapping_sub(low) as i32;
    before(there_ns, i64::from(ago))
}

/// So many of the frame's units before a time \[ns\].
fn before(time_ns: i64, units: i64) -> i64 {
    (time_ns / TIME_UNIT * TIME_UNIT).saturating_sub(units * TIME_UNIT)
}

/// The low 32 bits of a time in the frame's unit.
pub(crate) fn units(time_ns: i64) -> u32 {
    (time_ns / TIME_UNIT) as u32
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
            (any::<u32>(), -2_000_000_000..2_000_000_000i64),
            (echo, any::<bool>(), 0..4u8, 0..16u8, 0..16u8),
            (0..16u8, any::<u8>()),
            (packet, any_orientation()),
        )
            .prop_map(
                |(
                    (sequence, ago),
                    (echo, hold, state, arming, law),
                    (pace, since),
                    (packet, turn),
                )| {
                    LinkFrame {
                        sequence,
                        stamp_ns: NOW - ago * TIME_UNIT,
                        sent_ns: NOW - ago * TIME_UNIT,
                        echo: echo.map(|(units, held_ns)| Echo {
                            sent_ns: NOW - units * TIME_UNIT,
                            held_ns,
                        }),
                        hold,
                        state: OperatingState::from_code(state).unwrap(),
                        arming,
                        law,
                        pace,
                        since_content: if pace > 0 { since } else { 0 },
                        packet: match pace > 0 && since > 0 {
                            true => Packet::default(),
                            false => Packet {
                                valid: packet.0,
                                position: packet.1,
                                vector: packet.2,
                                energy: packet.3,
                            },
                        },
                        orientation: turn.filter(|_| pace == 0 || since == 0),
                    }
                },
            )
    }

    fn any_orientation() -> impl Strategy<Value = Option<PackedOrientation>> {
        let bytes = any::<[u8; PackedOrientation::LENGTH]>();
        proptest::option::of(bytes)
            .prop_map(|own| own.and_then(|bytes| PackedOrientation::from_bytes(bytes).ok()))
    }

    fn example() -> [u8; FRAME_LENGTH] {
        encode(&keep_alive(0, 0))[..].try_into().unwrap()
    }

    fn keep_alive(pace: u8, since_content: u8) -> LinkFrame {
        LinkFrame {
            sequence: 1,
            stamp_ns: NOW,
            sent_ns: NOW,
            echo: None,
            hold: false,
            state: OperatingState::Enabled,
            arming: 3,
            law: 5,
            pace,
            since_content,
            packet: Packet::default(),
            orientation: None,
        }
    }

    #[test]
    fn a_frame_without_content_is_less_than_half_as_long_on_the_wire() {
        let bytes = encode(&keep_alive(4, 3));
        assert_eq!(bytes.len() + SEAL_LENGTH, 29);
        let frame = decode(&bytes, NOW, 0).unwrap();
        assert_eq!((frame.pace, frame.since_content), (4, 3));
        // Of an end that leaves nothing out, or that has content, it is none.
        for (place, value) in [(5, bytes[5] & 0x0f), (18, 0)] {
            let mut other = bytes.to_vec();
            other[place] = value;
            let found = decode(&other, NOW, 0);
            assert!(matches!(found, Err(FrameError::Length { found: 19 })));
        }
    }

    #[test]
    fn the_rate_fits_rokviss_uplink() {
        let rate = WIRE_LENGTH * 8 * 500;
        assert!((200_000..256_000).contains(&rate), "{rate} bit/s");
    }

    #[test]
    fn each_fault_is_refused_by_its_kind() {
        let good = example();
        assert!(matches!(
            decode(&good[..49], NOW, 0),
            Err(FrameError::Length { found: 49 })
        ));
        for now in [NOW - 51_000_000, NOW + 10_001_000_000] {
            let frame = decode(&good, now, 0).unwrap();
            assert!(matches!(frame.check_age(now), Err(FrameError::Time { .. })));
        }
        for now in [NOW - 49_000_000, NOW + 9_999_000_000] {
            let frame = decode(&good, now, 0).unwrap();
            assert_eq!(frame.check_age(now), Ok(()));
        }
        for (offset, value) in [(18, 10.1), (30, f32::NAN), (42, f32::INFINITY), (38, -1e5)] {
            let mut other = good;
            other[offset..offset + 4].copy_from_slice(&f32::to_le_bytes(value));
            assert!(matches!(
                decode(&other, NOW, 0),
                Err(FrameError::Value { .. })
            ));
        }
    }

    #[test]
    fn the_senders_clock_need_not_agree() {
        // Sent half a second ago by a clock that is eight hours ahead.
        let ahead = 8 * 3_600_000_000_000;
        let frame = decode(&example(), NOW - ahead + 500_000_000, ahead).unwrap();
        assert_eq!(frame.stamp_ns, NOW);
        assert_eq!(frame.sent_ns, NOW - ahead);
    }

    proptest! {
        #[test]
        fn what_is_encoded_is_decoded(frame in any_frame()) {
            prop_assert_eq!(decode(&encode(&frame), NOW, 0), Ok(frame));
        }

        #[test]
        fn garbage_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..100), now: i64, ahead: i64) {
            let _ = decode(&bytes, now, ahead);
        }

        #[test]
        fn what_is_decoded_is_finite(bytes in proptest::collection::vec(any::<u8>(), POSE_LENGTH), pose: bool, now: i64, ahead: i64) {
            let length = if pose { POSE_LENGTH } else { FRAME_LENGTH };
            if let Ok(frame) = decode(&bytes[..length], now, ahead) {
                let packet = frame.packet;
                let all = packet.position.iter().chain(&packet.vector).chain(&packet.energy);
                prop_assert!(all.into_iter().all(|value| value.is_finite()));
                let _ = frame.check_age(now);
            }
        }
    }
}

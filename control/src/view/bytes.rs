//! Views as bytes, little-endian.
//!
//! | offset | type | content |
//! |---:|---|---|
//! | 0 | u32 | number, one more with every view sent |
//! | 4 | u32 | sent: sender's clock in units of 8 ns, the low 32 bits (34 s) |
//! | 8 | u8 | bits 0–3 number of joints, 1 … 8; 0: it says why the arm is in its state |
//!
//! Where the arm is:
//!
//! | offset | type | content |
//! |---:|---|---|
//! | 8 | u8 | bit 4 in contact, 5 touches, 6 forces valid, 7 near rest |
//! | 9 | u8 | the surface that is touched |
//! | 10 | u8 | zero |
//! | 11 | f32 × 3 | position of the tip, arm's base frame \[m\] |
//! | 23 | f32 × 3 | force of the contact on the tip, arm's base frame \[N\] |
//! | 35 | f32 × 2 | normal and tangential force of the contact \[N\] |
//! | 43 | f32 × joints | joint positions \[rad\], \[m\] of a prismatic joint |
//!
//! Why the arm is in its state:
//!
//! | offset | type | content |
//! |---:|---|---|
//! | 9 | u8 | operating state |
//! | 10 | up to 96 bytes | why, UTF-8 |

use super::{ArmView, ContactView, Reason, SentView, View, ViewError};
use crate::delay::{POSITION_LIMIT, VECTOR_LIMIT};
use crate::frame::{nearest, units};
use crate::operating::OperatingState;
use crate::short_bytes::ShortBytes;
use ferntast_model::{Joints, MAX_JOINTS};

/// Length of what stands before the joints \[bytes\].
pub(super) const BEFORE_JOINTS: usize = 43;
/// Length of what stands before a reason \[bytes\].
const BEFORE_REASON: usize = 10;
/// Length of the longest reason \[bytes\].
pub const LONGEST_REASON: usize = 96;
/// Length of the longest view \[bytes\].
pub const LONGEST_VIEW: usize = BEFORE_REASON + LONGEST_REASON;
const _: () = assert!(BEFORE_JOINTS + 4 * MAX_JOINTS <= LONGEST_VIEW);
/// Largest position of a joint \[rad\] or \[m\].
const JOINT_LIMIT: f32 = 10_000.0;

const IN_CONTACT: u8 = 1 << 4;
const TOUCHES: u8 = 1 << 5;
const FORCES_VALID: u8 = 1 << 6;
const NEAR_REST: u8 = 1 << 7;
const COUNT: u8 = 0x0f;

/// A view as bytes.
pub type ViewBytes = ShortBytes<LONGEST_VIEW>;

/// The bytes of `view`, the `number`th, sent at `now_ns`. Values are written as they are;
/// [`decode`] refuses those that are out of range.
pub fn encode(view: &View, number: u32, now_ns: i64) -> ViewBytes {
    let mut bytes = [0; LONGEST_VIEW];
    bytes[..4].copy_from_slice(&number.to_le_bytes());
    bytes[4..8].copy_from_slice(&units(now_ns).to_le_bytes());
    let length = match view {
        View::Arm(arm) => put_arm(&mut bytes, arm),
        View::Reason(reason) => {
            let text = reason.text().as_bytes();
            bytes[9] = reason.state.code();
            bytes[BEFORE_REASON..BEFORE_REASON + text.len()].copy_from_slice(text);
            BEFORE_REASON + text.len()
        }
    };
    ViewBytes::new(bytes, length)
}

/// Writes where the arm is; gives the length of the view.
fn put_arm(bytes: &mut [u8; LONGEST_VIEW], arm: &ArmView) -> usize {
    let contact = &arm.contact;
    let flag = |is_set: bool, flag: u8| if is_set { flag } else { 0 };
    bytes[8] = arm.joints.len() as u8
        | flag(contact.in_contact, IN_CONTACT)
        | flag(contact.touches, TOUCHES)
        | flag(contact.valid, FORCES_VALID)
        | flag(contact.near_rest, NEAR_REST);
    bytes[9] = contact.edge;
    let numbers = arm.tip.iter().chain(&arm.force).chain(&contact.forces);
    let numbers = numbers.chain(arm.joints.iter());
    for (place, number) in bytes[11..].chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    BEFORE_JOINTS + 4 * arm.joints.len()
}

/// Reads a view received at `now_ns` \[ns since the UNIX epoch\] from a sender whose clock is
/// `ahead_ns` \[ns\] ahead.
///
/// # Errors
///
/// [`ViewError`]. Never panics, whatever the bytes.
pub fn decode(bytes: &[u8], now_ns: i64, ahead_ns: i64) -> Result<SentView, ViewError> {
    let found = bytes.len();
    let joints = usize::from(bytes.get(8).copied().unwrap_or_default() & COUNT);
    let length = ViewError::Length { found, joints };
    let (header, rest) = bytes.split_first_chunk::<BEFORE_REASON>().ok_or(length)?;
    let word = |offset: usize| std::array::from_fn(|index| header[offset + index]);
    let view = match joints {
        0 => View::Reason(reason(header[9], rest, length)?),
        _ => View::Arm(arm(bytes, joints, length)?),
    };
    let stamp_ns = nearest(u32::from_le_bytes(word(4)), now_ns.saturating_add(ahead_ns));
    Ok(SentView {
        number: u32::from_le_bytes(word(0)),
        sent_ns: stamp_ns.saturating_sub(ahead_ns),
        view,
    })
}

/// Why the arm is in its state; `length` says what is wrong where it is too long.
fn reason(state: u8, text: &[u8], length: ViewError) -> Result<Reason, ViewError> {
    if text.len() > LONGEST_REASON {
        return Err(length);
    }
    let state = OperatingState::from_code(state).ok_or(ViewError::Text)?;
    let text = str::from_utf8(text).map_err(|_| ViewError::Text)?;
    // It is shown on a terminal, too.
    match text.chars().any(char::is_control) {
        true => Err(ViewError::Text),
        false => Ok(Reason::new(state, text)),
    }
}

/// Where the arm of so many `joints` is; `length` says what is wrong where it has others.
fn arm(bytes: &[u8], joints: usize, length: ViewError) -> Result<ArmView, ViewError> {
    let (header, rest) = bytes.split_first_chunk::<BEFORE_JOINTS>().ok_or(length)?;
    let (angles, []) = rest.as_chunks::<4>() else {
        return Err(length);
    };
    let mut positions = [0.0; MAX_JOINTS];
    for (place, angle) in positions.iter_mut().zip(angles) {
        *place = f32::from_le_bytes(*angle);
    }
    // More than an arm has.
    let positions = positions
        .get(..joints)
        .filter(|own| own.len() == angles.len());
    let positions = Joints::from_slice(positions.ok_or(length)?);
    let word = |offset: usize| std::array::from_fn(|index| header[offset + index]);
    let number = |offset: usize| f32::from_le_bytes(word(offset));
    let three = |offset: usize| [0, 4, 8].map(|index| number(offset + index));
    let view = ArmView {
        joints: positions.map_err(|_| length)?,
        tip: three(11),
        force: three(23),
        contact: ContactView {
            in_contact: header[8] & IN_CONTACT != 0,
            touches: header[8] & TOUCHES != 0,
            valid: header[8] & FORCES_VALID != 0,
            near_rest: header[8] & NEAR_REST != 0,
            edge: header[9],
            forces: [number(35), number(39)],
        },
    };
    check("position of the tip", &view.tip, POSITION_LIMIT)?;
    check("force", &view.force, VECTOR_LIMIT)?;
    check("force of the contact", &view.contact.forces, VECTOR_LIMIT)?;
    check("joint position", &view.joints, JOINT_LIMIT)?;
    Ok(view)
}

fn check(field: &'static str, values: &[f32], limit: f32) -> Result<(), ViewError> {
    let bad = |value: &&f32| !(value.is_finite() && value.abs() <= limit);
    match values.iter().find(bad) {
        None => Ok(()),
        Some(&value) => Err(ViewError::Value {
            field,
            value,
            limit,
        }),
    }
}

//! What the checks and conversions of several samples share.

use super::JOINT_NAMES;
use crate::{InvalidMessage, Time};

/// Every joint, for error texts.
pub(super) const KNOWN_JOINTS: &str = "joint_1, joint_2";

/// Refuses a stamp of zero and one that ROS 2 cannot hold.
pub(super) fn stamp(stamp: Time) -> Result<(), InvalidMessage> {
    if !stamp.is_valid() {
        Err(InvalidMessage::ZeroStamp)
    } else if !stamp.fits_ros() {
        let nanos = stamp.nanos();
        Err(InvalidMessage::LateStamp { nanos })
    } else {
        Ok(())
    }
}

/// Refuses NaN and infinity in any of `values`.
pub(super) fn finite(field: &'static str, values: &[f64]) -> Result<(), InvalidMessage> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(InvalidMessage::NotFinite { field, value }),
        None => Ok(()),
    }
}

/// Refuses infinity; NaN stands for "not measured yet".
pub(super) fn finite_or_nan(field: &'static str, value: f64) -> Result<(), InvalidMessage> {
    if value.is_nan() {
        Ok(())
    } else {
        finite(field, &[value])
    }
}

/// How far the norm of an orientation may be from 1.
const NORM_TOLERANCE: f64 = 1e-3;

/// Refuses what is no unit quaternion.
pub(super) fn unit_quaternion(
    field: &'static str,
    quaternion: &[f64; 4],
) -> Result<(), InvalidMessage> {
    finite(field, quaternion)?;
    let norm = quaternion.iter().map(|q| q * q).sum::<f64>().sqrt();
    if (norm - 1.0).abs() > NORM_TOLERANCE {
        return Err(InvalidMessage::NotUnit { norm });
    }
    Ok(())
}

/// Refuses flags other than 0 and 1, which ROS 2 could not carry.
pub(super) fn flag(field: &'static str, flag: u8) -> Result<(), InvalidMessage> {
    if flag <= 1 {
        Ok(())
    } else {
        Err(unknown(field, flag, "0, 1"))
    }
}

/// Refuses a code without a name.
pub(super) fn code(
    field: &'static str,
    name: Option<&'static str>,
    code: impl ToString,
    known: &'static str,
) -> Result<(), InvalidMessage> {
    match name {
        Some(_) => Ok(()),
        None => Err(unknown(field, code, known)),
    }
}

/// The joint of that name, from 0.
pub(super) fn joint(name: &str) -> Result<u8, InvalidMessage> {
    let joint = JOINT_NAMES.iter().position(|known| *known == name);
    joint
        .and_then(|index| u8::try_from(index).ok())
        .ok_or_else(|| unknown("joint", name, KNOWN_JOINTS))
}

/// The error for a word or code that is not among `known`.
pub(super) fn unknown(
    field: &'static str,
    found: impl ToString,
    known: &'static str,
) -> InvalidMessage {
    InvalidMessage::Unknown {
        field,
        found: found.to_string(),
        known,
    }
}

/// The name on the wire. A code without a name comes out as a word that the
/// way back refuses.
pub(super) fn wire_name(name: Option<&'static str>, code: impl ToString) -> String {
    match name {
        Some(name) => name.to_owned(),
        None => format!("unknown {}", code.to_string()),
    }
}

/// Fails to compile unless the sample is as large as its fields together,
/// that is, unless it has no padding, whose bytes would cross shared memory
/// unset.
macro_rules! no_padding {
    ($sample:ty: $($field:ty),+ $(,)?) => {
        const _: () = assert!(size_of::<$sample>() == 0 $(+ size_of::<$field>())+);
    };
}
pub(super) use no_padding;

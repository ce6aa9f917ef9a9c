//! What the checks and conversions of several samples share.

use crate::{InvalidMessage, Text, Time};

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

/// Refuses NaN and infinity, unless they stand for something.
pub(super) fn number(
    field: &'static str,
    value: f64,
    or_nan: bool,
    or_infinite: bool,
) -> Result<(), InvalidMessage> {
    match (or_nan && value.is_nan()) || (or_infinite && value == f64::INFINITY) {
        true => Ok(()),
        false => finite(field, &[value]),
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

/// A text that must not be cut.
pub(super) fn whole<const N: usize>(
    field: &'static str,
    text: &str,
    known: &'static str,
) -> Result<Text<N>, InvalidMessage> {
    let own = Text::new(text);
    match own.as_str() == text {
        true => Ok(own),
        false => Err(unknown(field, text, known)),
    }
}

/// Refuses an empty text.
pub(super) fn not_empty<const N: usize>(
    field: &'static str,
    text: Text<N>,
    known: &'static str,
) -> Result<(), InvalidMessage> {
    match text.is_empty() {
        true => Err(unknown(field, text, known)),
        false => Ok(()),
    }
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

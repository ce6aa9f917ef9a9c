//! Who sent something, on the wire.

use super::{Identity, checks};
use crate::InvalidMessage;

/// 16 hexadecimal digits; empty for 0, which is nobody.
pub(super) fn text(identity: Identity) -> String {
    match identity {
        0 => String::new(),
        _ => format!("{identity:016x}"),
    }
}

/// The way back from [`text`].
pub(super) fn read(field: &'static str, text: &str) -> Result<Identity, InvalidMessage> {
    if text.is_empty() {
        return Ok(0);
    }
    let refuse = || checks::unknown(field, text, "(empty), 1 to 16 hexadecimal digits");
    // from_str_radix takes a leading plus sign, which is no digit.
    if text.starts_with('+') {
        return Err(refuse());
    }
    u64::from_str_radix(text, 16).map_err(|_| refuse())
}

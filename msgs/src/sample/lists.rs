//! Lists of parameters that go together, in a fixed place.

use crate::InvalidMessage;

/// The most parameters that a message has room for.
pub const MAX_TWIN_PARAMETERS: usize = 16;

/// Refuses a list that is longer than there is room for.
pub(super) fn fits(field: &'static str, found: usize, room: usize) -> Result<(), InvalidMessage> {
    match found > room {
        true => Err(length(field, found, room)),
        false => Ok(()),
    }
}

/// Fills the places from a list that has to have `count` elements.
pub(super) fn fill<T, R>(
    field: &'static str,
    places: &mut [T],
    count: u32,
    list: &[R],
    read: impl Fn(&R) -> T,
) -> Result<(), InvalidMessage> {
    if list.len() != count as usize {
        return Err(length(field, list.len(), count as usize));
    }
    for (place, element) in places.iter_mut().zip(list) {
        *place = read(element);
    }
    Ok(())
}

/// The error for a list that is not as long as it should be.
pub(super) fn length(field: &'static str, found: usize, expected: usize) -> InvalidMessage {
    InvalidMessage::WrongLength {
        field,
        found,
        expected,
    }
}

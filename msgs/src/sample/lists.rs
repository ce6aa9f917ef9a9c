//! Lists of parameters that go together, in a fixed place.

use crate::InvalidMessage;

/// The most parameters that a message has room for.
pub const MOST_PARAMETERS: usize = 16;

/// Room for a number of each parameter; those after the last are zero.
pub(super) type Numbers = [f64; MOST_PARAMETERS];

/// The error for a list that is not as long as it should be.
pub(super) fn length(field: &'static str, found: usize, expected: usize) -> InvalidMessage {
    InvalidMessage::WrongLength {
        field,
        found,
        expected,
    }
}

/// Refuses more parameters than there is room for.
pub(super) fn count(count: usize) -> Result<(), InvalidMessage> {
    match count > MOST_PARAMETERS {
        true => Err(length("names", count, MOST_PARAMETERS)),
        false => Ok(()),
    }
}

/// A list that has to be as long as that of the names.
pub(super) fn numbers(
    field: &'static str,
    list: &[f64],
    expected: usize,
) -> Result<Numbers, InvalidMessage> {
    if list.len() != expected {
        return Err(length(field, list.len(), expected));
    }
    let mut numbers = [0.0; MOST_PARAMETERS];
    for (place, value) in numbers.iter_mut().zip(list) {
        *place = *value;
    }
    Ok(numbers)
}

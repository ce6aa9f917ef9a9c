//! Bytes of a message, in place.

use std::ops::Deref;

/// Up to `MOST` bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShortBytes<const MOST: usize> {
    bytes: [u8; MOST],
    length: usize,
}

impl<const MOST: usize> ShortBytes<MOST> {
    /// The first `length` of these, or all where there are no more.
    pub(crate) fn new(bytes: [u8; MOST], length: usize) -> ShortBytes<MOST> {
        ShortBytes {
            bytes,
            length: length.min(MOST),
        }
    }
}

impl<const MOST: usize> Deref for ShortBytes<MOST> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..self.length.min(MOST)]
    }
}

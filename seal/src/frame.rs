//! Sealed frames: AES-256-CCM with a tag of 8 bytes (RFC 3610; the tag's length as
//! in AES_256_CCM_8 of RFC 6655).
//!
//! | offset | content |
//! |---:|---|
//! | 0 | kind of message |
//! | 1 | number of the key, so that a frame from before a restart is told from a forged one |
//! | 2 | number of the frame, u32 little-endian: never twice under one key; with zeros behind it the nonce |
//! | 6 | what the frame says, 46 bytes, encrypted |
//! | 52 | tag over all of it |
//!
//! Two keys, one a direction: a frame that is sent back to its sender is forged
//! there. Who has no key forges one of 2⁶⁴; at 100 000 attempts a second that
//! takes some million years.

use aes::Aes256;
use ccm::{
    Ccm, KeyInit,
    aead::AeadInPlace,
    consts::{U8, U13},
};

use crate::{
    refusal::Refusal,
    window::ReplayWindow,
    wire::{FRAME, first_byte},
};

type Cipher = Ccm<Aes256, U8, U13>;

const HEADER: usize = 6;
const TAG: usize = 8;
/// Number and content of a frame, as the link's ends make and take it \[bytes\].
pub const PLAIN_LENGTH: usize = 50;
/// The same, sealed \[bytes\].
pub const SEALED_LENGTH: usize = HEADER + (PLAIN_LENGTH - 4) + TAG;
/// So many frames are sealed under one key at most: half of the numbers, fifty
/// days at 500 Hz.
const MOST_FRAMES: u32 = 1 << 31;

/// A frame as the link's ends make it: four bytes of number, then its content.
pub type PlainFrame = [u8; PLAIN_LENGTH];
/// A frame as it goes over the wire.
pub type SealedFrame = [u8; SEALED_LENGTH];

/// The keys of one handshake.
pub(crate) struct Keys {
    /// Tells them from those of other handshakes.
    pub number: u8,
    sends: Cipher,
    receives: Cipher,
    window: ReplayWindow,
    sealed: u32,
}

impl Keys {
    pub fn new(number: u8, sends: &[u8; 32], receives: &[u8; 32]) -> Keys {
        Keys {
            number,
            sends: Cipher::new(sends.into()),
            receives: Cipher::new(receives.into()),
            window: ReplayWindow::default(),
            sealed: 0,
        }
    }

    /// Whether it is time for another handshake.
    pub fn is_worn(&self) -> bool {
        self.sealed >= MOST_FRAMES / 2
    }

    /// Seals `plain`, whose number must not have been used before; `None` when the
    /// key is used up.
    pub fn seal(&mut self, plain: &PlainFrame) -> Option<SealedFrame> {
        if self.sealed >= MOST_FRAMES {
            return None;
        }
        self.sealed += 1;
        let mut sealed = [0; SEALED_LENGTH];
        sealed[0] = first_byte(FRAME);
        sealed[1] = self.number;
        sealed[2..2 + PLAIN_LENGTH].copy_from_slice(plain);
        let (header, rest) = sealed.split_first_chunk_mut::<HEADER>()?;
        let (content, tag) = rest.split_at_mut(PLAIN_LENGTH - 4);
        let made = self
            .sends
            .encrypt_in_place_detached(&nonce(header).into(), header, content)
            .ok()?;
        tag.copy_from_slice(&made);
        Some(sealed)
    }

    /// Opens a frame, once.
    pub fn open(&mut self, sealed: &SealedFrame) -> Result<PlainFrame, Refusal> {
        let (header, rest) = sealed
            .split_first_chunk::<HEADER>()
            .ok_or(Refusal::Forged)?;
        let [.., a, b, c, d] = *header;
        let number = u32::from_le_bytes([a, b, c, d]);
        let (content, tag) = rest.split_at(PLAIN_LENGTH - 4);
        let mut plain = [0; PLAIN_LENGTH];
        plain[..4].copy_from_slice(&header[2..]);
        plain[4..].copy_from_slice(content);
        self.receives
            .decrypt_in_place_detached(&nonce(header).into(), header, &mut plain[4..], tag.into())
            .map_err(|_| Refusal::Forged)?;
        // Only what carries the right tag can be a replay: a forged number tells nothing.
        if !self.window.is_new(number) {
            return Err(Refusal::Replayed);
        }
        self.window.take(number);
        Ok(plain)
    }
}

fn nonce(header: &[u8; HEADER]) -> [u8; 13] {
    let mut nonce = [0; 13];
    nonce[..4].copy_from_slice(&header[2..]);
    nonce
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pair() -> (Keys, Keys) {
        (
            Keys::new(3, &[1; 32], &[2; 32]),
            Keys::new(3, &[2; 32], &[1; 32]),
        )
    }

    fn plain(number: u32, content: u8) -> PlainFrame {
        let mut plain = [content; PLAIN_LENGTH];
        plain[..4].copy_from_slice(&number.to_le_bytes());
        plain
    }

    #[test]
    fn a_sealed_frame_has_60_bytes_and_hides_its_content() {
        let (mut here, _) = pair();
        let sealed = here.seal(&plain(9, 0xab)).unwrap();
        assert_eq!(sealed.len(), 60);
        assert_eq!(sealed[..6], [0x40, 3, 9, 0, 0, 0]);
        assert!(sealed[6..52].iter().filter(|byte| **byte == 0xab).count() < 8);
    }

    #[test]
    fn what_goes_back_to_its_sender_is_forged() {
        let (mut here, _) = pair();
        let sealed = here.seal(&plain(0, 1)).unwrap();
        assert_eq!(here.open(&sealed), Err(Refusal::Forged));
    }

    proptest! {
        #[test]
        fn what_is_sealed_is_opened_once(numbers in proptest::collection::btree_set(0..900u32, 1..100), content: u8) {
            let (mut here, mut there) = pair();
            let sealed: Vec<_> = numbers.iter().map(|own| here.seal(&plain(*own, content)).unwrap()).collect();
            // The last first: all are within the window.
            for (sealed, number) in sealed.iter().zip(&numbers).rev() {
                prop_assert_eq!(there.open(sealed), Ok(plain(*number, content)));
            }
            for sealed in &sealed {
                prop_assert_eq!(there.open(sealed), Err(Refusal::Replayed));
            }
        }

        #[test]
        fn any_flipped_bit_is_forged(number: u32, bit in 0..SEALED_LENGTH * 8) {
            let (mut here, mut there) = pair();
            let good = here.seal(&plain(number, 5)).unwrap();
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            prop_assert_eq!(there.open(&bad), Err(Refusal::Forged));
            // Nothing is remembered of it.
            prop_assert!(there.open(&good).is_ok());
        }

        #[test]
        fn garbage_is_forged(garbage in proptest::array::uniform32(any::<u8>())) {
            let (_, mut there) = pair();
            let mut sealed = [0; SEALED_LENGTH];
            sealed[..32].copy_from_slice(&garbage);
            prop_assert_eq!(there.open(&sealed), Err(Refusal::Forged));
        }
    }
}

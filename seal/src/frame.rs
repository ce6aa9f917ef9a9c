//! Sealed frames: AES-256-CCM with a tag of 8 bytes (RFC 3610; the tag's length as
//! in AES_256_CCM_8 of RFC 6655).
//!
//! | offset | content |
//! |---:|---|
//! | 0 | kind of message |
//! | 1 | number of the key, so that a frame from before a restart is told from a forged one |
//! | 2 | number of the frame, u32 little-endian: never twice under one key; with zeros behind it the nonce |
//! | 6 | what the frame says, 46 bytes, 54 with an orientation, or 15 of a keep-alive, encrypted |
//! | 52, 60 or 21 | tag over all of it |
//!
//! Two keys, one a direction: a frame that is sent back to its sender is forged
//! there. Who has no key forges one of 2⁶⁴; at 100 000 attempts a second that
//! takes some million years.
//!
//! A view, which is of another kind, is sealed in the same way, with what it shows in place of what
//! a frame says. The two kinds count for themselves: the kind is in the nonce, in the byte behind
//! the number, and what is played again is told by a window of each.

use aes::Aes256;
use ccm::{
    Ccm, KeyInit,
    aead::AeadInPlace,
    consts::{U8, U13},
};

use std::ops::{Deref, DerefMut};

use crate::{
    refusal::Refusal,
    window::ReplayWindow,
    wire::{FRAME, VIEW, first_byte},
};

type Cipher = Ccm<Aes256, U8, U13>;

const HEADER: usize = 6;
const TAG: usize = 8;
/// Number and content of a frame, as the link's ends make and take it \[bytes\].
pub const PLAIN_LENGTH: usize = 50;
/// The same, sealed \[bytes\].
pub const SEALED_LENGTH: usize = PLAIN_LENGTH + ADDED;
/// Number and content of a frame with an orientation, the longest \[bytes\].
pub const LONG_LENGTH: usize = 58;
/// Number and content of a view have so many at most \[bytes\].
pub const LONGEST_VIEW: usize = 106;
/// Number and content of a keep-alive \[bytes\].
pub const SHORT_LENGTH: usize = 19;
/// What a seal adds: kind, number of the key, tag \[bytes\].
const ADDED: usize = HEADER - 4 + TAG;
/// So many frames are sealed under one key at most: half of the numbers, fifty
/// days at 500 Hz.
const MOST_FRAMES: u32 = 1 << 31;

/// A frame or a view as the link's ends make it: four bytes of number, then its content.
pub type PlainFrame = FrameBytes<LONGEST_VIEW>;
/// A frame or a view as it goes over the wire.
pub type SealedFrame = FrameBytes<{ LONGEST_VIEW + ADDED }>;

/// What is sealed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A frame of the link, either way.
    Frame,
    /// What the arm's end shows of its arm, on which nothing acts.
    View,
}

impl Kind {
    /// As the first byte of a message has it.
    const fn code(self) -> u8 {
        match self {
            Kind::Frame => FRAME,
            Kind::View => VIEW,
        }
    }

    /// Whether one has that many bytes when it is sealed.
    pub(crate) fn has_length(self, sealed: usize) -> bool {
        let plain = sealed.saturating_sub(ADDED);
        match self {
            Kind::Frame => [PLAIN_LENGTH, LONG_LENGTH, SHORT_LENGTH].contains(&plain),
            Kind::View => (5..=LONGEST_VIEW).contains(&plain),
        }
    }
}

/// Bytes of a frame, in place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameBytes<const MOST: usize> {
    bytes: [u8; MOST],
    length: usize,
}

impl<const MOST: usize> FrameBytes<MOST> {
    fn zeros(length: usize) -> Self {
        FrameBytes {
            bytes: [0; MOST],
            length: length.min(MOST),
        }
    }
}

impl<const MOST: usize> Deref for FrameBytes<MOST> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

impl<const MOST: usize> DerefMut for FrameBytes<MOST> {
    fn deref_mut(&mut self) -> &mut [u8] {
        &mut self.bytes[..self.length]
    }
}

/// The keys of one handshake.
pub(crate) struct Keys {
    /// Tells them from those of other handshakes.
    pub number: u8,
    sends: Cipher,
    receives: Cipher,
    frames: ReplayWindow,
    views: ReplayWindow,
    sealed: u32,
    opened: u32,
}

impl Keys {
    pub fn new(number: u8, sends: &[u8; 32], receives: &[u8; 32]) -> Keys {
        Keys {
            number,
            sends: Cipher::new(sends.into()),
            receives: Cipher::new(receives.into()),
            frames: ReplayWindow::default(),
            views: ReplayWindow::default(),
            sealed: 0,
            opened: 0,
        }
    }

    /// Whether it is time for another handshake.
    pub fn is_worn(&self) -> bool {
        self.most() >= MOST_FRAMES / 2
    }

    /// Whether it is for an end that sends more, or has counted what was lost on its way here.
    pub fn may_be_renewed(&self) -> bool {
        self.most() >= MOST_FRAMES / 4
    }

    /// Frames and views that went one way, of that with more.
    fn most(&self) -> u32 {
        self.sealed.max(self.opened)
    }

    /// As if so many frames had been sealed and opened.
    #[cfg(test)]
    pub fn wear(&mut self, sealed: u32, opened: u32) {
        (self.sealed, self.opened) = (sealed, opened);
    }

    /// Seals `plain`, of a length that its kind has, whose number must not have been used before
    /// for one of that kind; `None` when the key is used up.
    pub fn seal(&mut self, kind: Kind, plain: &[u8]) -> Option<SealedFrame> {
        if self.sealed >= MOST_FRAMES || !kind.has_length(plain.len() + ADDED) {
            return None;
        }
        self.sealed += 1;
        let mut sealed = SealedFrame::zeros(plain.len() + ADDED);
        sealed[0] = first_byte(kind.code());
        sealed[1] = self.number;
        sealed[2..2 + plain.len()].copy_from_slice(plain);
        let (header, rest) = sealed.split_first_chunk_mut::<HEADER>()?;
        let (content, tag) = rest.split_at_mut_checked(plain.len() - 4)?;
        let made = self
            .sends
            .encrypt_in_place_detached(&nonce(kind, header).into(), header, content)
            .ok()?;
        tag.copy_from_slice(&made);
        Some(sealed)
    }

    /// Opens one of that kind, once.
    pub fn open(&mut self, kind: Kind, sealed: &[u8]) -> Result<PlainFrame, Refusal> {
        let (header, rest) = sealed
            .split_first_chunk::<HEADER>()
            .ok_or(Refusal::Forged)?;
        let [.., a, b, c, d] = *header;
        let number = u32::from_le_bytes([a, b, c, d]);
        let (content, tag) = rest.split_last_chunk::<TAG>().ok_or(Refusal::Forged)?;
        if !kind.has_length(sealed.len()) {
            return Err(Refusal::Forged);
        }
        let mut plain = PlainFrame::zeros(4 + content.len());
        plain[..4].copy_from_slice(&header[2..]);
        plain[4..].copy_from_slice(content);
        self.receives
            .decrypt_in_place_detached(
                &nonce(kind, header).into(),
                header,
                &mut plain[4..],
                tag.into(),
            )
            .map_err(|_| Refusal::Forged)?;
        let window = match kind {
            Kind::Frame => &mut self.frames,
            Kind::View => &mut self.views,
        };
        // Only what carries the right tag can be a replay: a forged number tells nothing.
        if !window.is_new(number) {
            return Err(Refusal::Replayed);
        }
        window.take(number);
        self.opened = self.opened.saturating_add(1);
        Ok(plain)
    }
}

fn nonce(kind: Kind, header: &[u8; HEADER]) -> [u8; 13] {
    let mut nonce = [0; 13];
    nonce[..4].copy_from_slice(&header[2..]);
    nonce[4] = kind.code();
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

    fn of_length(length: usize, number: u32, content: u8) -> Vec<u8> {
        let mut plain = vec![content; length];
        plain[..4].copy_from_slice(&number.to_le_bytes());
        plain
    }

    fn plain(number: u32, content: u8) -> Vec<u8> {
        of_length(PLAIN_LENGTH, number, content)
    }

    #[test]
    fn a_keep_alive_is_sealed_as_the_others_and_other_lengths_are_not() {
        let (mut here, mut there) = pair();
        let sealed = here
            .seal(Kind::Frame, &of_length(SHORT_LENGTH, 9, 0xab))
            .unwrap();
        assert_eq!(sealed.len(), 29);
        let mut bad = sealed;
        bad[20] ^= 1;
        assert_eq!(there.open(Kind::Frame, &bad), Err(Refusal::Forged));
        let opened = there.open(Kind::Frame, &sealed).unwrap();
        assert_eq!(opened[..], of_length(SHORT_LENGTH, 9, 0xab));
        // A whole frame that was cut to that length is none.
        let whole = here.seal(Kind::Frame, &plain(10, 0xab)).unwrap();
        assert_eq!(there.open(Kind::Frame, &whole[..29]), Err(Refusal::Forged));
        assert_eq!(there.open(Kind::Frame, &whole[..28]), Err(Refusal::Forged));
        for length in [4, SHORT_LENGTH + 1, PLAIN_LENGTH - 1] {
            assert!(here.seal(Kind::Frame, &of_length(length, 11, 0)).is_none());
        }
    }

    #[test]
    fn a_sealed_frame_has_60_bytes_and_hides_its_content() {
        let (mut here, _) = pair();
        let sealed = here.seal(Kind::Frame, &plain(9, 0xab)).unwrap();
        assert_eq!(sealed.len(), 60);
        assert_eq!(sealed[..6], [0x50, 3, 9, 0, 0, 0]);
        assert!(sealed[6..52].iter().filter(|byte| **byte == 0xab).count() < 8);
    }

    #[test]
    fn what_goes_back_to_its_sender_is_forged() {
        let (mut here, _) = pair();
        let sealed = here.seal(Kind::Frame, &plain(0, 1)).unwrap();
        assert_eq!(here.open(Kind::Frame, &sealed), Err(Refusal::Forged));
    }

    #[test]
    fn a_view_is_no_frame_and_counts_for_itself() {
        let (mut here, mut there) = pair();
        let same = plain(9, 0xab);
        let frame = here.seal(Kind::Frame, &same).unwrap();
        let view = here.seal(Kind::View, &same).unwrap();
        // Under one nonce both would be hidden by the same key stream.
        assert_ne!(frame[6..], view[6..]);
        assert_eq!(there.open(Kind::Frame, &view), Err(Refusal::Forged));
        assert_eq!(there.open(Kind::View, &frame), Err(Refusal::Forged));
        let mut renamed = view;
        renamed[0] = frame[0];
        assert_eq!(there.open(Kind::Frame, &renamed), Err(Refusal::Forged));
        for (kind, sealed) in [(Kind::Frame, &frame), (Kind::View, &view)] {
            assert_eq!(there.open(kind, sealed).unwrap()[..], same);
            assert_eq!(there.open(kind, sealed), Err(Refusal::Replayed));
        }
        let longest = of_length(LONGEST_VIEW, 10, 1);
        assert_eq!(here.seal(Kind::View, &longest).unwrap().len(), 116);
        for length in [4, LONGEST_VIEW + 1] {
            assert!(here.seal(Kind::View, &of_length(length, 11, 0)).is_none());
        }
    }

    proptest! {
        #[test]
        fn what_is_sealed_is_opened_once(numbers in proptest::collection::btree_set(0..900u32, 1..100), content: u8) {
            let (mut here, mut there) = pair();
            let sealed: Vec<_> = numbers.iter().map(|own| here.seal(Kind::Frame, &plain(*own, content)).unwrap()).collect();
            // The last first: all are within the window.
            for (sealed, number) in sealed.iter().zip(&numbers).rev() {
                let opened = there.open(Kind::Frame, sealed).map(|own| own.to_vec());
                prop_assert_eq!(opened, Ok(plain(*number, content)));
            }
            for sealed in &sealed {
                prop_assert_eq!(there.open(Kind::Frame, sealed), Err(Refusal::Replayed));
            }
        }

        #[test]
        fn any_flipped_bit_is_forged(number: u32, bit in 0..SEALED_LENGTH * 8) {
            let (mut here, mut there) = pair();
            let good = here.seal(Kind::Frame, &plain(number, 5)).unwrap();
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            prop_assert_eq!(there.open(Kind::Frame, &bad), Err(Refusal::Forged));
            // Nothing is remembered of it.
            prop_assert!(there.open(Kind::Frame, &good).is_ok());
        }

        #[test]
        fn garbage_is_forged(garbage in proptest::array::uniform32(any::<u8>())) {
            let (_, mut there) = pair();
            let mut sealed = [0; SEALED_LENGTH];
            sealed[..32].copy_from_slice(&garbage);
            prop_assert_eq!(there.open(Kind::Frame, &sealed), Err(Refusal::Forged));
        }
    }
}

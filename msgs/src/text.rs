//! Short texts of fixed size, and counts in words.

use std::fmt;

/// How many of what: "1 row", "2 rows", "2 stretches".
pub fn counted<N: fmt::Display + PartialEq + From<u8>>(count: N, one: &str) -> String {
    let more = match (count == N::from(1), one.ends_with("ch")) {
        (true, _) => "",
        (false, true) => "es",
        (false, false) => "s",
    };
    format!("{count} {one}{more}")
}

/// A UTF-8 text of at most `N` bytes that lives in place, for samples that
/// cross shared memory. Longer texts are cut at a character boundary; bytes
/// that are not UTF-8 read as the valid part before them.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Text<const N: usize>([u8; N]);

impl<const N: usize> Text<N> {
    /// The empty text.
    pub const EMPTY: Text<N> = Text([0; N]);

    /// The first at most `N` bytes of `text`, up to a zero byte if there is one.
    pub const fn new(text: &str) -> Text<N> {
        let source = text.as_bytes();
        let mut end = 0;
        while end < N && end < source.len() && source[end] != 0 {
            end += 1;
        }
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let mut bytes = [0; N];
        bytes
            .split_at_mut(end)
            .0
            .copy_from_slice(source.split_at(end).0);
        Text(bytes)
    }

    /// `value` as it is displayed, cut to `N` bytes; allocates nothing itself.
    pub fn display(value: impl fmt::Display) -> Text<N> {
        use fmt::Write;
        let mut line = Line {
            bytes: [0; N],
            length: 0,
        };
        // An error says that the text was cut, which is meant.
        let _ = write!(line, "{value}");
        Text(line.bytes)
    }

    /// The text; whatever follows the first zero byte or the first byte that
    /// is not UTF-8 does not count.
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|&byte| byte == 0).unwrap_or(N);
        match std::str::from_utf8(&self.0[..end]) {
            Ok(text) => text,
            Err(error) => std::str::from_utf8(&self.0[..error.valid_up_to()]).unwrap_or(""),
        }
    }

    /// Whether there is no text.
    pub fn is_empty(&self) -> bool {
        match self.0.first() {
            None | Some(0) => true,
            Some(byte) => !byte.is_ascii() && self.as_str().is_empty(),
        }
    }
}

impl Text<32> {
    /// A number that the bytes come to: texts of different numbers are different.
    pub(crate) fn sum(&self) -> u64 {
        // An odd factor, so that places count (Knuth 1998, section 6.4).
        const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
        let (words, _) = self.0.as_chunks();
        words.iter().fold(0, |sum: u64, word| {
            sum.wrapping_mul(FACTOR)
                .wrapping_add(u64::from_le_bytes(*word))
        })
    }

    /// Whether it is ASCII with nothing but zeros behind it, as [`Text::new`] makes it of
    /// ASCII: then two texts are equal exactly if their bytes are.
    pub(crate) fn is_plain(&self) -> bool {
        const HIGH: u128 = u128::from_le_bytes([0x80; 16]);
        let half = |half: &[u8; 16]| {
            let bytes = u128::from_le_bytes(*half);
            // The highest bit of each byte that is not zero; bytes below 0x80 do not carry.
            let used = bytes.wrapping_add(HIGH - (HIGH >> 7)) & HIGH;
            // Each of them follows another one, but for the first.
            let plain = bytes & HIGH == 0 && used & !((used << 8) | 0x80) == 0;
            (plain, used)
        };
        let ([first, second], _) = self.0.as_chunks() else {
            return false;
        };
        let ((first, used), (second, behind)) = (half(first), half(second));
        first && second && (used == HIGH || behind == 0)
    }
}

/// Text on its way into a [`Text`].
struct Line<const N: usize> {
    bytes: [u8; N],
    length: usize,
}

impl<const N: usize> fmt::Write for Line<N> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for character in text.chars() {
            let end = self.length + character.len_utf8();
            let place = self.bytes.get_mut(self.length..end).ok_or(fmt::Error)?;
            character.encode_utf8(place);
            self.length = end;
        }
        Ok(())
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl<const N: usize> fmt::Debug for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

impl<const N: usize> fmt::Display for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_not_many() {
        assert_eq!(counted(1_usize, "episode"), "1 episode");
        assert_eq!(counted(0_usize, "episode"), "0 episodes");
        assert_eq!(counted(2_u64, "stretch"), "2 stretches");
    }

    #[test]
    fn plain_texts_are_ascii_and_then_zeros() {
        for name in [
            "",
            "a",
            "joint_1",
            "shoulder_pan_joint",
            "0123456789abcdef0123456789abcdef",
        ] {
            assert!(Text::<32>::new(name).is_plain(), "{name}");
        }
        assert!(!Text::<32>::new("gelenk_ä").is_plain());
        for place in 0..32 {
            let mut bytes = [b'x'; 32];
            bytes[place] = 0;
            assert_eq!(Text(bytes).is_plain(), place == 31, "{place}");
            let mut bytes = [0; 32];
            bytes[place] = 1;
            assert_eq!(Text(bytes).is_plain(), place == 0, "{place}");
            bytes[place] = 0x80;
            assert!(!Text(bytes).is_plain(), "{place}");
        }
    }
}

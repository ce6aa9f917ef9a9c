//! Goes through the bytes of a CDR message whose type the recording describes.
//!
//! It is apart from `ferntast_msgs::cdr`, which decodes types known here by
//! serde: filters look at a field more than once (a copy of the cursor goes
//! its own way), arrays are passed over unread, and recordings of others have
//! plain CDR 2 and wide texts, none of which `cdr-encoding` can do.

use std::borrow::Cow;

use ferntast_msgs::interface::{Count, Primitive};

use super::{
    error::DecodeError,
    layout::{Element, Layout, Member},
};

/// Bytes of a wide character: writers differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WideCharacter {
    Two = 2,
    Four = 4,
}

/// A place in a message. A copy goes its own way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a> {
    body: &'a [u8],
    at: usize,
    little_endian: bool,
    /// Numbers are aligned to their size, at most to this.
    largest_alignment: usize,
    wide: WideCharacter,
}

/// A value that a filter can look at.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Scalar<'a> {
    Number(f64),
    Text(Cow<'a, str>),
}

impl<'a> Cursor<'a> {
    /// At the beginning of the message in `bytes`, header included.
    pub(super) fn new(bytes: &'a [u8], wide: WideCharacter) -> Result<Cursor<'a>, DecodeError> {
        let [high, low, _, _, body @ ..] = bytes else {
            return Err(DecodeError::NoHeader {
                length: bytes.len(),
            });
        };
        // RTPS 2.5, table 10.3: plain CDR and plain CDR 2, big- and little-endian.
        let identifier = u16::from_be_bytes([*high, *low]);
        let (little_endian, largest_alignment) = match identifier {
            0x0000 => (false, 8),
            0x0001 => (true, 8),
            0x0006 => (false, 4),
            0x0007 => (true, 4),
            _ => return Err(DecodeError::NotPlainCdr { identifier }),
        };
        Ok(Cursor {
            body,
            at: 0,
            little_endian,
            largest_alignment,
            wide,
        })
    }

    /// Bytes not gone through.
    pub(super) fn left(&self) -> usize {
        self.body.len().saturating_sub(self.at)
    }

    fn align(&mut self, size: usize) {
        let to = size.min(self.largest_alignment).max(1);
        self.at = self.at.next_multiple_of(to);
    }

    fn take(&mut self, length: u64, what: &'static str) -> Result<&'a [u8], DecodeError> {
        let short = DecodeError::TooShort {
            offset: self.body.len() + 4,
            what,
        };
        let Some(end) = usize::try_from(length)
            .ok()
            .and_then(|length| self.at.checked_add(length))
        else {
            return Err(short);
        };
        let bytes = self.body.get(self.at..end).ok_or(short)?;
        self.at = end;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], DecodeError> {
        self.align(N);
        let mut array = [0; N];
        array.copy_from_slice(self.take(N as u64, what)?);
        if !self.little_endian {
            array.reverse();
        }
        Ok(array)
    }

    /// The number here, whole ones of more than 53 bits rounded.
    pub(super) fn number(&mut self, primitive: Primitive) -> Result<f64, DecodeError> {
        let what = primitive.name();
        Ok(match primitive {
            Primitive::Bool | Primitive::Byte | Primitive::Char | Primitive::Uint8 => {
                self.array::<1>(what)?[0].into()
            }
            Primitive::Int8 => i8::from_le_bytes(self.array(what)?).into(),
            Primitive::Int16 => i16::from_le_bytes(self.array(what)?).into(),
            Primitive::Uint16 => u16::from_le_bytes(self.array(what)?).into(),
            Primitive::Int32 => i32::from_le_bytes(self.array(what)?).into(),
            Primitive::Uint32 => u32::from_le_bytes(self.array(what)?).into(),
            Primitive::Int64 => i64::from_le_bytes(self.array(what)?) as f64,
            Primitive::Uint64 => u64::from_le_bytes(self.array(what)?) as f64,
            Primitive::Float32 => f32::from_le_bytes(self.array(what)?).into(),
            Primitive::Float64 => f64::from_le_bytes(self.array(what)?),
        })
    }

    /// The length in front of a sequence or text.
    fn length(&mut self, bound: Option<u64>, what: &'static str) -> Result<u64, DecodeError> {
        let length = u64::from(u32::from_le_bytes(self.array(what)?));
        match bound {
            Some(bound) if length > bound => Err(DecodeError::OverBound {
                offset: self.at,
                length,
                bound,
            }),
            _ => Ok(length),
        }
    }

    /// The number or text here; not for messages.
    pub(super) fn scalar(&mut self, element: Element) -> Result<Option<Scalar<'a>>, DecodeError> {
        Ok(match element {
            Element::Primitive(primitive) => Some(Scalar::Number(self.number(primitive)?)),
            Element::Text(bound) => {
                let bytes = self.text(bound)?;
                Some(Scalar::Text(String::from_utf8_lossy(bytes)))
            }
            Element::WideText(bound) => {
                let bytes = self.wide_text(bound)?;
                let size = self.wide as usize;
                let units = bytes.chunks_exact(size).map(|unit| {
                    // Of four bytes the lower two count: it is UTF-16 all the same.
                    match (unit, self.little_endian) {
                        ([low, high, ..], true) | ([.., high, low], false) => {
                            u16::from_le_bytes([*low, *high])
                        }
                        _ => 0,
                    }
                });
                let text: String = char::decode_utf16(units)
                    .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
                    .collect();
                let text = text.trim_end_matches('\0').to_owned();
                Some(Scalar::Text(Cow::Owned(text)))
            }
            Element::Struct(_) => None,
        })
    }

    /// The bytes of a text, without the zero at its end.
    fn text(&mut self, bound: Option<u64>) -> Result<&'a [u8], DecodeError> {
        // The zero at the end counts in the length, not in the bound.
        let length = self.length(bound.map(|bound| bound.saturating_add(1)), "string")?;
        let bytes = self.take(length, "string")?;
        Ok(bytes.strip_suffix(&[0]).unwrap_or(bytes))
    }

    fn wide_text(&mut self, bound: Option<u64>) -> Result<&'a [u8], DecodeError> {
        let length = self.length(bound.map(|bound| bound.saturating_add(1)), "wstring")?;
        self.take(length * self.wide as u64, "wstring")
    }

    /// How many elements of the field follow.
    pub(super) fn count(&mut self, count: Count) -> Result<u64, DecodeError> {
        match count {
            Count::One => Ok(1),
            Count::Array(size) => Ok(size),
            Count::AtMost(bound) => self.length(Some(bound), "sequence"),
            Count::Any => self.length(None, "sequence"),
        }
    }

    /// Behind one element.
    pub(super) fn skip(&mut self, layout: &Layout, element: Element) -> Result<(), DecodeError> {
        match element {
            Element::Primitive(primitive) => self.number(primitive).map(|_| ()),
            Element::Text(bound) => self.text(bound).map(|_| ()),
            Element::WideText(bound) => self.wide_text(bound).map(|_| ()),
            Element::Struct(number) => {
                let fields = layout.structs.get(number).map_or(&[][..], |s| &s.fields);
                fields
                    .iter()
                    .try_for_each(|field| self.skip_member(layout, field))
            }
        }
    }

    /// Behind `count` elements. Every element takes at least a byte, so that
    /// this ends with the bytes, whatever a length field says.
    pub(super) fn skip_many(
        &mut self,
        layout: &Layout,
        element: Element,
        count: u64,
    ) -> Result<(), DecodeError> {
        if count == 0 {
            return Ok(());
        }
        if let Element::Primitive(primitive) = element {
            let size = size(primitive);
            self.align(size);
            let what = primitive.name();
            return self
                .take(count.saturating_mul(size as u64), what)
                .map(|_| ());
        }
        (0..count).try_for_each(|_| self.skip(layout, element))
    }

    /// Behind a field.
    pub(super) fn skip_member(
        &mut self,
        layout: &Layout,
        member: &Member,
    ) -> Result<(), DecodeError> {
        let count = self.count(member.count)?;
        self.skip_many(layout, member.element, count)
    }
}

/// Bytes of a number.
fn size(primitive: Primitive) -> usize {
    match primitive {
        Primitive::Bool
        | Primitive::Byte
        | Primitive::Char
        | Primitive::Int8
        | Primitive::Uint8 => 1,
        Primitive::Int16 | Primitive::Uint16 => 2,
        Primitive::Int32 | Primitive::Uint32 | Primitive::Float32 => 4,
        Primitive::Int64 | Primitive::Uint64 | Primitive::Float64 => 8,
    }
}

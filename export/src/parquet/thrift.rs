//! Structs in Thrift's compact protocol, their fields in ascending order.

const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

/// A struct that is being written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Struct {
    bytes: Vec<u8>,
    last: u8,
}

impl Struct {
    /// A field of 32 bits.
    pub fn int(&mut self, field: u8, value: i32) -> &mut Struct {
        self.begin(field, I32);
        varint(&mut self.bytes, zigzag(value.into()));
        self
    }

    /// A field of 64 bits.
    pub fn long(&mut self, field: u8, value: i64) -> &mut Struct {
        self.begin(field, I64);
        varint(&mut self.bytes, zigzag(value));
        self
    }

    /// A text.
    pub fn text(&mut self, field: u8, value: &str) -> &mut Struct {
        self.begin(field, BINARY);
        self.put_text(value);
        self
    }

    /// A list of numbers of 32 bits.
    pub fn ints(&mut self, field: u8, values: &[i32]) -> &mut Struct {
        self.begin_list(field, I32, values.len());
        for value in values {
            varint(&mut self.bytes, zigzag((*value).into()));
        }
        self
    }

    /// A list of texts.
    pub fn texts(&mut self, field: u8, values: &[&str]) -> &mut Struct {
        self.begin_list(field, BINARY, values.len());
        for value in values {
            self.put_text(value);
        }
        self
    }

    /// A list of structs.
    pub fn list(&mut self, field: u8, values: &[Struct]) -> &mut Struct {
        self.begin_list(field, STRUCT, values.len());
        for value in values {
            self.bytes.extend(value.clone().bytes());
        }
        self
    }

    /// A struct.
    pub fn inner(&mut self, field: u8, value: Struct) -> &mut Struct {
        self.begin(field, STRUCT);
        self.bytes.extend(value.bytes());
        self
    }

    /// The struct, ended.
    pub fn bytes(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }

    fn begin(&mut self, field: u8, kind: u8) {
        // Fields stand closer than 16 to each other in all that is written here.
        debug_assert!(field > self.last && field - self.last < 16);
        self.bytes.push(((field - self.last) << 4) | kind);
        self.last = field;
    }

    fn begin_list(&mut self, field: u8, kind: u8, length: usize) {
        self.begin(field, LIST);
        match u8::try_from(length) {
            Ok(short) if short < 15 => self.bytes.push((short << 4) | kind),
            _ => {
                self.bytes.push(0xf0 | kind);
                varint(&mut self.bytes, length as u64);
            }
        }
    }

    fn put_text(&mut self, value: &str) {
        varint(&mut self.bytes, value.len() as u64);
        self.bytes.extend(value.as_bytes());
    }
}

/// Seven bits a byte, the lowest first.
pub fn varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push((value as u8 & 0x7f) | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// Numbers near zero become small ones: 0, −1, 1, −2, …
fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_the_protocol_says() {
        for (value, expected) in [
            (0, &[0_u8][..]),
            (-1, &[1]),
            (1, &[2]),
            (-64, &[127]),
            (64, &[0x80, 1]),
            (
                i64::MIN,
                &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1],
            ),
        ] {
            let mut bytes = Vec::new();
            varint(&mut bytes, zigzag(value));
            assert_eq!(bytes, expected, "{value}");
        }
    }

    #[test]
    fn fields_are_told_by_their_distance() {
        let mut own = Struct::default();
        own.int(1, 2).text(4, "ab").ints(9, &[0; 20]);
        let mut expected = vec![0x15, 4, 0x38, 2, b'a', b'b', 0x59, 0xf5, 20];
        expected.extend([0; 20]);
        expected.push(0);
        assert_eq!(own.bytes(), expected);
    }
}

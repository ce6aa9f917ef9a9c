//! MATLAB's files of version 5 (`save -v6`, `-v7`), as in "MAT-File Format" of The
//! MathWorks. Numeric arrays, also within structures (`data.q`); sparse ones, complex
//! ones, texts and cells are left out.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::{Array, Columns, Kind, LARGEST, Numbers, Order, Room, take};

/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Classes of arrays.
const STRUCTURE: u8 = 2;
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;
/// The flag of an array that has imaginary parts, too.
const COMPLEX: u32 = 0x0800;
/// Structures within structures are followed so far.
const DEPTH: usize = 8;

const CUT: &str = "it is cut off or damaged";

/// The columns of all numeric arrays.
pub(super) fn arrays(bytes: &[u8]) -> Result<Vec<Array>, String> {
    let is_hdf5 = |at: usize| take(bytes, at) == Some(*b"\x89HDF\r\n\x1a\n");
    if is_hdf5(0) || is_hdf5(512) || bytes.starts_with(b"MATLAB 7.3") {
        return Err("it is of version 7.3 (HDF5), which is not read; save it with -v7".to_owned());
    }
    let order = match take(bytes, 126) {
        Some([b'I', b'M']) => Order::Little,
        Some([b'M', b'I']) => Order::Big,
        _ => return Err("it is no MAT-file of version 5; save it with -v7".to_owned()),
    };
    let mut reader = Reader {
        order,
        left: LARGEST,
        room: Room::new(),
        found: Vec::new(),
    };
    reader.elements(bytes.get(128..).unwrap_or_default())?;
    Ok(reader.found)
}

/// One element, and what follows it.
struct Element<'a> {
    kind: u32,
    data: &'a [u8],
    rest: &'a [u8],
}

struct Reader {
    order: Order,
    /// How much may still be decompressed \[bytes\].
    left: u64,
    room: Room,
    found: Vec<Array>,
}

impl Reader {
    fn long(&self, bytes: &[u8], at: usize) -> Option<u32> {
        let own = take(bytes, at)?;
        Some(match self.order {
            Order::Little => u32::from_le_bytes(own),
            Order::Big => u32::from_be_bytes(own),
        })
    }

    fn element<'a>(&self, bytes: &'a [u8]) -> Option<Element<'a>> {
        let first = self.long(bytes, 0)?;
        // Up to four bytes stand within the tag.
        if first >> 16 != 0 {
            return Some(Element {
                kind: first & 0xffff,
                data: bytes.get(4..4 + (first >> 16) as usize)?,
                rest: bytes.get(8..)?,
            });
        }
        let length = self.long(bytes, 4)? as usize;
        let end = 8_usize.checked_add(length)?;
        let next = match first {
            COMPRESSED => end,
            _ => end.checked_next_multiple_of(8)?,
        };
        Some(Element {
            kind: first,
            data: bytes.get(8..end)?,
            rest: bytes.get(next..).unwrap_or_default(),
        })
    }

    fn elements(&mut self, mut bytes: &[u8]) -> Result<(), String> {
        while !bytes.is_empty() {
            let element = self.element(bytes).ok_or(CUT)?;
            bytes = element.rest;
            match element.kind {
                COMPRESSED => {
                    let mut inside = Vec::new();
                    let mut decoder = ZlibDecoder::new(element.data).take(self.left + 1);
                    decoder.read_to_end(&mut inside).map_err(|_| CUT)?;
                    self.left = self
                        .left
                        .checked_sub(inside.len() as u64)
                        .ok_or("its arrays are too large to be held; save only what is needed")?;
                    let inner = self.element(&inside).ok_or(CUT)?;
                    if inner.kind == MATRIX {
                        self.matrix(inner.data, None, DEPTH)?;
                    }
                }
                MATRIX => self.matrix(element.data, None, DEPTH)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// An array; `called` where it is the field of a structure.
    fn matrix(&mut self, bytes: &[u8], called: Option<String>, depth: usize) -> Result<(), String> {
        // An empty field has nothing inside.
        if bytes.is_empty() {
            return Ok(());
        }
        let flags = self.element(bytes).ok_or(CUT)?;
        let sizes = self.element(flags.rest).ok_or(CUT)?;
        let name = self.element(sizes.rest).ok_or(CUT)?;
        let flags = self.long(flags.data, 0).ok_or(CUT)?;
        let (class, is_complex) = ((flags & 0xff) as u8, flags & COMPLEX != 0);
        let sizes: Vec<usize> = (0..sizes.data.len() / 4)
            .filter_map(|at| self.long(sizes.data, 4 * at))
            .map(|size| size as usize)
            .collect();
        let called = called.unwrap_or_else(|| String::from_utf8_lossy(name.data).into_owned());
        if class == STRUCTURE && depth > 0 {
            // One structure, no array of them.
            return match sizes.iter().all(|size| *size == 1) {
                true => self.structure(name.rest, &called, depth),
                false => Ok(()),
            };
        }
        let &[rows, width] = sizes.as_slice() else {
            return Ok(());
        };
        // The real part of complex numbers is no signal by itself.
        if !NUMERIC.contains(&class) || is_complex {
            return Ok(());
        }
        let data = self.element(name.rest).ok_or(CUT)?;
        let Some(numbers) =
            kind(data.kind).and_then(|kind| Numbers::new(data.data, kind, self.order))
        else {
            return Ok(());
        };
        if rows.checked_mul(width) != Some(numbers.len()) {
            return Err(format!("array {called:?} {CUT}"));
        }
        let columns = Columns::new(rows, width, false);
        self.room.take(&columns)?;
        self.found.extend(columns.read(&called, &numbers));
        Ok(())
    }

    fn structure(&mut self, bytes: &[u8], called: &str, depth: usize) -> Result<(), String> {
        let length = self.element(bytes).ok_or(CUT)?;
        let names = self.element(length.rest).ok_or(CUT)?;
        let length = self.long(length.data, 0).ok_or(CUT)? as usize;
        let mut rest = names.rest;
        for name in names.data.chunks(length.max(1)) {
            let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
            let field = self.element(rest).ok_or(CUT)?;
            rest = field.rest;
            if field.kind == MATRIX {
                let name = format!("{called}.{}", String::from_utf8_lossy(name));
                self.matrix(field.data, Some(name), depth - 1)?;
            }
        }
        Ok(())
    }
}

/// Kind of the numbers in an element of this type.
fn kind(element: u32) -> Option<Kind> {
    let (letter, size) = match element {
        1 => ('i', 1),
        2 => ('u', 1),
        3 => ('i', 2),
        4 => ('u', 2),
        5 => ('i', 4),
        6 => ('u', 4),
        7 => ('f', 4),
        9 => ('f', 8),
        12 => ('i', 8),
        13 => ('u', 8),
        _ => return None,
    };
    Some(Kind { letter, size })
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::ZlibEncoder};
    use proptest::prelude::*;

    use super::*;

    fn element(kind: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = [kind, data.len() as u32].map(u32::to_le_bytes).concat();
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    fn matrix(class: u32, sizes: [u32; 2], name: &str, rest: &[u8]) -> Vec<u8> {
        let parts = [
            element(6, &[class, 0].map(u32::to_le_bytes).concat()),
            element(5, &sizes.map(u32::to_le_bytes).concat()),
            element(1, name.as_bytes()),
            rest.to_vec(),
        ];
        element(MATRIX, &parts.concat())
    }

    fn doubles(values: &[f64]) -> Vec<u8> {
        let bytes: Vec<u8> = values.iter().flat_map(|own| own.to_le_bytes()).collect();
        element(9, &bytes)
    }

    /// A vector, a compressed matrix of small numbers, complex numbers, a text, a structure.
    fn sample() -> Vec<u8> {
        let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
        bytes.resize(124, b' ');
        bytes.extend([0, 1, b'I', b'M']);
        bytes.extend(matrix(6, [3, 1], "t", &doubles(&[0.0, 0.5, 1.0])));
        // Whole numbers are stored in the fewest bytes; four of them within the tag.
        let small = [(4_u32 << 16 | 2).to_le_bytes(), [1, 2, 3, 4]].concat();
        let inside = matrix(6, [2, 2], "m", &small);
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&inside).unwrap();
        let packed = encoder.finish().unwrap();
        bytes.extend(
            [COMPRESSED, packed.len() as u32]
                .map(u32::to_le_bytes)
                .concat(),
        );
        bytes.extend(packed);
        let complex = [doubles(&[1.0, 2.0]), doubles(&[3.0, 4.0])].concat();
        bytes.extend(matrix(0x0806, [2, 1], "spectrum", &complex));
        bytes.extend(matrix(4, [1, 2], "text", &element(4, &[104, 0, 105, 0])));
        let fields = [
            [(4_u32 << 16 | 5).to_le_bytes(), 4_u32.to_le_bytes()].concat(),
            element(1, b"q\0\0\0i\0\0\0"),
            matrix(6, [1, 3], "", &doubles(&[1.0, 2.0, 3.0])),
            matrix(
                7,
                [1, 2],
                "",
                &element(7, &[1.5_f32, 2.5].map(f32::to_le_bytes).concat()),
            ),
        ];
        bytes.extend(matrix(2, [1, 1], "data", &fields.concat()));
        bytes
    }

    #[test]
    fn vectors_matrices_and_fields_are_read() {
        let found = arrays(&sample()).unwrap();
        let found: Vec<(&str, &[f64])> = found
            .iter()
            .map(|own| (own.name.as_str(), &own.values[..]))
            .collect();
        assert_eq!(
            found,
            [
                ("t", &[0.0, 0.5, 1.0][..]),
                ("m[0]", &[1.0, 2.0]),
                ("m[1]", &[3.0, 4.0]),
                ("data.q", &[1.0, 2.0, 3.0]),
                ("data.i", &[1.5, 2.5]),
            ]
        );
        let mut new = sample();
        new[..10].copy_from_slice(b"MATLAB 7.3");
        assert!(arrays(&new).unwrap_err().contains("save it with -v7"));
        let cut = sample();
        assert!(arrays(&cut[..200]).unwrap_err().contains("cut off"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Damaged or not: it is read or refused.
        #[test]
        fn damaged_files_are_refused(
            changes in prop::collection::vec((126..900_usize, any::<u8>()), 0..6),
            length in 100..1000_usize,
        ) {
            let mut bytes = sample();
            for (at, byte) in changes {
                if let Some(own) = bytes.get_mut(at) {
                    *own = byte;
                }
            }
            bytes.truncate(length);
            let _ = arrays(&bytes);
        }
    }
}

//! Tables as arrays: `.npz` and `.npy` of NumPy, `.mat` of MATLAB (up to version 7).
//!
//! A vector is a column; a matrix gives a column `name[0]`, `name[1]`, … along its
//! shorter side. Arrays are held whole, so that a file may not be large.

mod mat;
mod npz;

use std::path::Path;

use super::{error::TableError, format::Format};

/// The largest file, and the most that may come out of a compressed part \[bytes\].
const LARGEST: u64 = 1 << 28;
/// So many numbers of a file are held, at most: as many as there are in the largest file of
/// single precision. Smaller ones take more room here than there.
const MOST_NUMBERS: usize = 1 << 26;
/// Columns of one matrix, at most.
const MOST_COLUMNS: usize = 64;

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// Its values, in order.
    pub values: Vec<f64>,
}

/// The columns of the file at `path`, of that format.
///
/// # Errors
///
/// It cannot be read, is too large, or has no vector of numbers.
pub fn read(path: &Path, format: Format) -> Result<Vec<Array>, TableError> {
    let open_error = |source| TableError::Open {
        path: path.to_owned(),
        source,
    };
    let refuse = |reason: String| TableError::Format {
        path: path.to_owned(),
        reason,
    };
    let length = path.metadata().map_err(open_error)?.len();
    if length > LARGEST {
        let most = LARGEST >> 20;
        return Err(refuse(format!(
            "it has {} MiB, more than {most} MiB are not held; save only what is needed, or as CSV",
            length >> 20
        )));
    }
    let bytes = std::fs::read(path).map_err(open_error)?;
    let arrays = match format {
        Format::Mat => mat::arrays(&bytes),
        Format::Npy => npz::array("values", &bytes, &mut Room::new()),
        Format::Npz | Format::Text => npz::arrays(&bytes),
    };
    let mut arrays = arrays.map_err(refuse)?;
    // A number alone is a setting, no signal.
    arrays.retain(|array| array.values.len() > 1);
    match arrays.is_empty() {
        true => Err(refuse("it has no vector of numbers".to_owned())),
        false => Ok(arrays),
    }
}

/// How many numbers may still be held.
struct Room(usize);

impl Room {
    const fn new() -> Room {
        Room(MOST_NUMBERS)
    }

    /// Takes the room for `columns`, or refuses them.
    fn take(&mut self, columns: &Columns) -> Result<(), String> {
        let left = self
            .0
            .checked_sub(columns.count.saturating_mul(columns.length));
        self.0 = left.ok_or_else(|| {
            format!(
                "it has more than {MOST_NUMBERS} numbers, which are not held; save only what is needed, or as CSV"
            )
        })?;
        Ok(())
    }
}

/// The columns of an array of `rows` by `width`.
struct Columns {
    rows: usize,
    width: usize,
    count: usize,
    length: usize,
    /// Whether values come row by row, or column by column.
    by_row: bool,
}

impl Columns {
    fn new(rows: usize, width: usize, by_row: bool) -> Columns {
        let (longer, shorter) = (rows.max(width), rows.min(width));
        // A vector may lie or stand; along the longer side of a matrix goes time.
        let (count, length) = match shorter {
            0 => (1, 0),
            _ => (shorter.min(MOST_COLUMNS), longer),
        };
        Columns {
            rows,
            width,
            count,
            length,
            by_row,
        }
    }

    /// Where in the array the value `at` of column `number` is.
    fn place(&self, number: usize, at: usize) -> usize {
        let (row, column) = match self.rows >= self.width {
            true => (at, number),
            false => (number, at),
        };
        match self.by_row {
            true => row * self.width + column,
            false => column * self.rows + row,
        }
    }

    fn read(&self, name: &str, numbers: &Numbers<'_>) -> Vec<Array> {
        let is_vector = self.rows.min(self.width) <= 1;
        let one = |number: usize| Array {
            name: match is_vector {
                true => name.to_owned(),
                false => format!("{name}[{number}]"),
            },
            values: (0..self.length)
                .filter_map(|at| numbers.get(self.place(number, at)))
                .collect(),
        };
        (0..self.count).map(one).collect()
    }
}

/// `N` bytes at `from`.
fn take<const N: usize>(bytes: &[u8], from: usize) -> Option<[u8; N]> {
    bytes.get(from..from.checked_add(N)?)?.try_into().ok()
}

/// Little or big end first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    Little,
    Big,
}

/// A kind of number: letter as NumPy's (`f`, `i`, `u`) and bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kind {
    letter: char,
    size: usize,
}

/// Numbers of one kind, as many as there are whole ones.
struct Numbers<'a> {
    bytes: &'a [u8],
    size: usize,
    order: Order,
    one: fn([u8; 8]) -> f64,
}

impl<'a> Numbers<'a> {
    /// `None` where the kind is not known.
    fn new(bytes: &'a [u8], kind: Kind, order: Order) -> Option<Numbers<'a>> {
        let one: fn([u8; 8]) -> f64 = match (kind.letter, kind.size) {
            ('f', 8) => f64::from_le_bytes,
            ('f', 4) => |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            ('i', 8) => |b| i64::from_le_bytes(b) as f64,
            ('i', 4) => |b| f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            ('i', 2) => |b| f64::from(i16::from_le_bytes([b[0], b[1]])),
            ('i', 1) => |b| f64::from(i8::from_le_bytes([b[0]])),
            ('u', 8) => |b| u64::from_le_bytes(b) as f64,
            ('u', 4) => |b| f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            ('u', 2) => |b| f64::from(u16::from_le_bytes([b[0], b[1]])),
            ('u' | 'b', 1) => |b| f64::from(b[0]),
            _ => return None,
        };
        Some(Numbers {
            bytes,
            size: kind.size,
            order,
            one,
        })
    }

    fn len(&self) -> usize {
        self.bytes.len() / self.size
    }

    fn get(&self, at: usize) -> Option<f64> {
        let from = at.checked_mul(self.size)?;
        let bytes = self.bytes.get(from..from.checked_add(self.size)?)?;
        let mut own = [0; 8];
        let used = own.get_mut(..self.size)?;
        used.copy_from_slice(bytes);
        if self.order == Order::Big {
            used.reverse();
        }
        Some((self.one)(own))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_give_columns_along_their_longer_side() {
        let kind = Kind {
            letter: 'u',
            size: 1,
        };
        let numbers = Numbers::new(&[0, 1, 2, 3, 4, 5], kind, Order::Little).unwrap();
        let columns = |rows, width, by_row| Columns::new(rows, width, by_row).read("a", &numbers);
        let found = columns(3, 2, true);
        assert_eq!(found[0].values, [0.0, 2.0, 4.0]);
        assert_eq!(
            (found[1].name.as_str(), &found[1].values[..]),
            ("a[1]", &[1.0, 3.0, 5.0][..])
        );
        assert_eq!(columns(2, 3, true)[1].values, [3.0, 4.0, 5.0]);
        assert_eq!(columns(3, 2, false)[1].values, [3.0, 4.0, 5.0]);
        for (rows, width) in [(6, 1), (1, 6)] {
            for by_row in [false, true] {
                let found = columns(rows, width, by_row);
                assert_eq!((found.len(), found[0].name.as_str()), (1, "a"));
                assert_eq!(found[0].values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
            }
        }
        assert_eq!(columns(0, 5, true)[0].values, [0.0; 0]);
    }

    #[test]
    fn numbers_of_all_kinds() {
        let read = |bytes: &[u8], letter, size, order| -> Option<Vec<f64>> {
            let numbers = Numbers::new(bytes, Kind { letter, size }, order)?;
            Some(
                (0..=numbers.len())
                    .filter_map(|at| numbers.get(at))
                    .collect(),
            )
        };
        let big = read(&[0xff, 0xfe, 0, 1, 7], 'i', 2, Order::Big);
        assert_eq!(big, Some(vec![-2.0, 1.0]));
        let little = read(&1.5_f32.to_le_bytes(), 'f', 4, Order::Little);
        assert_eq!(little, Some(vec![1.5]));
        assert_eq!(read(&[0; 16], 'c', 16, Order::Little), None);
    }

    #[test]
    fn no_more_numbers_are_held_than_there_is_room_for() {
        let mut room = Room::new();
        let half = MOST_NUMBERS / 2;
        room.take(&Columns::new(half, 1, true)).unwrap();
        // Of a wide matrix no more than its first columns are held.
        let wide = Columns::new(half / 64, half / 64, true);
        room.take(&wide).unwrap();
        let told = room.take(&Columns::new(1, 1, true)).unwrap_err();
        assert!(told.contains("more than 67108864 numbers"), "{told}");
        assert!(
            Room::new()
                .take(&Columns::new(usize::MAX, 2, true))
                .is_err()
        );
    }
}

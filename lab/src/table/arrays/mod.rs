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
        Format::Npy => npz::array("values", &bytes),
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

/// The columns of an array of `rows` by `columns`, whose values come column by
/// column, or row by row.
fn columns(name: &str, values: Vec<f64>, rows: usize, columns: usize, by_row: bool) -> Vec<Array> {
    if rows.min(columns) <= 1 {
        let name = name.to_owned();
        return vec![Array { name, values }];
    }
    // Along the longer side goes time.
    let (long, short, short_is_columns) = match rows >= columns {
        true => (rows, columns, true),
        false => (columns, rows, false),
    };
    let at = |long: usize, short: usize| {
        let (row, column) = if short_is_columns {
            (long, short)
        } else {
            (short, long)
        };
        match by_row {
            true => row * columns + column,
            false => column * rows + row,
        }
    };
    let one = |column: usize| Array {
        name: format!("{name}[{column}]"),
        values: (0..long)
            .filter_map(|row| values.get(at(row, column)).copied())
            .collect(),
    };
    (0..short.min(MOST_COLUMNS)).map(one).collect()
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

/// Numbers of one kind, as many as there are whole ones; `None` where the kind is
/// not known.
fn numbers(bytes: &[u8], kind: Kind, order: Order) -> Option<Vec<f64>> {
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
    let values = bytes.chunks_exact(kind.size).map(|chunk| {
        let mut own = [0; 8];
        for (slot, byte) in own.iter_mut().zip(chunk) {
            *slot = *byte;
        }
        if order == Order::Big
            && let Some(used) = own.get_mut(..kind.size)
        {
            used.reverse();
        }
        one(own)
    });
    Some(values.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_give_columns_along_their_longer_side() {
        let values: Vec<f64> = (0..6).map(f64::from).collect();
        let found = columns("a", values.clone(), 3, 2, true);
        assert_eq!(found[0].values, [0.0, 2.0, 4.0]);
        assert_eq!(
            (found[1].name.as_str(), &found[1].values[..]),
            ("a[1]", &[1.0, 3.0, 5.0][..])
        );
        let found = columns("a", values.clone(), 2, 3, true);
        assert_eq!(found[1].values, [3.0, 4.0, 5.0]);
        let found = columns("a", values, 3, 2, false);
        assert_eq!(found[1].values, [3.0, 4.0, 5.0]);
    }

    #[test]
    fn numbers_of_all_kinds() {
        let kind = |letter, size| Kind { letter, size };
        let big = numbers(&[0xff, 0xfe, 0, 1], kind('i', 2), Order::Big);
        assert_eq!(big, Some(vec![-2.0, 1.0]));
        let little = numbers(&1.5_f32.to_le_bytes(), kind('f', 4), Order::Little);
        assert_eq!(little, Some(vec![1.5]));
        assert_eq!(numbers(&[0; 16], kind('c', 16), Order::Little), None);
    }
}

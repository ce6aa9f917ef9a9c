//! NumPy's arrays: `.npy`, one array behind a short text, and `.npz`, a ZIP archive
//! of them. Formats: numpy.lib.format, and APPNOTE.TXT of PKWARE 4.3.

use std::io::Read;

use flate2::read::DeflateDecoder;

use super::{Array, Columns, Kind, LARGEST, Numbers, Order, Room, take};

/// Length of the record at a ZIP archive's end, of one entry of its directory, and
/// of the header before its data, each without what varies \[bytes\].
const END: usize = 22;
const ENTRY: usize = 46;
const LOCAL: usize = 30;

/// The columns of all arrays in an `.npz` file.
pub(super) fn arrays(bytes: &[u8]) -> Result<Vec<Array>, String> {
    let cut = || "the ZIP archive is cut off or damaged".to_owned();
    // A comment of up to 64 KiB may follow.
    let last = bytes.len().checked_sub(END).ok_or_else(cut)?;
    let end = (last.saturating_sub(1 << 16)..=last)
        .rev()
        .find(|at| take(bytes, *at) == Some(*b"PK\x05\x06"))
        .ok_or("it is no ZIP archive, as an .npz file is")?;
    let short = |at: usize| take(bytes, at).map(|own| usize::from(u16::from_le_bytes(own)));
    let long = |at: usize| take(bytes, at).map(|own| u32::from_le_bytes(own) as usize);
    let count = short(end + 10).ok_or_else(cut)?;
    let mut at = long(end + 16).ok_or_else(cut)?;
    let mut found = Vec::new();
    let (mut left, mut room) = (LARGEST, Room::new());
    for _ in 0..count {
        if take(bytes, at) != Some(*b"PK\x01\x02") {
            return Err(cut());
        }
        let field = |offset: usize| short(at + offset).ok_or_else(cut);
        let (method, name, extra, comment) = (field(10)?, field(28)?, field(30)?, field(32)?);
        let packed = long(at + 20).ok_or_else(cut)?;
        let local = long(at + 42).ok_or_else(cut)?;
        let name_bytes = bytes.get(at + ENTRY..at + ENTRY + name).ok_or_else(cut)?;
        let name_text = String::from_utf8_lossy(name_bytes);
        at += ENTRY + name + extra + comment;
        let Some(array_name) = name_text.strip_suffix(".npy") else {
            continue;
        };
        let local_short = |offset: usize| {
            let at = local.checked_add(offset)?;
            short(at)
        };
        let skip = local_short(26).zip(local_short(28));
        let skip = skip.map(|(name, extra)| LOCAL + name + extra);
        let data = skip.and_then(|skip| {
            let from = local.checked_add(skip)?;
            bytes.get(from..from.checked_add(packed)?)
        });
        let data = data.ok_or_else(cut)?;
        let unpacked = match method {
            0 => data.to_vec(),
            8 => {
                let mut unpacked = Vec::new();
                let mut reader = DeflateDecoder::new(data).take(left + 1);
                reader.read_to_end(&mut unpacked).map_err(|_| cut())?;
                unpacked
            }
            _ => {
                return Err(format!(
                    "{name_text} is compressed in a way that is not read"
                ));
            }
        };
        left = left
            .checked_sub(unpacked.len() as u64)
            .ok_or("its arrays are too large to be held; save only what is needed, or as CSV")?;
        found.extend(array(array_name, &unpacked, &mut room)?);
    }
    Ok(found)
}

/// The columns of one array, an `.npy` file; none of one that holds no numbers.
pub(super) fn array(name: &str, bytes: &[u8], room: &mut Room) -> Result<Vec<Array>, String> {
    let wrong = || format!("array {name:?} is no .npy");
    if take(bytes, 0) != Some(*b"\x93NUMPY") {
        return Err(wrong());
    }
    let version = *bytes.get(6).ok_or_else(wrong)?;
    let (length, from): (Option<usize>, usize) = match version {
        1 => (
            take(bytes, 8).map(|own| usize::from(u16::from_le_bytes(own))),
            10,
        ),
        _ => (
            take(bytes, 8).map(|own| u32::from_le_bytes(own) as usize),
            12,
        ),
    };
    let length = length.ok_or_else(wrong)?;
    let header = from.checked_add(length).and_then(|to| bytes.get(from..to));
    let header = String::from_utf8_lossy(header.ok_or_else(wrong)?);
    let value = |key: &str| {
        let (_, rest) = header.split_once(&format!("'{key}':"))?;
        Some(rest.trim_start())
    };
    let data = bytes.get(from + length..).unwrap_or_default();
    // Tables of several kinds, complex numbers, texts and objects are no signals.
    let Some((order, kind)) = value("descr").and_then(kind) else {
        return Ok(Vec::new());
    };
    let shape = value("shape").and_then(|text| text.strip_prefix('(')?.split_once(')'));
    let shape = shape.ok_or_else(wrong)?.0.split(',');
    let shape: Vec<usize> = shape.filter_map(|own| own.trim().parse().ok()).collect();
    let [rows, width] = match shape.as_slice() {
        [] => [1, 1],
        [one] => [*one, 1],
        [rows, columns] => [*rows, *columns],
        _ => return Ok(Vec::new()),
    };
    let Some(numbers) = Numbers::new(data, kind, order) else {
        return Ok(Vec::new());
    };
    let count = rows.checked_mul(width).ok_or_else(wrong)?;
    if numbers.len() < count {
        return Err(format!("array {name:?} is cut off"));
    }
    let by_row = !value("fortran_order").is_some_and(|text| text.starts_with("True"));
    let columns = Columns::new(rows, width, by_row);
    room.take(&columns)?;
    Ok(columns.read(name, &numbers))
}

/// `'<f8'`.
fn kind(text: &str) -> Option<(Order, Kind)> {
    let text = text.strip_prefix('\'')?.split('\'').next()?;
    let mut signs = text.chars();
    let order = match signs.next()? {
        '<' | '|' | '=' => Order::Little,
        '>' => Order::Big,
        _ => return None,
    };
    let letter = signs.next()?;
    let size = signs.as_str().parse().ok()?;
    ((1..=8).contains(&size)).then_some((order, Kind { letter, size }))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::DeflateEncoder};
    use proptest::prelude::*;

    use super::*;

    fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header =
            format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    /// A ZIP archive by the layout of APPNOTE.TXT, without check sums.
    fn zip(entries: &[(&str, Vec<u8>)], packed: bool) -> Vec<u8> {
        let (mut bytes, mut directory) = (Vec::new(), Vec::new());
        for (name, data) in entries {
            let method: u16 = if packed { 8 } else { 0 };
            let stored = match packed {
                true => {
                    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
                    encoder.write_all(data).unwrap();
                    encoder.finish().unwrap()
                }
                false => data.clone(),
            };
            let offset = bytes.len() as u32;
            let mut common = [20_u16, 0, method, 0, 0].map(u16::to_le_bytes).concat();
            common.extend(
                [0, stored.len() as u32, data.len() as u32]
                    .map(u32::to_le_bytes)
                    .concat(),
            );
            common.extend([name.len() as u16, 0].map(u16::to_le_bytes).concat());
            bytes.extend(b"PK\x03\x04");
            bytes.extend(&common);
            bytes.extend(name.as_bytes());
            bytes.extend(&stored);
            directory.extend(b"PK\x01\x02\x14\x00");
            directory.extend(&common);
            directory.extend([0_u8; 10]);
            directory.extend(offset.to_le_bytes());
            directory.extend(name.as_bytes());
        }
        let at = bytes.len() as u32;
        let count = entries.len() as u16;
        bytes.extend(&directory);
        bytes.extend(b"PK\x05\x06\0\0\0\0");
        bytes.extend([count, count].map(u16::to_le_bytes).concat());
        bytes.extend([directory.len() as u32, at].map(u32::to_le_bytes).concat());
        bytes.extend([0, 0]);
        bytes
    }

    fn sample(packed: bool) -> Vec<u8> {
        let doubles: Vec<u8> = [0.0, 0.5, 1.0]
            .iter()
            .flat_map(|own: &f64| own.to_le_bytes())
            .collect();
        let shorts: Vec<u8> = (0..6_i16).flat_map(i16::to_be_bytes).collect();
        let entries = [
            ("t.npy", npy("<f8", "(3,)", &doubles)),
            ("x.npy", npy(">i2", "(3, 2)", &shorts)),
            ("name.npy", npy("<U3", "()", b"abcabcabcabc")),
        ];
        zip(&entries, packed)
    }

    #[test]
    fn arrays_are_read_stored_and_compressed() {
        for packed in [false, true] {
            let found = arrays(&sample(packed)).unwrap();
            let names: Vec<&str> = found.iter().map(|own| own.name.as_str()).collect();
            assert_eq!(names, ["t", "x[0]", "x[1]"]);
            assert_eq!(found[0].values, [0.0, 0.5, 1.0]);
            assert_eq!(found[2].values, [1.0, 3.0, 5.0]);
        }
        assert!(arrays(b"t,q\n").unwrap_err().contains("cut off"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Damaged or not: it is read or refused.
        #[test]
        fn damaged_archives_are_refused(
            packed in any::<bool>(),
            changes in prop::collection::vec((0..600_usize, any::<u8>()), 0..6),
            length in 0..800_usize,
        ) {
            let mut bytes = sample(packed);
            for (at, byte) in changes {
                if let Some(own) = bytes.get_mut(at) {
                    *own = byte;
                }
            }
            bytes.truncate(length.max(60));
            let _ = arrays(&bytes);
        }
    }
}

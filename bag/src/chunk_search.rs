//! Finding a chunk in a file without knowing where one begins.

use std::{fs::File, io, os::unix::fs::FileExt};

use mcap::records::op;

use super::block::{FRAME, frame};

/// Start, end, unpacked size, checksum, and the length of the compression's name \[bytes\].
const FIXED: usize = 8 + 8 + 8 + 4 + 4;
/// Names of compressions.
const COMPRESSIONS: [&[u8]; 3] = [b"", b"lz4", b"zstd"];
/// The longest head of a chunk: frame, fixed part, name, length of the records.
const HEAD: usize = FRAME + FIXED + 4 + 8;
/// Bytes that are looked through at once.
const WINDOW: usize = 1 << 20;

/// Where the next chunk begins at `from` or later, in a file of `length` bytes. What a
/// chunk says of itself fits together in a way that chance does not give.
pub(crate) fn next_chunk(file: &File, mut from: u64, length: u64) -> io::Result<Option<u64>> {
    let mut window = vec![0; WINDOW];
    while from < length {
        let wanted = usize::try_from(length - from).map_or(WINDOW, |left| left.min(WINDOW));
        let window = &mut window[..wanted];
        file.read_exact_at(window, from)?;
        let found = (0..window.len()).find(|&place| {
            window[place] == op::CHUNK && begins(&window[place..], length - from - place as u64)
        });
        if let Some(place) = found {
            return Ok(Some(from + place as u64));
        }
        if wanted < WINDOW {
            break;
        }
        // A head may stand across the end of the window.
        from += (WINDOW - HEAD) as u64;
    }
    Ok(None)
}

/// Whether `bytes` begin with the head of a chunk that ends within `left` bytes.
fn begins(bytes: &[u8], left: u64) -> bool {
    let Some((_, body)) = frame(bytes) else {
        return false;
    };
    let number = |at: usize| {
        let field = bytes.get(FRAME + at..)?.first_chunk()?;
        Some(u64::from_le_bytes(*field))
    };
    let name_length = |at: usize| {
        let field = bytes.get(FRAME + at..)?.first_chunk()?;
        usize::try_from(u32::from_le_bytes(*field)).ok()
    };
    let (Some(start), Some(end), Some(name)) = (number(0), number(8), name_length(FIXED - 4))
    else {
        return false;
    };
    let named = COMPRESSIONS
        .iter()
        .any(|own| own.len() == name && bytes[FRAME + FIXED..].starts_with(own));
    let head = (FIXED + name + 8) as u64;
    named
        && start <= end
        && left >= FRAME as u64
        && body <= left - FRAME as u64
        && number(FIXED + name).and_then(|records| records.checked_add(head)) == Some(body)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn chunk(records: &[u8]) -> Vec<u8> {
        let mut body = Vec::new();
        body.extend(5_u64.to_le_bytes());
        body.extend(9_u64.to_le_bytes());
        body.extend((records.len() as u64).to_le_bytes());
        body.extend(0_u32.to_le_bytes());
        body.extend(4_u32.to_le_bytes());
        body.extend(b"zstd");
        body.extend((records.len() as u64).to_le_bytes());
        body.extend(records);
        let mut bytes = vec![op::CHUNK];
        bytes.extend((body.len() as u64).to_le_bytes());
        bytes.extend(body);
        bytes
    }

    fn find(bytes: &[u8], from: u64) -> Option<u64> {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(bytes).unwrap();
        next_chunk(&file, from, bytes.len() as u64).unwrap()
    }

    #[test]
    fn chunks_are_found_wherever_they_begin() {
        for before in [0, 1, 70, WINDOW - HEAD, WINDOW - 3, WINDOW, 2 * WINDOW + 5] {
            // Not one of them is a chunk, though all begin like one.
            let mut bytes = vec![op::CHUNK; before];
            bytes.extend(chunk(&[7; 30]));
            bytes.extend(chunk(&[8; 3]));
            assert_eq!(find(&bytes, 0), Some(before as u64));
            let second = before as u64 + chunk(&[7; 30]).len() as u64;
            assert_eq!(find(&bytes, before as u64 + 1), Some(second));
            assert_eq!(find(&bytes, second + 1), None);
        }
    }

    #[test]
    fn a_chunk_that_is_cut_or_does_not_fit_together_is_none() {
        let whole = chunk(&[7; 30]);
        for length in 0..whole.len() {
            assert_eq!(find(&whole[..length], 0), None, "{length}");
        }
        for place in [1, FRAME + FIXED, FRAME + FIXED + 4] {
            let mut damaged = whole.clone();
            damaged[place] ^= 1;
            assert_eq!(find(&damaged, 0), None, "{place}");
        }
    }
}

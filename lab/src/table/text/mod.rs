//! Tables as text: CSV and its relatives.
//!
//! What separates the columns, where the names stand and where the rows begin is
//! found from the file's beginning ([`dialect`]). Lines that begin with `#` or
//! `%` are comments. Rows are read one after the other, and none is kept.

pub mod dialect;
pub mod number;
pub mod split;

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Read},
    path::Path,
};

use super::error::TableError;
use dialect::Dialect;
use number::{Cell, cell};

/// The longest row \[bytes\]: what has none would be taken into memory whole.
const LONGEST_ROW: usize = 1 << 20;
/// How much of a file is looked at to find how it is written \[bytes\].
const HEAD: u64 = 1 << 16;
/// What some programs write in front of UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// How the file at `path` is written.
///
/// # Errors
///
/// It cannot be read, is empty, or is not UTF-8.
pub fn look(path: &Path) -> Result<Dialect, TableError> {
    look_at(&mut open(path)?, path)
}

fn open(path: &Path) -> Result<BufReader<File>, TableError> {
    let buffered = |file| without_mark(BufReader::with_capacity(1 << 18, file));
    let opened = File::open(path).and_then(buffered);
    opened.map_err(|source| TableError::Open {
        path: path.to_owned(),
        source,
    })
}

/// The text behind its byte order mark, where it has one.
fn without_mark<R: BufRead>(mut source: R) -> io::Result<R> {
    if source.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
        source.consume(BYTE_ORDER_MARK.len());
    }
    Ok(source)
}

fn look_at(source: &mut impl Read, path: &Path) -> Result<Dialect, TableError> {
    let mut head = Vec::new();
    let count = source.take(HEAD).read_to_end(&mut head);
    count.map_err(|source| TableError::Open {
        path: path.to_owned(),
        source,
    })?;
    if head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]) {
        return Err(TableError::Format {
            path: path.to_owned(),
            reason: "it is UTF-16; save it as UTF-8".to_owned(),
        });
    }
    // The last line may go on.
    if head.len() as u64 == HEAD
        && let Some(end) = head.iter().rposition(|&byte| byte == b'\n')
    {
        head.truncate(end + 1);
    }
    let head = String::from_utf8_lossy(&head);
    dialect::of_head(&head).ok_or_else(|| TableError::Empty {
        path: path.to_owned(),
    })
}

/// Calls `visit` with the line, counted from 1, and the cells of the columns
/// `wanted` of every row of the file at `path`, in order. Tells whether the last
/// line is cut off; it is left out then.
///
/// # Errors
///
/// The file cannot be read; a line has more or fewer fields than the others.
pub fn rows<E: From<TableError>>(
    path: &Path,
    dialect: &Dialect,
    wanted: &[usize],
    visit: impl FnMut(u64, &[Cell<'_>]) -> Result<(), E>,
) -> Result<bool, E> {
    rows_of(open(path)?, path, dialect, wanted, visit)
}

fn rows_of<E: From<TableError>>(
    mut source: impl BufRead,
    path: &Path,
    dialect: &Dialect,
    wanted: &[usize],
    mut visit: impl FnMut(u64, &[Cell<'_>]) -> Result<(), E>,
) -> Result<bool, E> {
    let format = |line: u64, reason: String| TableError::Format {
        path: path.to_owned(),
        reason: format!("line {line}: {reason}"),
    };
    let (mut bytes, mut line) = (Vec::new(), 0);
    let mut broken: Option<TableError> = None;
    let columns = dialect.names.len();
    // Whether a row ends with a separator makes no difference. Where any other field were
    // left out, those behind it would be read as their neighbours.
    let fewest = match dialect.last_is_empty && columns > 2 {
        true => columns - 1,
        false => columns,
    };
    let comma = dialect.separator.decimal_comma();
    loop {
        bytes.clear();
        line += 1;
        let count = take_line(&mut source, &mut bytes).map_err(|error| match error.kind() {
            io::ErrorKind::InvalidData => format(line, error.to_string()),
            _ => TableError::Open {
                path: path.to_owned(),
                source: error,
            },
        })?;
        if count == 0 {
            return Ok(broken.is_some());
        }
        if line < dialect.first_row {
            continue;
        }
        let text = String::from_utf8_lossy(&bytes);
        if text.trim().is_empty() || dialect::is_comment(&text) {
            continue;
        }
        // What is broken off at the end of the file is no fault of its own.
        if let Some(error) = broken.take() {
            return Err(error.into());
        }
        let mut cells = vec![Cell::Missing; wanted.len()];
        let (mut found, mut beyond) = (0, false);
        for (at, field) in dialect.separator.fields(&text).enumerate() {
            found = at + 1;
            beyond |= at >= columns && !field.is_empty();
            for (slot, _) in (cells.iter_mut().zip(wanted)).filter(|(_, own)| **own == at) {
                *slot = cell(field, comma);
            }
        }
        if beyond || found < fewest {
            broken = Some(format(
                line,
                format!("{found} fields, where the columns are {columns}"),
            ));
            continue;
        }
        visit(line, &cells)?;
    }
}

/// Appends the next line to `bytes`; gives its length, 0 at the end.
fn take_line(source: &mut impl BufRead, bytes: &mut Vec<u8>) -> io::Result<usize> {
    let count = source
        .take(LONGEST_ROW as u64 + 1)
        .read_until(b'\n', bytes)?;
    if count > LONGEST_ROW {
        let reason = format!("more than {LONGEST_ROW} bytes without an end: this is no table");
        return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
    }
    Ok(count)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Line, and numbers of columns 0 and 1, NaN for what is missing.
    type Row = (u64, f64, f64);

    /// The rows, and whether the last one was cut off.
    fn parse(bytes: &[u8]) -> Result<(Vec<Row>, bool), TableError> {
        let path = Path::new("a.csv");
        let bytes = without_mark(bytes).unwrap();
        let dialect = look_at(&mut &bytes[..], path)?;
        let mut read = Vec::new();
        let cut = rows_of(bytes, path, &dialect, &[0, 1], |line, cells| {
            let number = |cell: Option<&Cell<'_>>| match cell {
                Some(Cell::Number(value)) => *value,
                _ => f64::NAN,
            };
            read.push((line, number(cells.first()), number(cells.get(1))));
            Ok::<(), TableError>(())
        })?;
        Ok((read, cut))
    }

    #[test]
    fn rows_are_read_whatever_the_dialect() {
        for text in [
            "t_s,q\n0,1\n0.1,-2e1\n",
            "\u{feff}# made by hand\n t ; q \n0;1\n\n0,1; -20,0",
            "time\tq\r\n0\t1\r\n0.1\t-20\r\n",
            "% x\n  0.0   1\n  0.1  -20\n",
            "\u{feff}0,1\n0.1,-20\n",
            "\"t\",\"q\"\n\"0\",\"1\"\n0.1,-20,\n",
        ] {
            let (rows, cut) = parse(text.as_bytes()).unwrap();
            let numbers: Vec<(f64, f64)> = rows.iter().map(|row| (row.1, row.2)).collect();
            assert_eq!(numbers, [(0.0, 1.0), (0.1, -20.0)], "{text}");
            assert!(!cut, "{text}");
        }
    }

    #[test]
    fn the_last_line_may_be_cut_off_and_no_other() {
        let (rows, cut) = parse(b"t,q,i\n0,1,2\n1,2,3\n2").unwrap();
        assert_eq!((rows.len(), cut), (2, true));
        let refused = parse(b"t,q,i\n0,1,2\n1,2,3\n2\n3,4,5\n").unwrap_err();
        let text = refused.to_string();
        assert!(text.contains("a.csv: line 4: 1 fields"), "{text}");
        let latin = parse(b"t,q \xb0\n0,1\n1,2\n").unwrap();
        assert_eq!(latin.0.len(), 2);
        let wide = parse(b"\xff\xfet\0,\0").unwrap_err().to_string();
        assert!(wide.contains("UTF-16"), "{wide}");
    }

    #[test]
    fn a_row_that_lacks_a_field_is_refused_but_for_the_empty_one_at_its_end() {
        for text in [
            "t,q,i\n0,1,2\n1,2,3\n2,4\n3,4,5\n",
            "t q i\n0 1 2\n1 2 3\n2 4\n3 4 5\n",
            // The column without a name has values.
            "t,q,\n0,1,2\n1,2,3\n2,4\n3,4,5\n",
            "0;1;2\n1;2;3\n2;4\n3;4;5\n",
            // It may have the last one alone.
            "t,q,i\n0,1,2\n1,,3\n2,4\n3,4,5\n",
        ] {
            let refused = parse(text.as_bytes()).unwrap_err().to_string();
            assert!(
                refused.contains(": 2 fields, where the columns are 3"),
                "{refused}"
            );
        }
        for text in [
            "t,q,\n0,1,\n1,2,\n2,4\n3,4,\n",
            "t,q\n0,1,\n1,2,\n2,4\n3,4,\n",
            "t,q\n0,1\n1,2\n2,4,\n3,4\n",
            "0;1;\n1;2;\n2;4\n3;4;\n",
        ] {
            let (rows, cut) = parse(text.as_bytes()).unwrap();
            let numbers: Vec<(f64, f64)> = rows.iter().map(|row| (row.1, row.2)).collect();
            let all = [(0.0, 1.0), (1.0, 2.0), (2.0, 4.0), (3.0, 4.0)];
            assert_eq!((&numbers[..], cut), (&all[..], false), "{text}");
        }
        // The last line is cut off, not a row of fewer fields.
        let (rows, cut) = parse(b"t,q,i\n0,1,2\n1,2,3\n2,4").unwrap();
        assert_eq!((rows.len(), cut), (2, true));
    }

    #[test]
    fn a_row_without_an_end_is_not_taken_into_memory() {
        let path = Path::new("a.csv");
        for start in ["t_s,q\n0,\"", "t_s,q\n0,", "t_s"] {
            let head = format!("{start}{}", "1".repeat(100));
            let dialect = look_at(&mut head.as_bytes(), path).unwrap();
            let endless = start.as_bytes().chain(io::repeat(b'1'));
            let read = rows_of(BufReader::new(endless), path, &dialect, &[0], |_, _| {
                Ok::<(), TableError>(())
            });
            let text = read.unwrap_err().to_string();
            assert!(text.contains("more than 1048576 bytes"), "{text}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        /// Any bytes are read or refused, and nothing grows beyond them.
        #[test]
        fn any_bytes_are_read_or_refused(
            bytes in prop_oneof![
                prop::collection::vec(any::<u8>(), 0..200),
                "t_s[,; ]q\n([0-9e.,;:\"#%\n\t -]|nan|\\PC){0,60}".prop_map(String::into_bytes),
            ],
        ) {
            if let Ok((rows, _)) = parse(&bytes) {
                prop_assert!(rows.len() <= bytes.len());
                prop_assert!(rows.windows(2).all(|pair| pair[0].0 < pair[1].0));
            }
        }

        /// What is written is read, whatever the separator and the decimal sign.
        #[test]
        fn what_is_written_is_read(
            values in prop::collection::vec((-1e6..1e6, -1e6..1e6), 2..20),
            dialect in prop_oneof![Just(('\t', false)), Just((';', true)), Just((',', false)), Just((' ', true))],
            named in any::<bool>(),
        ) {
            let (separator, comma) = dialect;
            let write = |value: f64| {
                let text = format!("{value:.6}");
                if comma { text.replace('.', ",") } else { text }
            };
            let mut text = if named { format!("t{separator}q\n") } else { String::new() };
            for (t, q) in &values {
                text += &format!("{}{separator}{}\n", write(*t), write(*q));
            }
            let (rows, cut) = parse(text.as_bytes()).unwrap();
            prop_assert!(!cut);
            prop_assert_eq!(rows.len(), values.len());
            for (row, (t, q)) in rows.iter().zip(&values) {
                prop_assert!((row.1 - t).abs() < 1e-6 && (row.2 - q).abs() < 1e-6);
            }
        }
    }
}

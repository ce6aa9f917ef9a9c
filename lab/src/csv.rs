//! Signals from CSV: columns by the names in the first line.

use std::{
    cell::Cell,
    fs::File,
    io::{self, BufReader, Read},
    path::{Path, PathBuf},
    rc::Rc,
};

use crate::message_path::{Function, MessagePathError, functions_of};

/// Names of the column that is time \[s\], where none is given; the first
/// column of the file that has one of them is it.
pub const TIME_COLUMNS: [&str; 3] = ["t_s", "time", "timestamp"];

/// Numbers of one file that are held at once, at most: almost two hours of eight
/// columns at 1 kHz.
const MOST_NUMBERS: usize = 64_000_000;
/// The longest row \[bytes\]: what has none would be taken into memory whole.
const LONGEST_ROW: u64 = 1 << 20;

/// Why a CSV file gives no signals.
#[derive(Debug, thiserror::Error)]
pub enum CsvError {
    /// The file cannot be opened.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// More numbers than are held at once.
    #[error(
        "{} is too large to be held in memory ({} MiB): more than {rows} rows of {columns} columns, with time and line, are not read ({} MiB). Cut the file into parts by time, or keep every n-th row",
        path.display(), bytes >> 20, (MOST_NUMBERS * 8) >> 20
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size \[bytes\].
        bytes: u64,
        /// Rows that were read.
        rows: usize,
        /// Columns that are read, with time and line.
        columns: usize,
    },
    /// The file is not CSV: lines of different length, not UTF-8, cut off.
    #[error("{}: {reason}; correct the line, or export the file again", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Line, and what is wrong there.
        reason: String,
    },
    /// No line of names, or none of values.
    #[error("{} is empty: the first line must name the columns, the others hold numbers", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// No column is time.
    #[error("{}: no column is time: name one {}, or give signals.time; the columns are: {}", path.display(), TIME_COLUMNS.join(", "), columns.join(", "))]
    NoTime {
        /// The file.
        path: PathBuf,
        /// The columns that there are.
        columns: Vec<String>,
    },
    /// There is no such column.
    #[error("signals.{signal}: {} has no column {column:?}; its columns, nearest first: {}", path.display(), columns.join(", "))]
    NoColumn {
        /// The signal.
        signal: String,
        /// The file.
        path: PathBuf,
        /// The column asked for.
        column: String,
        /// The columns that there are.
        columns: Vec<String>,
    },
    /// Two columns of that name.
    #[error("signals.{signal}: {} has more than one column {column:?}: rename one", path.display())]
    Twice {
        /// The signal.
        signal: String,
        /// The file.
        path: PathBuf,
        /// The column asked for.
        column: String,
    },
    /// The function behind the column's name is none.
    #[error("signals.{signal}: {source}")]
    Function {
        /// The signal.
        signal: String,
        /// What is wrong.
        source: MessagePathError,
    },
    /// A cell holds no finite number.
    #[error("{}, line {line}: column {column:?} (signals.{signal}) holds {text:?}, not a finite number; fill it or leave the line out", path.display())]
    NotANumber {
        /// The signal.
        signal: String,
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: u64,
        /// The column.
        column: String,
        /// What stands there.
        text: String,
    },
}

/// Columns of a CSV file.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// Time of every row \[s\].
    pub time: Vec<f64>,
    /// The columns asked for, in that order, each as long as `time`.
    pub values: Vec<Vec<f64>>,
    /// The line of every row, counted from 1.
    pub lines: Vec<u64>,
}

/// Reads the columns `wanted` (signal and column name, which may end in
/// functions as a message path does) of the file at `path`. `time` is the
/// name of the time column; without it one of [`TIME_COLUMNS`] is looked for.
///
/// # Errors
///
/// [`CsvError`].
pub fn read_file(
    path: &Path,
    time: Option<&str>,
    wanted: &[(&str, &str)],
) -> Result<Columns, CsvError> {
    let file = File::open(path).map_err(|source| open_error(path, source))?;
    read(BufReader::new(file), path, time, wanted)
}

/// The names of the file's columns.
///
/// # Errors
///
/// [`CsvError`].
pub fn column_names(path: &Path) -> Result<Vec<String>, CsvError> {
    let file = File::open(path).map_err(|source| open_error(path, source))?;
    let file = Rows {
        source: BufReader::new(file),
        row: Rc::default(),
    };
    Ok(open(file, path)?.1)
}

fn open_error(path: &Path, source: io::Error) -> CsvError {
    let path = path.to_owned();
    CsvError::Open { path, source }
}

fn format_error(path: &Path, error: &csv::Error) -> CsvError {
    CsvError::Format {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}

/// The same from anything that can be read; `path` is for messages.
///
/// # Errors
///
/// [`CsvError`].
pub fn read(
    source: impl Read,
    path: &Path,
    time: Option<&str>,
    wanted: &[(&str, &str)],
) -> Result<Columns, CsvError> {
    read_at_most(MOST_NUMBERS, source, path, time, wanted)
}

fn read_at_most(
    most: usize,
    source: impl Read,
    path: &Path,
    time: Option<&str>,
    wanted: &[(&str, &str)],
) -> Result<Columns, CsvError> {
    let row = Rc::new(Cell::new(0));
    let source = Rows {
        source,
        row: row.clone(),
    };
    let (mut reader, names) = open(source, path)?;
    let columns = Selected::new(path, &names, time, wanted)?;
    let mut read = Columns {
        time: Vec::new(),
        values: vec![Vec::new(); wanted.len()],
        lines: Vec::new(),
    };
    let mut record = csv::StringRecord::new();
    while reader
        .read_record(&mut record)
        .map_err(|error| format_error(path, &error))?
    {
        row.set(0);
        if (read.time.len() + 1) * (wanted.len() + 2) > most {
            return Err(CsvError::TooLarge {
                path: path.to_owned(),
                bytes: path.metadata().map_or(0, |data| data.len()),
                rows: read.time.len(),
                columns: wanted.len() + 2,
            });
        }
        let line = record.position().map_or(0, csv::Position::line);
        columns.take(path, &record, line, &mut read)?;
    }
    match read.time.is_empty() {
        true => Err(CsvError::Empty {
            path: path.to_owned(),
        }),
        false => Ok(read),
    }
}

/// A source whose rows have an end: what is read since the last row is counted.
struct Rows<R> {
    source: R,
    row: Rc<Cell<u64>>,
}

impl<R: Read> Read for Rows<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.row.get() > LONGEST_ROW {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                format!(
                    "a row has more than {LONGEST_ROW} bytes: is a quotation mark open, or is this no CSV?"
                ),
            ));
        }
        let count = self.source.read(bytes)?;
        self.row.set(self.row.get() + count as u64);
        Ok(count)
    }
}

/// A reader behind the line of names, and these names.
fn open<R: Read>(
    mut source: R,
    path: &Path,
) -> Result<(csv::Reader<impl Read + use<R>>, Vec<String>), CsvError> {
    // The first bytes show what separates the columns.
    let mut head = Vec::new();
    source
        .by_ref()
        .take(4096)
        .read_to_end(&mut head)
        .map_err(|source| open_error(path, source))?;
    // A byte order mark says nothing in UTF-8.
    if head.starts_with(b"\xef\xbb\xbf") {
        head.drain(..3);
    }
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .delimiter(delimiter(&head))
        .from_reader(io::Cursor::new(head).chain(source));
    let names: Vec<String> = reader
        .headers()
        .map_err(|error| format_error(path, &error))?
        .iter()
        .map(str::to_owned)
        .collect();
    if names.iter().all(String::is_empty) {
        return Err(CsvError::Empty {
            path: path.to_owned(),
        });
    }
    Ok((reader, names))
}

/// Comma, semicolon or tabulator: which the first line with content has most.
fn delimiter(head: &[u8]) -> u8 {
    let mut lines = head.split(|&byte| byte == b'\n');
    let line = lines
        .find(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"))
        .unwrap_or_default();
    let count = |sign: u8| line.iter().filter(|&&byte| byte == sign).count();
    // The last of equals wins: comma.
    [b'\t', b';', b',']
        .into_iter()
        .max_by_key(|&sign| count(sign))
        .unwrap_or(b',')
}

struct Column {
    signal: String,
    name: String,
    index: usize,
    functions: Vec<Function>,
}

struct Selected {
    time: Column,
    values: Vec<Column>,
}

impl Selected {
    fn new(
        path: &Path,
        names: &[String],
        time: Option<&str>,
        wanted: &[(&str, &str)],
    ) -> Result<Selected, CsvError> {
        let time = match time {
            Some(name) => column(path, names, "time", name)?,
            None => {
                let index = names
                    .iter()
                    .position(|name| TIME_COLUMNS.contains(&name.as_str()));
                let index = index.ok_or_else(|| CsvError::NoTime {
                    path: path.to_owned(),
                    columns: names.to_vec(),
                })?;
                Column {
                    signal: "time".to_owned(),
                    name: names.get(index).cloned().unwrap_or_default(),
                    index,
                    functions: Vec::new(),
                }
            }
        };
        let values: Result<Vec<Column>, CsvError> = wanted
            .iter()
            .map(|(signal, name)| column(path, names, signal, name))
            .collect();
        Ok(Selected {
            time,
            values: values?,
        })
    }

    fn take(
        &self,
        path: &Path,
        record: &csv::StringRecord,
        line: u64,
        read: &mut Columns,
    ) -> Result<(), CsvError> {
        let number = |column: &Column| {
            let text = record.get(column.index).unwrap_or_default();
            let value = text.parse().ok().filter(|value: &f64| value.is_finite());
            let value: Option<f64> = value.map(|value| {
                let functions = column.functions.iter();
                functions.fold(value, |value, function| function.apply(value))
            });
            value.ok_or_else(|| CsvError::NotANumber {
                signal: column.signal.clone(),
                path: path.to_owned(),
                line,
                column: column.name.clone(),
                text: text.chars().take(40).collect(),
            })
        };
        let time = number(&self.time)?;
        for (column, values) in self.values.iter().zip(&mut read.values) {
            values.push(number(column)?);
        }
        read.time.push(time);
        read.lines.push(line);
        Ok(())
    }
}

fn column(path: &Path, names: &[String], signal: &str, name: &str) -> Result<Column, CsvError> {
    let (plain, functions) = match names.iter().any(|known| known == name) {
        true => (name, Vec::new()),
        false => functions_of(name).map_err(|source| CsvError::Function {
            signal: signal.to_owned(),
            source,
        })?,
    };
    let mut places = (0..names.len()).filter(|&index| names.get(index).is_some_and(|n| n == plain));
    match (places.next(), places.next()) {
        (None, _) => Err(CsvError::NoColumn {
            signal: signal.to_owned(),
            path: path.to_owned(),
            column: plain.to_owned(),
            columns: crate::nearest(plain, names.iter().map(String::as_str)),
        }),
        (Some(_), Some(_)) => Err(CsvError::Twice {
            signal: signal.to_owned(),
            path: path.to_owned(),
            column: plain.to_owned(),
        }),
        (Some(index), None) => Ok(Column {
            signal: signal.to_owned(),
            name: plain.to_owned(),
            index,
            functions,
        }),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn parse(text: &str, wanted: &[(&str, &str)]) -> Result<Columns, CsvError> {
        read(text.as_bytes(), Path::new("a.csv"), None, wanted)
    }

    #[test]
    fn columns_are_taken_by_name() {
        for text in [
            "t_s,q,tau\n0,1,2\n0.1,1.5,-2e1\n",
            "\u{feff}# made by hand\n tau ; q ; time\n2;1;0\n\n-20; 1.5 ;0.1",
            "timestamp\ttau\tq\r\n0\t2\t1\r\n0.1\t-20\t1.5\r\n",
        ] {
            let read = parse(
                text,
                &[("position", "q"), ("motor_torque", "tau.@negative")],
            );
            let read = read.unwrap();
            assert_eq!(read.time, [0.0, 0.1]);
            assert_eq!(read.values, [[1.0, 1.5], [-2.0, 20.0]]);
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let message = |text: &str| parse(text, &[("position", "q_m")]).unwrap_err().to_string();
        for (text, words) in [
            ("", "a.csv is empty"),
            ("t_s,q_m\n", "a.csv is empty"),
            (
                "t,q_m\n0,1\n",
                "no column is time: name one t_s, time, timestamp",
            ),
            (
                "t_s,force,q_n\n0,1,2\n",
                "no column \"q_m\"; its columns, nearest first: q_n, t_s",
            ),
            ("t_s,q_m,q_m\n0,1,2\n", "more than one column \"q_m\""),
            (
                "t_s,q_m\n0,1\n1,nan\n",
                "line 3: column \"q_m\" (signals.position) holds \"nan\"",
            ),
            (
                "t_s,q_m\n0,\n",
                "line 2: column \"q_m\" (signals.position) holds \"\"",
            ),
            ("t_s,q_m\n0,1\ninf,1\n", "(signals.time) holds \"inf\""),
            ("t_s,q_m\n0,1\n1\n", "a.csv: CSV error: record 2 (line: 3"),
        ] {
            let found = message(text);
            assert!(found.contains(words), "{found}");
        }
        let found = parse("t_s,q\n0,1\n", &[("position", "q.@sine")]);
        assert!(
            found
                .unwrap_err()
                .to_string()
                .contains("one of the functions")
        );
    }

    #[test]
    fn a_row_without_an_end_is_not_taken_into_memory() {
        for start in ["t_s,q\n0,\"", "t_s,q\n0,", "t_s"] {
            let endless = start.as_bytes().chain(io::repeat(b'1'));
            let refused = read(endless, Path::new("a.csv"), None, &[("position", "q")]);
            let text = refused.unwrap_err().to_string();
            assert!(text.contains("more than 1048576 bytes"), "{text}");
        }
    }

    #[test]
    fn more_numbers_than_are_held_are_refused_by_number() {
        let wanted = [("position", "q")];
        let rows = "t_s,q\n0,1\n1,1\n2,1\n";
        let read = |most| read_at_most(most, rows.as_bytes(), Path::new("a.csv"), None, &wanted);
        assert_eq!(read(9).unwrap().time.len(), 3);
        let refused = read(8).unwrap_err();
        assert!(
            matches!(
                refused,
                CsvError::TooLarge {
                    rows: 2,
                    columns: 3,
                    ..
                }
            ),
            "{refused}"
        );
        assert!(refused.to_string().contains("keep every n-th row"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        /// Any bytes are read or refused, and nothing grows beyond them.
        #[test]
        fn any_bytes_are_read_or_refused(
            bytes in prop_oneof![
                prop::collection::vec(any::<u8>(), 0..200),
                "t_s[,;]q\n([0-9e.,;\"#\n -]|nan|\\PC){0,60}".prop_map(String::into_bytes),
            ],
        ) {
            if let Ok(read) = read(&bytes[..], Path::new("a.csv"), None, &[("position", "q")]) {
                prop_assert!(read.time.len() <= bytes.len());
                prop_assert_eq!(read.values[0].len(), read.time.len());
                prop_assert!(read.values[0].iter().all(|value| value.is_finite()));
            }
        }
    }
}

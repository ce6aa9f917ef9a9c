//! Which files hold tables.

use std::path::Path;

/// Names of the column that is time, where none is given; the first column of
/// the file that has one of them is it.
pub const TIME_COLUMNS: [&str; 4] = ["t_s", "time", "timestamp", "t"];

/// What a file holds, by the ending of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Text: CSV and its relatives.
    Text,
    /// A ZIP archive of NumPy's arrays.
    Npz,
    /// One of NumPy's arrays.
    Npy,
    /// MATLAB's file.
    Mat,
}

/// The endings of files that hold tables.
pub const ENDINGS: [(&str, Format); 7] = [
    ("csv", Format::Text),
    ("tsv", Format::Text),
    ("txt", Format::Text),
    ("dat", Format::Text),
    ("npz", Format::Npz),
    ("npy", Format::Npy),
    ("mat", Format::Mat),
];

impl Format {
    /// The format of the file at `path`; `None` where its name does not end as
    /// that of a table.
    #[must_use]
    pub fn of(path: &Path) -> Option<Format> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        let mut known = ENDINGS.iter();
        known
            .find(|(name, _)| *name == ending)
            .map(|(_, format)| *format)
    }
}

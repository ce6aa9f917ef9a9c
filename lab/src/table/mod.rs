//! Tables: columns of numbers in one file, whatever its format.
//!
//! * [`text`]: `.csv`, `.tsv`, `.txt`, `.dat`,
//! * `arrays`: `.npz`, `.npy`, `.mat`.

mod arrays;
pub mod error;
mod format;
mod survey;
pub mod text;

use std::path::{Path, PathBuf};

pub use error::TableError;
pub use format::{ENDINGS, Format, TIME_COLUMNS};
pub use survey::ColumnSurvey;
pub use text::number::Cell;

use crate::message_path::{Function, functions_of};
use arrays::Array;
use text::dialect::Dialect;

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit, where the file says it apart from the name.
    pub unit: Option<String>,
}

/// A file with columns of numbers. Rows are read from the file each time.
#[derive(Clone, Debug)]
pub struct Table {
    path: PathBuf,
    columns: Vec<Column>,
    named: bool,
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    Text(Dialect),
    Arrays(Vec<Array>),
}

/// A column that a signal is made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Selected {
    /// Which column it is.
    pub index: usize,
    /// The column's name.
    pub name: String,
    /// What is done to its values.
    pub functions: Vec<Function>,
}

impl Selected {
    /// A value with the functions done to it.
    #[must_use]
    pub fn apply(&self, value: f64) -> f64 {
        let functions = self.functions.iter();
        functions.fold(value, |value, function| function.apply(value))
    }
}

impl Table {
    /// Looks at the file at `path`. `columns` are the columns' names in place of
    /// those in the file; none: as the file says.
    ///
    /// # Errors
    ///
    /// It cannot be read, is empty, or has another number of columns.
    pub fn open(path: &Path, columns: &[String]) -> Result<Table, TableError> {
        match Format::of(path) {
            Some(format) if format != Format::Text => Table::of_arrays(path, format, columns),
            _ => Table::of_text(path, columns),
        }
    }

    fn of_arrays(path: &Path, format: Format, columns: &[String]) -> Result<Table, TableError> {
        let arrays = arrays::read(path, format)?;
        let own = arrays.iter().map(|array| Column {
            name: array.name.clone(),
            unit: None,
        });
        let own = own.collect();
        Table::named(path, own, true, columns, Content::Arrays(arrays))
    }

    fn of_text(path: &Path, columns: &[String]) -> Result<Table, TableError> {
        let dialect = text::look(path)?;
        let units = dialect.units.iter().cloned();
        let own: Vec<Column> = dialect
            .names
            .iter()
            .zip(units.chain(std::iter::repeat(None)))
            .map(|(name, unit)| Column {
                name: name.clone(),
                unit,
            })
            .collect();
        let named = dialect.named;
        Table::named(path, own, named, columns, Content::Text(dialect))
    }

    fn named(
        path: &Path,
        mut own: Vec<Column>,
        mut named: bool,
        columns: &[String],
        content: Content,
    ) -> Result<Table, TableError> {
        if !columns.is_empty() {
            if columns.len() != own.len() {
                return Err(TableError::Names {
                    path: path.to_owned(),
                    given: columns.len(),
                    there: own.len(),
                });
            }
            named = true;
            for (column, name) in own.iter_mut().zip(columns) {
                column.name.clone_from(name);
            }
        }
        Ok(Table {
            path: path.to_owned(),
            columns: own,
            named,
            content,
        })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its columns, in order.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The columns' names, in order.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        self.columns.iter().map(|own| own.name.clone()).collect()
    }

    /// Whether the names were given, by the file or otherwise.
    #[must_use]
    pub fn is_named(&self) -> bool {
        self.named
    }

    /// About how many rows it has.
    #[must_use]
    pub fn estimated_rows(&self) -> u64 {
        match &self.content {
            Content::Text(dialect) => {
                let bytes = self.path.metadata().map_or(0, |data| data.len());
                (bytes as f64 / dialect.row_bytes.max(1.0)).ceil() as u64
            }
            Content::Arrays(arrays) => {
                let longest = arrays.iter().map(|array| array.values.len()).max();
                longest.unwrap_or(0) as u64
            }
        }
    }

    /// The column called `name`, which may end in functions as a message path does.
    ///
    /// # Errors
    ///
    /// There is none of that name, or more than one; the function is none.
    pub fn select(&self, signal: &str, name: &str) -> Result<Selected, TableError> {
        let has = |name: &str| self.columns.iter().any(|column| column.name == name);
        let (plain, functions) = match has(name) {
            true => (name, Vec::new()),
            false => functions_of(name).map_err(|source| TableError::Function {
                signal: signal.to_owned(),
                source,
            })?,
        };
        let of_that_name = self.columns.iter().enumerate();
        let mut places = of_that_name.filter(|(_, column)| column.name == plain);
        match (places.next(), places.next()) {
            (None, _) => Err(TableError::NoColumn {
                signal: signal.to_owned(),
                path: self.path.clone(),
                column: plain.to_owned(),
                columns: crate::nearest(plain, self.columns.iter().map(|own| own.name.as_str())),
            }),
            (Some(_), Some(_)) => Err(TableError::Twice {
                signal: signal.to_owned(),
                path: self.path.clone(),
                column: plain.to_owned(),
            }),
            (Some((index, _)), None) => Ok(Selected {
                index,
                name: plain.to_owned(),
                functions,
            }),
        }
    }

    /// The column of [`TIME_COLUMNS`], in the order of the file.
    #[must_use]
    pub fn time_column(&self) -> Option<&str> {
        let mut names = self.columns.iter().map(|own| own.name.as_str());
        names.find(|name| TIME_COLUMNS.contains(name))
    }

    /// Calls `visit` with the place (a line or a row, counted from 1) and the
    /// cells of the columns `wanted` of every row, in order. Tells whether the
    /// file is cut off within its last row, which is left out then.
    ///
    /// # Errors
    ///
    /// What `visit` says; the file cannot be read.
    pub fn rows<E: From<TableError>>(
        &self,
        wanted: &[usize],
        mut visit: impl FnMut(u64, &[Cell<'_>]) -> Result<(), E>,
    ) -> Result<bool, E> {
        match &self.content {
            Content::Text(dialect) => text::rows(&self.path, dialect, wanted, visit),
            Content::Arrays(arrays) => {
                let empty: &[f64] = &[];
                let asked: Vec<&[f64]> = wanted
                    .iter()
                    .map(|at| arrays.get(*at).map_or(empty, |array| &array.values))
                    .collect();
                let longest = asked.iter().map(|own| own.len()).max().unwrap_or(0);
                let mut cells = vec![Cell::Missing; asked.len()];
                for row in 0..longest {
                    for (cell, values) in cells.iter_mut().zip(&asked) {
                        *cell = match values.get(row) {
                            Some(value) if value.is_finite() => Cell::Number(*value),
                            _ => Cell::Missing,
                        };
                    }
                    visit(row as u64 + 1, &cells)?;
                }
                Ok(false)
            }
        }
    }

    /// What a place is called in messages.
    #[must_use]
    pub fn place(&self, number: u64) -> String {
        match &self.content {
            Content::Text(_) => format!("line {number}"),
            Content::Arrays(_) => format!("row {number}"),
        }
    }
}

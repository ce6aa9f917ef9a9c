//! Columns of numbers.

/// Numbers with a name; NaN where there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Its name, with its unit at the end.
    pub name: String,
    /// A number a row.
    pub values: Vec<f64>,
}

impl Column {
    /// Without rows yet.
    pub fn new(name: impl Into<String>) -> Column {
        Column {
            name: name.into(),
            values: Vec::new(),
        }
    }
}

/// Columns of equal length.
pub type Table = Vec<Column>;

/// Rows of a table.
pub fn rows(table: &Table) -> usize {
    table.first().map_or(0, |column| column.values.len())
}

//! What the columns of a table hold, in one go over its rows: nothing is kept.

use serde::Serialize;

use super::{Cell, Table, TableError};

/// Intervals from which the median is taken, at most.
const INTERVALS: usize = 10_000;

/// What a column holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ColumnSurvey {
    /// Its name.
    pub name: String,
    /// Its unit, where the file says it apart from the name.
    pub unit: Option<String>,
    /// Cells with a number.
    pub numbers: u64,
    /// Cells with none, or with NaN.
    pub missing: u64,
    /// Cells with words.
    pub words: u64,
    /// The first number.
    pub first: f64,
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
    /// Whether no number is below the one before, and the last above the first.
    pub ascends: bool,
    /// Median difference of neighbours.
    pub step: f64,
    #[serde(skip)]
    last: f64,
    #[serde(skip)]
    steps: Vec<f64>,
}

impl ColumnSurvey {
    /// Of a column that nothing is known of.
    #[must_use]
    pub fn new(name: String, unit: Option<String>) -> ColumnSurvey {
        ColumnSurvey {
            name,
            unit,
            ..ColumnSurvey::default()
        }
    }

    fn take(&mut self, cell: &Cell<'_>) {
        let value = match cell {
            Cell::Number(value) => *value,
            Cell::Missing => {
                self.missing += 1;
                return;
            }
            Cell::Text(_) => {
                self.words += 1;
                return;
            }
        };
        if self.numbers == 0 {
            (self.first, self.last) = (value, value);
            (self.least, self.greatest, self.ascends) = (value, value, true);
        } else {
            if self.steps.len() < INTERVALS {
                self.steps.push(value - self.last);
            }
            self.ascends &= value >= self.last;
        }
        self.numbers += 1;
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
        self.last = value;
    }

    fn finish(mut self) -> ColumnSurvey {
        let middle = self.steps.len() / 2;
        if !self.steps.is_empty() {
            let (_, median, _) = self.steps.select_nth_unstable_by(middle, f64::total_cmp);
            self.step = *median;
        }
        self.ascends &= self.numbers > 1 && self.last > self.first;
        self.steps = Vec::new();
        self
    }

    /// From the least to the greatest.
    #[must_use]
    pub fn range(&self) -> f64 {
        self.greatest - self.least
    }
}

impl Table {
    /// What the columns hold, and how many rows there are.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn survey(&self) -> Result<(Vec<ColumnSurvey>, u64), TableError> {
        let columns = self
            .columns()
            .iter()
            .map(|column| ColumnSurvey::new(column.name.clone(), column.unit.clone()));
        let mut columns: Vec<ColumnSurvey> = columns.collect();
        let wanted: Vec<usize> = (0..columns.len()).collect();
        let mut rows = 0;
        self.rows(&wanted, |_, cells| -> Result<(), TableError> {
            rows += 1;
            for (column, cell) in columns.iter_mut().zip(cells) {
                column.take(cell);
            }
            Ok(())
        })?;
        if rows == 0 {
            return Err(TableError::Empty {
                path: self.path().to_owned(),
            });
        }
        Ok((
            columns.into_iter().map(ColumnSurvey::finish).collect(),
            rows,
        ))
    }
}

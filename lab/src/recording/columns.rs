//! Signals out of tables: one file, or several that were recorded together.
//!
//! The signals of each file have the file's own times. Joined by time they meet
//! where signals of one file do ([`align`](super::align)); joined by row those of
//! the first file are those of all.

use std::{collections::BTreeMap, path::Path};

use super::{LoadError, Series, series::Wanted, tally::Tally};
use crate::{
    experiment::{Experiment, Join},
    table::{Cell, Selected, Table, TableError},
    unit::Unit,
};

/// Numbers of a recording's signals that are held at once, at most.
const MOST_NUMBERS: u64 = 8_000_000;
/// Stretches that a longer one is cut into, spread evenly over it.
const STRETCHES: u64 = 100;

/// Which rows of a file are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Window {
    /// So many …
    take: u64,
    /// … of so many.
    of: u64,
}

impl Window {
    /// All of `rows`, or stretches of them so that no more than `most` numbers of
    /// this many signals are held.
    fn new(rows: u64, signals: usize, most: u64) -> Window {
        let most = most / signals.max(1) as u64;
        if rows <= most {
            return Window { take: 1, of: 1 };
        }
        let of = (rows / STRETCHES).max(1);
        let take = (of as f64 * most as f64 / rows as f64) as u64;
        Window {
            take: take.max(1),
            of,
        }
    }

    const fn takes(self, row: u64) -> bool {
        row % self.of < self.take
    }
}

/// Where the time of a signal's rows is from.
enum Clock<'a> {
    Column {
        at: usize,
        column: Selected,
        unit: Option<Unit>,
    },
    Rate(f64),
    /// Row by row; a row without a time has [`NEVER`].
    Rows(&'a [i64]),
}

/// The time of a row that has none.
const NEVER: i64 = i64::MIN;

/// A signal while its file is read.
struct Reading<'a> {
    series: Series,
    column: Selected,
    /// Where its cell is among those asked for.
    at: usize,
    clock: Clock<'a>,
}

/// Reads the signals `wanted` from the table at `file` and those joined to it.
pub(super) fn read(
    experiment: &Experiment,
    file: &Path,
    wanted: &[Wanted],
    notes: &mut Vec<String>,
) -> Result<(Vec<Series>, Tally), LoadError> {
    read_at_most(MOST_NUMBERS, experiment, file, wanted, notes)
}

fn read_at_most(
    most: u64,
    experiment: &Experiment,
    file: &Path,
    wanted: &[Wanted],
    notes: &mut Vec<String>,
) -> Result<(Vec<Series>, Tally), LoadError> {
    let tables = open(experiment, file)?;
    let homes = homes(&tables, wanted)?;
    let by_row = is_by_row(experiment, &tables)?;
    let mut all: BTreeMap<usize, Series> = BTreeMap::new();
    let mut tally = Tally::new(file);
    let mut times: Option<Vec<i64>> = None;
    let mut window = None;
    for (number, table) in tables.iter().enumerate() {
        let own: Vec<(usize, &Wanted, Selected)> = wanted
            .iter()
            .enumerate()
            .zip(&homes)
            .filter(|(_, (home, _))| *home == number)
            .map(|((at, each), (_, column))| (at, each, column.clone()))
            .collect();
        let leads = by_row && number == 0 && tables.len() > 1;
        if own.is_empty() && !leads {
            continue;
        }
        let rows = table.estimated_rows();
        let rows_window = *window.get_or_insert_with(|| Window::new(rows, wanted.len(), most));
        let rows_window = match by_row {
            true => rows_window,
            false => Window::new(rows, wanted.len(), most),
        };
        let known = times.take();
        let mut keep = leads.then(Vec::new);
        let clock_of = known.as_deref().filter(|_| by_row && number > 0);
        let (series, read) =
            read_table(experiment, table, own, clock_of, rows_window, keep.as_mut())?;
        if let Some(first) = &known
            && by_row
            && first.len() as u64 != read.rows
        {
            return Err(LoadError::Rows {
                file: table.path().to_owned(),
                rows: read.rows,
                first: file.to_owned(),
                first_rows: first.len() as u64,
            });
        }
        times = keep.or(known);
        if read.cut_off {
            notes.push(format!(
                "{}: the file is cut off within its last line, which is left out",
                table.path().display()
            ));
        }
        if series.contains_key(&0) {
            tally.samples = read.rows as usize;
            tally.too_much = read.skipped as usize;
        }
        if read.skipped > 0 {
            notes.push(format!(
                "{}: {} rows are more than are held at once: stretches all over it are read, {:.0} % of it",
                table.path().display(),
                read.rows,
                100.0 * (1.0 - read.skipped as f64 / read.rows.max(1) as f64)
            ));
        }
        all.extend(series);
    }
    Ok((all.into_values().collect(), tally))
}

/// The file and those that are joined to it.
fn open(experiment: &Experiment, file: &Path) -> Result<Vec<Table>, LoadError> {
    let others = experiment.joined.get(file).into_iter().flatten();
    let files = std::iter::once(file).chain(others.map(AsRef::as_ref));
    let columns = &experiment.reading.columns;
    let tables = files.enumerate().map(|(number, file)| {
        let names = match columns.as_slice() {
            [one] => Some(one),
            several => several.get(number),
        };
        Table::open(file, names.map_or(&[], Vec::as_slice))
    });
    Ok(tables.collect::<Result<_, TableError>>()?)
}

/// In which table, and where there, each of the signals is. `file.csv:name` names
/// the column of one of several files.
fn homes(tables: &[Table], wanted: &[Wanted]) -> Result<Vec<(usize, Selected)>, LoadError> {
    let mut homes = Vec::new();
    for each in wanted {
        let mut found = Vec::new();
        let mut last = None;
        for (number, table) in tables.iter().enumerate() {
            let name = table.path().file_name().unwrap_or_default();
            let prefix = format!("{}:", name.to_string_lossy());
            let (column, is_named) = match each.path.strip_prefix(&prefix) {
                Some(column) if tables.len() > 1 => (column, true),
                _ => (each.path.as_str(), false),
            };
            match table.select(&each.signal, column) {
                Ok(column) => found.push((number, column)),
                Err(error) if is_named || tables.len() == 1 => return Err(error.into()),
                Err(error @ TableError::NoColumn { .. }) => last = Some(error),
                Err(error) => return Err(error.into()),
            }
        }
        match (found.len(), last) {
            (1, _) => homes.append(&mut found),
            (
                0,
                Some(TableError::NoColumn {
                    signal,
                    path,
                    column,
                    ..
                }),
            ) => {
                let names: Vec<String> = tables.iter().flat_map(Table::names).collect();
                let columns = crate::nearest(&column, names.iter().map(String::as_str));
                return Err(TableError::NoColumn {
                    signal,
                    path,
                    column,
                    columns,
                }
                .into());
            }
            _ => {
                let files = found.iter().filter_map(|(number, _)| tables.get(*number));
                let names = files.filter_map(|table| table.path().file_name());
                return Err(LoadError::Ambiguous {
                    signal: each.signal.clone(),
                    column: each.path.clone(),
                    files: names
                        .map(|name| name.to_string_lossy().into_owned())
                        .collect(),
                });
            }
        }
    }
    Ok(homes)
}

/// The column that is time in `table`: as the experiment says, or by its name.
fn time_of(experiment: &Experiment, table: &Table) -> Result<Option<Selected>, TableError> {
    let named = match &experiment.signals.time {
        Some(name) => match table.select("time", name) {
            Err(TableError::NoColumn { .. }) if table.time_column().is_some() => None,
            column => Some(column?),
        },
        None => None,
    };
    match (named, table.time_column()) {
        (Some(column), _) => Ok(Some(column)),
        (None, Some(name)) => table.select("time", name).map(Some),
        (None, None) => Ok(None),
    }
}

/// Whether the files are joined row by row: as the experiment says, else where
/// not all of them have a time.
fn is_by_row(experiment: &Experiment, tables: &[Table]) -> Result<bool, LoadError> {
    if let Some(join) = experiment.reading.join {
        return Ok(join == Join::Row);
    }
    let timed = tables.iter().filter(|table| {
        let column = time_of(experiment, table);
        column.is_ok_and(|column| column.is_some())
    });
    let timed = timed.count();
    Ok(tables.len() > 1 && timed < tables.len())
}

/// What was seen of a file.
struct Seen {
    rows: u64,
    skipped: u64,
    cut_off: bool,
}

fn read_table(
    experiment: &Experiment,
    table: &Table,
    wanted: Vec<(usize, &Wanted, Selected)>,
    by_row: Option<&[i64]>,
    window: Window,
    mut keep: Option<&mut Vec<i64>>,
) -> Result<(BTreeMap<usize, Series>, Seen), LoadError> {
    let unit = experiment.signals.unit("time");
    let mut asked: Vec<usize> = Vec::new();
    let mut ask = |index: usize| match asked.iter().position(|own| *own == index) {
        Some(at) => at,
        None => {
            asked.push(index);
            asked.len() - 1
        }
    };
    let mut clock_by = |time: Option<&String>| -> Result<Clock<'_>, LoadError> {
        let column = match (time, experiment.reading.rate_hz, by_row) {
            (Some(own), _, _) => Some(table.select("time", own)?),
            (None, _, Some(times)) => return Ok(Clock::Rows(times)),
            (None, Some(rate), None) => return Ok(Clock::Rate(rate)),
            (None, None, None) => time_of(experiment, table)?,
        };
        let column = column.ok_or_else(|| TableError::NoTime {
            path: table.path().to_owned(),
            columns: table.names(),
        })?;
        Ok(Clock::Column {
            at: ask(column.index),
            column,
            unit,
        })
    };
    let leading = match keep {
        Some(_) => Some(clock_by(None)?),
        None => None,
    };
    let mut clocks = Vec::new();
    for (_, each, _) in &wanted {
        clocks.push(clock_by(each.time.as_ref())?);
    }
    let mut readings: Vec<(usize, Reading<'_>)> = Vec::new();
    for ((number, each, column), clock) in wanted.into_iter().zip(clocks) {
        let reading = Reading {
            series: Series::new(each, table.path()),
            at: ask(column.index),
            column,
            clock,
        };
        readings.push((number, reading));
    }
    let (mut row, mut skipped) = (0_u64, 0_u64);
    let cut_off = table.rows(&asked, |line, cells| -> Result<(), LoadError> {
        let own = row;
        row += 1;
        if let (Some(times), Some(clock)) = (keep.as_deref_mut(), &leading) {
            times.push(clock.time(table, own, line, cells)?.unwrap_or(NEVER));
        }
        if !window.takes(own) {
            skipped += 1;
            return Ok(());
        }
        for (_, reading) in &mut readings {
            reading.take(table, own, line, cells)?;
        }
        Ok(())
    })?;
    if row == 0 {
        return Err(TableError::Empty {
            path: table.path().to_owned(),
        }
        .into());
    }
    for (_, reading) in &readings {
        if reading.series.times.is_empty() {
            return Err(TableError::NoNumber {
                signal: reading.series.signal.clone(),
                path: table.path().to_owned(),
                column: reading.column.name.clone(),
                rows: row,
            }
            .into());
        }
    }
    let series = readings.into_iter().map(|(at, own)| (at, own.series));
    let seen = Seen {
        rows: row,
        skipped,
        cut_off,
    };
    Ok((series.collect(), seen))
}

impl Clock<'_> {
    /// The time of a row \[ns\]; `None` where it has none.
    fn time(
        &self,
        table: &Table,
        row: u64,
        line: u64,
        cells: &[Cell<'_>],
    ) -> Result<Option<i64>, LoadError> {
        let seconds = match self {
            Clock::Rate(rate) => Some(row as f64 / rate),
            Clock::Rows(times) => {
                let time = usize::try_from(row).ok().and_then(|row| times.get(row));
                return Ok(time.copied().filter(|time| *time != NEVER));
            }
            Clock::Column { at, column, unit } => {
                let value = number(table, "time", column, line, cells.get(*at))?;
                value.map(|value| unit.map_or(value, |unit| unit.convert(value)))
            }
        };
        // Beyond 292 years the time saturates, and so ends the series.
        Ok(seconds.map(|seconds| (seconds * 1e9).round() as i64))
    }
}

impl Reading<'_> {
    fn take(
        &mut self,
        table: &Table,
        row: u64,
        line: u64,
        cells: &[Cell<'_>],
    ) -> Result<(), LoadError> {
        let signal = &self.series.signal;
        let value = number(table, signal, &self.column, line, cells.get(self.at))?;
        let time = self.clock.time(table, row, line, cells)?;
        let place = || table.place(line);
        match (time, value) {
            (Some(time), Some(value)) => self.series.push(time, value, place),
            _ => {
                self.series.miss(place);
                Ok(())
            }
        }
    }
}

/// The number in a cell, with the column's functions done to it.
fn number(
    table: &Table,
    signal: &str,
    column: &Selected,
    line: u64,
    cell: Option<&Cell<'_>>,
) -> Result<Option<f64>, TableError> {
    match cell {
        Some(Cell::Number(value)) => Ok(Some(column.apply(*value))),
        Some(Cell::Text(text)) => Err(TableError::NotANumber {
            signal: signal.to_owned(),
            path: table.path().to_owned(),
            place: table.place(line),
            column: column.name.clone(),
            text: text.chars().take(40).collect(),
        }),
        Some(Cell::Missing) | None => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_spread_evenly_and_hold_no_more_than_they_may() {
        assert_eq!(Window::new(1000, 2, 2000), Window { take: 1, of: 1 });
        let window = Window::new(1_000_000, 2, 200_000);
        let taken = (0..1_000_000).filter(|row| window.takes(*row));
        let taken: Vec<u64> = taken.collect();
        assert!((90_000..=100_000).contains(&taken.len()), "{}", taken.len());
        assert!(taken.last() > Some(&980_000));
    }
}

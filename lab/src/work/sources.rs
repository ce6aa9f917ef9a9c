//! Files that somebody brought: which are recordings of their own, which are parts
//! of one, and what columns they have.

use std::path::{Path, PathBuf};

use ferntast_bag::BagReader;

use super::{NewError, WorkError, chain::ArmChain, request::Request};
use crate::{
    experiment::ExperimentError,
    guess::{array_by_name, opposes},
    numbers::{joint_arrays_of, numbers_of},
    table::{ColumnSurvey, Format, Table},
};

/// What the files are.
#[derive(Clone, Debug)]
pub(super) struct Sources {
    /// Recordings, each with the files that it is joined from.
    pub(super) recordings: Vec<Vec<PathBuf>>,
    /// The columns of one recording; of messages the paths of their numbers.
    pub(super) columns: Vec<ColumnSurvey>,
    /// Whether these are tables.
    pub(super) tables: bool,
    /// Whether the columns have names, by the files or as they were given.
    pub(super) named: bool,
}

impl Sources {
    /// The column of that name.
    pub(super) fn column(&self, name: &str) -> Option<&ColumnSurvey> {
        self.columns.iter().find(|own| own.name == name)
    }

    /// The column that a path is made from, which may end in functions.
    pub(super) fn of(&self, path: &str) -> Option<&ColumnSurvey> {
        let bare = path.split(".@").next().unwrap_or_default();
        self.column(path).or_else(|| self.column(bare))
    }

    /// Looks at the files; `chain` is the arm's that they are of.
    pub(super) fn look(request: &Request, chain: Option<&ArmChain>) -> Result<Sources, NewError> {
        let mut files = Vec::new();
        for file in &request.files {
            files.extend(tables_in(file)?);
        }
        let is_table = |file: &PathBuf| Format::of(file).is_some() && !file.is_dir();
        match (files.iter().all(is_table), files.iter().any(is_table)) {
            (true, _) => tables(request, files),
            (false, true) => Err(NewError::Mixed),
            (false, false) => messages(files, request, chain),
        }
    }
}

/// A folder that is no recording stands for the tables in it.
fn tables_in(file: &Path) -> Result<Vec<PathBuf>, NewError> {
    let error = |source| WorkError::File {
        path: file.to_owned(),
        source,
    };
    if !file.is_dir() {
        return Ok(vec![file.to_owned()]);
    }
    let entries: Result<Vec<_>, _> = file.read_dir().map_err(error)?.collect();
    let paths = entries.map_err(error)?;
    let mut paths: Vec<PathBuf> = paths.iter().map(std::fs::DirEntry::path).collect();
    paths.sort();
    if paths
        .iter()
        .any(|path| path.extension().is_some_and(|end| end == "mcap"))
    {
        return Ok(vec![file.to_owned()]);
    }
    paths.retain(|path| Format::of(path).is_some());
    match paths.is_empty() {
        true => Err(NewError::EmptyFolder {
            path: file.to_owned(),
        }),
        false => Ok(paths),
    }
}

fn messages(
    files: Vec<PathBuf>,
    request: &Request,
    chain: Option<&ArmChain>,
) -> Result<Sources, NewError> {
    let mut paths = Vec::new();
    if let Some(first) = files.first() {
        let bag = BagReader::open(first)
            .map_err(|error| WorkError::from(ExperimentError::from(error)))?;
        // An arm's joints by their names: their order in the array may be another.
        for array in chain.map_or_else(Vec::new, |_| joint_arrays_of(&bag)) {
            let joints = chain.map_or_else(Vec::new, ArmChain::names).into_iter();
            paths.extend(joints.map(|joint| array_by_name(&array, joint)));
        }
        for path in numbers_of(&bag) {
            let turned = opposes(&path).filter(|_| request.is_contact());
            paths.push(path);
            paths.extend(turned);
        }
    }
    let columns = paths.into_iter().map(|name| ColumnSurvey::new(name, None));
    Ok(Sources {
        recordings: files.into_iter().map(|file| vec![file]).collect(),
        columns: columns.collect(),
        tables: false,
        named: true,
    })
}

/// Tables with the same columns are recordings of their own; with others, parts of
/// one.
fn tables(request: &Request, files: Vec<PathBuf>) -> Result<Sources, NewError> {
    let mut all: Vec<(PathBuf, Vec<ColumnSurvey>)> = Vec::new();
    let mut named = true;
    for file in files {
        let table = Table::open(&file, &request.columns).map_err(WorkError::from)?;
        named &= table.is_named();
        all.push((file, table.survey().map_err(WorkError::from)?.0));
    }
    let names = |columns: &[ColumnSurvey]| -> Vec<String> {
        columns.iter().map(|own| own.name.clone()).collect()
    };
    let first = all.first().map(|(_, columns)| names(columns));
    let alike = all.iter().all(|(_, columns)| Some(names(columns)) == first);
    let joined = request.join.is_some() || !alike;
    let mut columns: Vec<ColumnSurvey> = Vec::new();
    if joined {
        for (file, own) in &all {
            for column in own {
                let shared = all
                    .iter()
                    .filter(|(_, other)| other.iter().any(|other| other.name == column.name));
                let mut column = column.clone();
                // Each file's own time has one name.
                let is_time =
                    crate::table::TIME_COLUMNS.contains(&column.name.as_str()) || column.ascends;
                if shared.count() > 1 && !is_time {
                    let file = file.file_name().unwrap_or_default().to_string_lossy();
                    column.name = format!("{file}:{}", column.name);
                }
                if !columns.iter().any(|known| known.name == column.name) {
                    columns.push(column);
                }
            }
        }
    } else {
        for (_, own) in &all {
            merge(&mut columns, own);
        }
    }
    let files: Vec<PathBuf> = all.into_iter().map(|(file, _)| file).collect();
    Ok(Sources {
        recordings: match joined {
            true => vec![files],
            false => files.into_iter().map(|file| vec![file]).collect(),
        },
        columns,
        tables: true,
        named,
    })
}

/// Ranges over all recordings.
fn merge(columns: &mut Vec<ColumnSurvey>, own: &[ColumnSurvey]) {
    if columns.is_empty() {
        *columns = own.to_vec();
        return;
    }
    for (known, own) in columns.iter_mut().zip(own) {
        known.least = known.least.min(own.least);
        known.greatest = known.greatest.max(own.greatest);
        known.ascends &= own.ascends;
        known.numbers += own.numbers;
        known.missing += own.missing;
        known.words += own.words;
    }
}

//! A recording as tables in a folder.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ferntast_bag::BagReader;
use ferntast_msgs::Time;
use serde::Serialize;

use super::{
    ExportError, csv,
    joined::joined,
    parquet,
    table::{Column, Table, rows},
    topic::{TopicNumbers, topics_of},
};

/// What tables are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Text.
    Csv,
    /// Apache Parquet.
    Parquet,
}

/// What is to be exported.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// A rosbag2 directory or MCAP file.
    pub recording: PathBuf,
    /// The folder for the tables, which must not exist.
    pub output: PathBuf,
    /// As what.
    pub format: Format,
    /// Only these topics; all where none is named.
    pub topics: Vec<String>,
    /// All in one table, with so many rows in a second \[Hz\]; else one table a topic, with a
    /// row a message.
    pub rate_hz: Option<f64>,
}

/// A table that was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Written {
    /// The file.
    pub file: PathBuf,
    /// Its topic; `None` where several are joined.
    pub topic: Option<String>,
    /// Rows.
    pub rows: usize,
    /// Names of its columns.
    pub columns: Vec<String>,
}

/// Writes the tables that are asked for. The columns of a topic are `t_s`, the log time
/// since the recording's start, `stamp_s`, the stamp in the header since then, where there
/// is one, and the numbers of the message.
///
/// # Errors
///
/// [`ExportError`]; a file may be written in part only where the disk is full.
pub fn tables(request: &Request) -> Result<Vec<Written>, ExportError> {
    let (path, output) = (&request.recording, &request.output);
    if output.exists() {
        return Err(ExportError::Exists(output.clone()));
    }
    let bag = BagReader::open(path)?;
    let topics = topics_of(path, &bag, &request.topics)?;
    if let Some(rate) = request.rate_hz {
        let table = joined(path, &bag, topics, rate)?;
        fs::create_dir_all(output).map_err(ExportError::file(output))?;
        return Ok(vec![write(request, "joined", None, &table)?]);
    }
    fs::create_dir_all(output).map_err(ExportError::file(output))?;
    let start = bag.bounds().map_or(Time::from_nanos(0), |(start, _)| start);
    let mut written = Vec::new();
    for mut topic in topics {
        let table = table_of(&bag, &mut topic, start)?;
        // A dot is in no topic's name, so that no two become one.
        let name = topic.name.trim_matches('/').replace('/', ".");
        written.push(write(request, &name, Some(topic.name), &table)?);
    }
    Ok(written)
}

fn table_of(bag: &BagReader, topic: &mut TopicNumbers, start: Time) -> Result<Table, ExportError> {
    let mut table: Table = vec![Column::new("t_s")];
    if topic.is_stamped() {
        table.push(Column::new("stamp_s"));
    }
    table.extend(topic.columns.iter().map(Column::new));
    for message in bag.raw_topics(&[topic.name.as_str()], Time::from_nanos(0))? {
        let message = message?;
        let row = topic.read(&message)?;
        let mut columns = table.iter_mut();
        if let Some(time) = columns.next() {
            time.values.push(message.log_time.seconds_since(start));
        }
        if topic.is_stamped()
            && let Some(stamp) = columns.next()
        {
            let since = |own: i64| own.saturating_sub(start.nanos()) as f64 * 1e-9;
            stamp.values.push(row.stamp.map_or(f64::NAN, since));
        }
        for (column, value) in columns.zip(row.values) {
            column.values.push(value);
        }
    }
    Ok(table)
}

fn write(
    request: &Request,
    name: &str,
    topic: Option<String>,
    table: &Table,
) -> Result<Written, ExportError> {
    let ending = match request.format {
        Format::Csv => "csv",
        Format::Parquet => "parquet",
    };
    let file: PathBuf = request.output.join(format!("{name}.{ending}"));
    let path: &Path = &file;
    let done = match request.format {
        Format::Csv => csv::write(path, table),
        Format::Parquet => parquet::write_numbers(path, table),
    };
    done.map_err(ExportError::file(path))?;
    Ok(Written {
        rows: rows(table),
        columns: table.iter().map(|column| column.name.clone()).collect(),
        topic,
        file,
    })
}

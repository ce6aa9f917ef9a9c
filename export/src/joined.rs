//! Several topics at one rate: what was heard last, at that time.

use std::path::Path;

use ferntast_bag::BagReader;
use ferntast_msgs::Time;

use super::{
    ExportError,
    table::{Column, Table},
    topic::TopicNumbers,
};

/// Numbers that are held at once, at most.
const MOST_NUMBERS: usize = 64_000_000;
/// Rows in a second, at most \[Hz\].
const FASTEST: f64 = 10_000.0;

/// The numbers of `topics` at `rate_hz`, from the recording's start to its end, each as it
/// was heard last; NaN before it was heard first. The first column is the time since the
/// recording's start \[s\].
///
/// # Errors
///
/// A rate that is none, messages that cannot be read, more than can be held.
pub fn joined(
    path: &Path,
    bag: &BagReader,
    mut topics: Vec<TopicNumbers>,
    rate_hz: f64,
) -> Result<Table, ExportError> {
    if !(rate_hz > 0.0 && rate_hz <= FASTEST) {
        return Err(ExportError::Rate(rate_hz));
    }
    let (start, end) = bag.bounds().ok_or_else(|| ExportError::Nothing {
        path: path.to_owned(),
    })?;
    let rows = (end.seconds_since(start) * rate_hz + 1e-6) as usize + 1;
    let mut table: Table = vec![Column::new("t_s")];
    // Where the columns of each topic begin.
    let mut places = Vec::new();
    for topic in &topics {
        places.push(table.len());
        let own = topic.columns.iter();
        table.extend(own.map(|name| Column::new(format!("{}.{name}", topic.name))));
    }
    if rows.saturating_mul(table.len()) > MOST_NUMBERS {
        return Err(ExportError::Large {
            rows,
            columns: table.len(),
        });
    }
    let mut newest = vec![f64::NAN; table.len()];
    let names: Vec<String> = topics.iter().map(|own| own.name.clone()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut row = 0;
    let mut until = |table: &mut Table, newest: &mut [f64], at: f64| {
        while row < rows && (row as f64) / rate_hz < at {
            if let Some(time) = newest.first_mut() {
                *time = row as f64 / rate_hz;
            }
            for (column, value) in table.iter_mut().zip(newest.iter()) {
                column.values.push(*value);
            }
            row += 1;
        }
    };
    for message in bag.raw_topics(&names, Time::from_nanos(0))? {
        let message = message?;
        // What is heard at a row's own time counts in that row.
        let at = message.log_time.seconds_since(start);
        until(&mut table, &mut newest, at - 1e-9);
        let known = topics.iter_mut().zip(&places);
        let own = known
            .into_iter()
            .find(|(topic, _)| topic.name == message.topic.name);
        if let Some((topic, &place)) = own {
            let read = topic.read(&message)?.values;
            for (slot, value) in newest.iter_mut().skip(place).zip(read) {
                *slot = value;
            }
        }
    }
    until(&mut table, &mut newest, f64::INFINITY);
    Ok(table)
}

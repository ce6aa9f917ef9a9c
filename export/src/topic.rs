//! The numbers of a topic's messages.

use std::path::Path;

use ferntast_bag::{BagReader, BagTopic, RawMessage};
use ferntast_msgs::Time;

use super::{ExportError, error::nearest, unit::unit_at};
use ferntast_lab::{
    message_path::MessagePath,
    schema::{Found, Layout, Reader, Selection, numeric_paths},
};

/// Reads the numbers out of a topic's messages.
pub struct TopicNumbers {
    /// Its name.
    pub name: String,
    /// The path of each number.
    pub paths: Vec<MessagePath>,
    /// The name of its column: path within the message, and unit.
    pub columns: Vec<String>,
    reader: Reader,
    selections: Vec<Selection>,
    stamp: Option<[Selection; 2]>,
    read: usize,
}

/// What a message says.
pub struct Row {
    /// Its header's stamp \[ns\]; `None` without one, or where it is invalid.
    pub stamp: Option<i64>,
    /// Its numbers; NaN for elements that it has not.
    pub values: Vec<f64>,
}

impl TopicNumbers {
    /// Of a topic of `bag`; `None` where it has no numbers, or is of no type that can be
    /// read.
    pub fn of(bag: &BagReader, topic: &BagTopic) -> Option<TopicNumbers> {
        if topic.message_encoding != "cdr" {
            return None;
        }
        let layout = Layout::of_schema(
            &topic.schema_name,
            &topic.schema_encoding,
            &topic.schema_text,
        )
        .ok()?;
        let first = bag
            .raw_topics(&[topic.name.as_str()], Time::from_nanos(0))
            .ok()
            .and_then(|mut messages| messages.next()?.ok());
        let bytes = first.as_ref().map(RawMessage::bytes);
        let mut reader = Reader::new(layout);
        let names = numeric_paths(&mut reader, &topic.name, bytes);
        let mut numbers = TopicNumbers {
            name: topic.name.clone(),
            paths: Vec::new(),
            columns: Vec::new(),
            selections: Vec::new(),
            stamp: stamp(&topic.name, reader.layout()),
            read: 0,
            reader,
        };
        for name in names {
            let inside = name.strip_prefix(&topic.name).unwrap_or(&name);
            let inside = inside.trim_start_matches('.').to_owned();
            if inside.starts_with("header.") {
                continue;
            }
            let path = MessagePath::parse(&name).ok()?;
            let selection = Selection::new(numbers.reader.layout(), &path).ok()?;
            let unit = unit_at(&topic.schema_name, &topic.schema_text, &path.steps);
            numbers.columns.push(match unit {
                Some(unit) => format!("{inside}_{}", unit.replace(['/', ' '], "_")),
                None => inside,
            });
            numbers.paths.push(path);
            numbers.selections.push(selection);
        }
        (!numbers.paths.is_empty()).then_some(numbers)
    }

    /// Reads the next message.
    ///
    /// # Errors
    ///
    /// It does not fit the type.
    pub fn read(&mut self, message: &RawMessage) -> Result<Row, ExportError> {
        self.read += 1;
        let bytes = message.bytes();
        let mut values = Vec::with_capacity(self.selections.len());
        for selection in &self.selections {
            let found = self.reader.read(bytes, selection);
            let found = found.map_err(|source| ExportError::Decode {
                topic: self.name.clone(),
                message: self.read,
                source,
            })?;
            values.push(match found {
                Found::One(value) => value,
                Found::Nothing(_) | Found::Several(_) => f64::NAN,
            });
        }
        Ok(Row {
            stamp: self.stamp_of(bytes),
            values,
        })
    }

    /// Whether messages have a header with a stamp.
    pub fn is_stamped(&self) -> bool {
        self.stamp.is_some()
    }

    fn stamp_of(&mut self, bytes: &[u8]) -> Option<i64> {
        let [seconds, nanos] = self.stamp.as_ref()?;
        let (Ok(Found::One(seconds)), Ok(Found::One(nanos))) = (
            self.reader.read(bytes, seconds),
            self.reader.read(bytes, nanos),
        ) else {
            return None;
        };
        // Both are whole numbers of at most 32 bits.
        let stamp = seconds as i64 * 1_000_000_000 + nanos as i64;
        (stamp != 0).then_some(stamp)
    }
}

fn stamp(topic: &str, layout: &Layout) -> Option<[Selection; 2]> {
    if layout.field_type("header") != Some("std_msgs/msg/Header") {
        return None;
    }
    let part = |name: &str| {
        let path = MessagePath::parse(&format!("{topic}.header.stamp.{name}")).ok()?;
        Selection::new(layout, &path).ok()
    };
    Some([part("sec")?, part("nanosec")?])
}

/// The topics of `bag` with numbers: all, or those that are named.
///
/// # Errors
///
/// A name that no topic with numbers has; none at all.
pub fn topics_of(
    path: &Path,
    bag: &BagReader,
    wanted: &[String],
) -> Result<Vec<TopicNumbers>, ExportError> {
    let mut found: Vec<TopicNumbers> = Vec::new();
    for topic in bag.topics() {
        if !found.iter().any(|own| own.name == topic.name) {
            found.extend(TopicNumbers::of(bag, topic));
        }
    }
    for name in wanted {
        if !found.iter().any(|own| own.name == *name) {
            let names = found.iter().map(|own| own.name.as_str());
            return Err(ExportError::NoTopic {
                path: path.to_owned(),
                name: name.clone(),
                alike: nearest(name, names),
            });
        }
    }
    if !wanted.is_empty() {
        found.retain(|own| wanted.contains(&own.name));
    }
    match found.is_empty() {
        true => Err(ExportError::Nothing {
            path: path.to_owned(),
        }),
        false => Ok(found),
    }
}

//! Signals out of a rosbag2 directory or MCAP file.

use std::{path::Path, sync::Arc};

use ferntast_bag::{BagReader, BagTopic, Place, RawMessage};
use ferntast_msgs::Time;

use super::{LoadError, Series, Wanted, tally::Tally};
use crate::{
    message_path::MessagePath,
    numbers::numbers_of,
    schema::{Found, Layout, Reader, Selection},
};

/// Stamps and log times further apart than this are of two clocks \[ns\].
const SAME_CLOCK: u64 = 1_000_000_000;

/// One signal while it is read.
struct Signal {
    name: String,
    path: MessagePath,
    samples: Vec<Sample>,
    messages: usize,
    length: Option<u64>,
}

struct Sample {
    /// Header stamp \[ns\]; 0 without one.
    stamp: i64,
    log: i64,
    /// Where its message stands in the recording.
    place: Place,
    value: f64,
}

/// How to read one type of messages.
struct TypeReader {
    topic: Arc<BagTopic>,
    reader: Reader,
    stamp: Option<[Selection; 2]>,
    /// By signal: where its number stands; `None` where it is of another topic.
    selections: Vec<Option<Selection>>,
}

/// Reads the signals `wanted` from the recording at `file`. What should be
/// known of the reading goes to `notes`.
pub(super) fn read(
    file: &Path,
    wanted: &[Wanted],
    notes: &mut Vec<String>,
) -> Result<(Vec<Series>, Tally), LoadError> {
    let mut signals = Vec::new();
    for each in wanted {
        let path = MessagePath::parse(&each.path).map_err(|source| LoadError::Path {
            signal: each.signal.clone(),
            source: Box::new(source),
        })?;
        signals.push(Signal {
            name: each.signal.clone(),
            path,
            samples: Vec::new(),
            messages: 0,
            length: None,
        });
    }
    let bag = BagReader::open(file)?;
    for signal in &signals {
        check(file, &bag, signal)?;
    }
    let topics: Vec<&str> = signals.iter().map(|s| s.path.topic.as_str()).collect();
    let messages = bag
        .raw_topics(&topics, Time::from_nanos(0))
        .map_err(|source| LoadError::Topics {
            path: file.to_owned(),
            source: Box::new(source),
        })?;
    let mut readers: Vec<TypeReader> = Vec::new();
    for message in messages {
        let message = message.map_err(|source| LoadError::Read {
            path: file.to_owned(),
            source: Box::new(source),
        })?;
        let known = readers
            .iter()
            .position(|reader| Arc::ptr_eq(&reader.topic, &message.topic));
        let number = match known {
            Some(number) => number,
            None => {
                readers.push(TypeReader::new(file, &message.topic, &signals, &bag)?);
                readers.len() - 1
            }
        };
        if let Some(reader) = readers.get_mut(number) {
            reader.take(file, &message, &mut signals)?;
        }
    }
    for signal in &signals {
        if signal.samples.is_empty() {
            return Err(nothing(file, &bag, signal));
        }
    }
    let by_log_time = of_two_clocks(&signals);
    if by_log_time {
        notes.push(format!(
            "{}: some signals have no stamps, and the stamps of others are of another clock than the log times: log times are used",
            file.display()
        ));
    }
    let mut tally = Tally::new(file);
    tally.samples = signals.first().map_or(0, |signal| signal.samples.len());
    let all = signals.into_iter().zip(wanted);
    let all = all.map(|(signal, wanted)| series(file, signal, wanted, by_log_time));
    Ok((all.collect::<Result<_, LoadError>>()?, tally))
}

/// That the signal's path leads to a number, before anything is read.
fn check(file: &Path, bag: &BagReader, signal: &Signal) -> Result<(), LoadError> {
    let mut there = bag.topics().filter(|topic| topic.name == signal.path.topic);
    let Some(topic) = there.next() else {
        return Err(LoadError::NoTopic {
            signal: signal.name.clone(),
            file: file.to_owned(),
            topic: signal.path.topic.clone(),
            available: available(bag, &signal.path),
        });
    };
    select(file, topic, signal, bag).map(|_| ())
}

fn layout(file: &Path, topic: &BagTopic, signal: &str) -> Result<Layout, LoadError> {
    let refuse = |source| LoadError::Schema {
        signal: signal.to_owned(),
        topic: topic.name.clone(),
        file: file.to_owned(),
        source: Box::new(source),
    };
    if topic.message_encoding != "cdr" {
        return Err(refuse(crate::schema::SchemaError::NotCdr {
            encoding: topic.message_encoding.clone(),
        }));
    }
    Layout::of_schema(
        &topic.schema_name,
        &topic.schema_encoding,
        &topic.schema_text,
    )
    .map_err(refuse)
}

fn select(
    file: &Path,
    topic: &BagTopic,
    signal: &Signal,
    bag: &BagReader,
) -> Result<(Layout, Selection), LoadError> {
    let layout = layout(file, topic, &signal.name)?;
    match Selection::new(&layout, &signal.path) {
        Ok(selection) => Ok((layout, selection)),
        Err(source) => Err(LoadError::NoNumber {
            signal: signal.name.clone(),
            path: signal.path.to_string(),
            file: file.to_owned(),
            source: Box::new(source),
            available: available(bag, &signal.path),
        }),
    }
}

/// The paths of numbers in the recording that are most like `path`.
fn available(bag: &BagReader, path: &MessagePath) -> Vec<String> {
    let paths = numbers_of(bag);
    crate::nearest(&path.to_string(), paths.iter().map(String::as_str))
}

impl TypeReader {
    fn new(
        file: &Path,
        topic: &Arc<BagTopic>,
        signals: &[Signal],
        bag: &BagReader,
    ) -> Result<TypeReader, LoadError> {
        let mut selections = Vec::new();
        let mut found = None;
        for signal in signals {
            if signal.path.topic == topic.name {
                let (layout, selection) = select(file, topic, signal, bag)?;
                found = Some(layout);
                selections.push(Some(selection));
            } else {
                selections.push(None);
            }
        }
        let layout = match found {
            Some(layout) => layout,
            None => layout(file, topic, "position")?,
        };
        let stamp = stamp_of(&layout);
        Ok(TypeReader {
            topic: topic.clone(),
            reader: Reader::new(layout),
            stamp,
            selections,
        })
    }

    fn take(
        &mut self,
        file: &Path,
        message: &RawMessage,
        signals: &mut [Signal],
    ) -> Result<(), LoadError> {
        let bytes = message.bytes();
        for (signal, selection) in signals.iter_mut().zip(&self.selections) {
            let Some(selection) = selection else {
                continue;
            };
            signal.messages += 1;
            let refuse = |source| LoadError::Decode {
                signal: signal.name.clone(),
                topic: self.topic.name.clone(),
                file: file.to_owned(),
                message: signal.messages,
                source,
            };
            let value = match self.reader.read(bytes, selection).map_err(refuse)? {
                Found::One(value) => value,
                Found::Nothing(length) => {
                    signal.length = signal.length.max(length);
                    continue;
                }
                Found::Several(count) => {
                    return Err(LoadError::Several {
                        signal: signal.name.clone(),
                        path: signal.path.to_string(),
                        file: file.to_owned(),
                        message: signal.messages,
                        count,
                    });
                }
            };
            let mut stamp = 0;
            if let Some([seconds, nanos]) = &self.stamp
                && let (Ok(Found::One(seconds)), Ok(Found::One(nanos))) = (
                    self.reader.read(bytes, seconds),
                    self.reader.read(bytes, nanos),
                )
            {
                // Both are whole numbers of at most 32 bits.
                stamp = (seconds as i64) * 1_000_000_000 + nanos as i64;
            }
            let functions = signal.path.functions.iter();
            signal.samples.push(Sample {
                stamp,
                log: message.log_time.nanos(),
                place: message.place(),
                value: functions.fold(value, |value, function| function.apply(value)),
            });
        }
        Ok(())
    }
}

/// Where the header's stamp stands, seconds and nanoseconds, if the messages
/// begin with a `std_msgs/Header`.
fn stamp_of(layout: &Layout) -> Option<[Selection; 2]> {
    let part = |name: &str| {
        let path = MessagePath::parse(&format!("/t.header.stamp.{name}")).ok()?;
        Selection::new(layout, &path).ok()
    };
    (layout.field_type("header") == Some("std_msgs/msg/Header"))
        .then(|| Some([part("sec")?, part("nanosec")?]))
        .flatten()
}

fn nothing(file: &Path, bag: &BagReader, signal: &Signal) -> LoadError {
    match signal.messages {
        0 => LoadError::Empty {
            signal: signal.name.clone(),
            topic: signal.path.topic.clone(),
            file: file.to_owned(),
        },
        messages => LoadError::Never {
            signal: signal.name.clone(),
            path: signal.path.to_string(),
            file: file.to_owned(),
            messages,
            length: signal.length,
            available: available(bag, &signal.path),
        },
    }
}

/// Whether some signals have only log times while the stamps of others are of
/// another clock (simulated time, for one): then only log times compare.
fn of_two_clocks(signals: &[Signal]) -> bool {
    let stamped = |signal: &Signal| signal.samples.iter().any(|sample| sample.stamp != 0);
    let apart = |signal: &Signal| {
        let sample = signal.samples.iter().find(|sample| sample.stamp != 0);
        sample.is_some_and(|sample| sample.stamp.abs_diff(sample.log) > SAME_CLOCK)
    };
    signals.iter().any(|signal| !stamped(signal)) && signals.iter().any(apart)
}

fn series(
    file: &Path,
    mut signal: Signal,
    wanted: &Wanted,
    by_log_time: bool,
) -> Result<Series, LoadError> {
    // Messages come in the order of their log times. In the order in which they
    // were written it shows whether time ever ran backwards.
    signal.samples.sort_by_key(|sample| sample.place);
    let stamped = !by_log_time && signal.samples.iter().any(|sample| sample.stamp != 0);
    let mut series = Series::new(wanted, file);
    for (index, sample) in signal.samples.iter().enumerate() {
        let time = match (stamped, sample.stamp) {
            // A stamp of zero says that the message is not valid.
            (true, 0) => {
                series.miss(|| format!("message {}", index + 1));
                continue;
            }
            (true, stamp) => stamp,
            (false, _) => sample.log,
        };
        series.push(time, sample.value, || format!("message {}", index + 1))?;
    }
    Ok(series)
}

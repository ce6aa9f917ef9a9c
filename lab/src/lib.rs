//! Recordings against models: what is read, and what is shown.
//!
//! * [`message_path`]: which number of a message is a signal,
//! * [`schema`]: numbers out of messages of whatever type a recording carries,
//! * [`table`]: the same out of columns, whatever the file's format,
//! * [`unit`]: units of signals,
//! * [`guess`]: what names and numbers say of a signal and its unit,
//! * [`joints`]: which joints a recording is about,
//! * [`recording`]: signals put on one time base and cut into sessions,
//! * [`experiment`]: the file that names recordings, signals and model, and
//!   how one came out of another,
//! * [`report`]: a page to look at,
//! * [`work`]: what is done with all that, by command line and page alike.
//!
//! What the data say about a model is the work of `ferntast-identification`.

pub mod experiment;
pub mod guess;
pub mod joints;
pub mod message_path;
mod numbers;
pub mod recording;
pub mod report;
pub mod schema;
pub mod table;
pub mod unit;
pub mod work;

/// Of `names` those most like `wanted`, the most alike first; at most 12.
pub(crate) fn nearest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut rated: Vec<(usize, &str)> = names
        .map(|name| (strsim::damerau_levenshtein(wanted, name), name))
        .collect();
    // Of equals, in the order of the file.
    rated.sort_by_key(|&(distance, _)| distance);
    rated.dedup_by_key(|(_, name)| *name);
    let names = rated.into_iter().take(12).map(|(_, name)| name.to_owned());
    names.collect()
}

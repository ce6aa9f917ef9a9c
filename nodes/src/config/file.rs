//! Finds, reads and checks one file of configuration.

use std::{fs, path::Path};

use ferntast_model::ParameterError;
use serde::de::DeserializeOwned;

use super::{ConfigError, shipped};

/// A kind of configuration file.
pub trait ConfigFile: DeserializeOwned {
    /// What it is called in messages.
    const KIND: &'static str;
    /// Its folder below `config/`.
    const FOLDER: &'static str;

    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, with key, value, bounds, unit.
    fn validate(&self) -> Result<(), ParameterError>;
}

/// Loads the file `name`, shipped or on disk.
///
/// # Errors
///
/// What is wrong, in which file, and how to mend it.
pub fn load<T: ConfigFile>(name: &str) -> Result<T, ConfigError> {
    load_with_path(name).map(|(_, file)| file)
}

/// The same, and where it was found.
pub(super) fn load_with_path<T: ConfigFile>(name: &str) -> Result<(String, T), ConfigError> {
    let Source { path, text } = find(T::KIND, T::FOLDER, name)?;
    let file: T = toml::from_str(&text).map_err(|error| ConfigError::Syntax {
        path: path.clone(),
        message: error.to_string().trim_end().to_owned(),
    })?;
    match file.validate() {
        Ok(()) => Ok((path, file)),
        Err(source) => Err(ConfigError::Value { path, source }),
    }
}

struct Source {
    path: String,
    text: String,
}

fn find(kind: &'static str, folder: &'static str, name: &str) -> Result<Source, ConfigError> {
    let path = Path::new(name);
    let below = format!("{folder}/{name}.toml");
    let on_disk = Path::new("config").join(&below);
    let looks_like_path = name.contains('/') || name.ends_with(".toml");
    let read = |path: &Path| {
        fs::read_to_string(path)
            .map(|text| Source {
                path: path.display().to_string(),
                text,
            })
            .map_err(|source| ConfigError::Read {
                path: path.to_owned(),
                source,
            })
    };
    if looks_like_path {
        return read(path);
    }
    if on_disk.is_file() {
        return read(&on_disk);
    }
    match shipped::text(&below) {
        Some(text) => Ok(Source {
            path: format!("{below} (shipped)"),
            text: text.to_owned(),
        }),
        None => Err(ConfigError::Unknown {
            kind,
            name: name.to_owned(),
            shipped: shipped::names(folder).join(", "),
        }),
    }
}

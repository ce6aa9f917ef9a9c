//! Finds, reads and checks one file of configuration.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ferntast_model::ParameterError;
use serde::de::DeserializeOwned;

use super::{ConfigError, shipped};

/// A kind of configuration file.
#[derive(Clone, Copy, Debug)]
pub struct FileKind {
    /// What it is called in messages.
    pub name: &'static str,
    /// Its folder below `config/`.
    pub folder: &'static str,
}

/// A file of `config/arms/`; the arm's driver says what is in it.
pub const ARM: FileKind = FileKind {
    name: "arm",
    folder: "arms",
};

/// Loads the file `name`, shipped or on disk; `validate` checks its values
/// against their bounds.
///
/// # Errors
///
/// What is wrong, in which file, and how to correct it.
pub fn load<T: DeserializeOwned>(
    kind: FileKind,
    name: &str,
    validate: impl FnOnce(&T) -> Result<(), ParameterError>,
) -> Result<T, ConfigError> {
    load_with_path(kind, name, validate).map(|(_, file)| file)
}

/// The same, and where it was found.
pub(super) fn load_with_path<T: DeserializeOwned>(
    kind: FileKind,
    name: &str,
    validate: impl FnOnce(&T) -> Result<(), ParameterError>,
) -> Result<(String, T), ConfigError> {
    let Source { path, text, .. } = find(kind, name)?;
    let file: T = toml::from_str(&text).map_err(|error| ConfigError::Syntax {
        path: path.clone(),
        message: error.to_string().trim_end().to_owned(),
    })?;
    match validate(&file) {
        Ok(()) => Ok((path, file)),
        Err(source) => Err(ConfigError::Value { path, source }),
    }
}

/// A file that was found.
pub(super) struct Source {
    /// Where, for messages.
    pub(super) path: String,
    /// Its text.
    pub(super) text: String,
    /// The folder that it is in; none of what is shipped.
    pub(super) folder: Option<PathBuf>,
}

/// Finds the file `name`, shipped or on disk.
pub(super) fn find(kind: FileKind, name: &str) -> Result<Source, ConfigError> {
    let path = Path::new(name);
    let folder = kind.folder;
    let below = format!("{folder}/{name}.toml");
    let on_disk = Path::new("config").join(&below);
    let looks_like_path = name.contains('/') || name.ends_with(".toml");
    let read = |path: &Path| {
        fs::read_to_string(path)
            .map(|text| Source {
                path: path.display().to_string(),
                text,
                folder: Some(path.parent().unwrap_or(Path::new("")).to_owned()),
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
            folder: None,
        }),
        None => Err(ConfigError::Unknown {
            kind: kind.name,
            name: name.to_owned(),
            shipped: shipped::names(folder).join(", "),
        }),
    }
}

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

impl FileKind {
    /// Names of those that come along.
    #[must_use]
    pub fn shipped(&self) -> Vec<&'static str> {
        shipped::names(self.name, self.folder)
    }

    /// The same for people, with what is lacking.
    #[must_use]
    pub fn listed(&self) -> String {
        let each = self.shipped().into_iter().map(|name| {
            let below = format!("{}/{name}.toml", self.folder);
            match shipped::text(&below).is_some_and(|text| lacks_urdf(self.folder, text)) {
                true => format!("{name} (without its URDF)"),
                false => name.to_owned(),
            }
        });
        each.collect::<Vec<String>>().join(", ")
    }
}

/// Whether the URDF that an arm's file names does not come along.
fn lacks_urdf(folder: &str, text: &str) -> bool {
    let file = text.parse::<toml::Table>().unwrap_or_default();
    let arm = file.get("arm").and_then(toml::Value::as_table);
    let urdf = arm.and_then(|arm| arm.get("urdf")?.as_str());
    urdf.is_some_and(|urdf| shipped::text(&format!("{folder}/{urdf}")).is_none())
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
            shipped: kind.listed(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_listed_is_of_its_kind_and_says_what_it_lacks() {
        let scenarios = crate::SCENARIO.shipped();
        assert!(scenarios.contains(&"xarm7") && !scenarios.contains(&"delay_sweep"));
        let sweep = FileKind {
            name: "sweep",
            folder: "scenarios",
        };
        assert_eq!(sweep.shipped(), ["delay_sweep"]);
        let campaign = FileKind {
            name: "campaign",
            folder: "experiments",
        };
        assert_eq!(campaign.shipped(), ["mission"]);
        let arms = ARM.listed();
        assert!(arms.contains("kinova, z1 (without its URDF)"), "{arms}");
    }
}

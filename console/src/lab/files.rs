//! What lies in the lab's folder.

use std::{fs, path::Path, time::UNIX_EPOCH};

use ferntast_lab::table::{Format, Table};
use serde::Serialize;

/// Folders are looked into this deep.
const DEPTH: usize = 5;
/// So many entries are listed at most.
const MOST: usize = 2000;

/// What lies in the lab's folder.
#[derive(Debug, Default, Serialize)]
pub struct Listing {
    /// The folder's own name.
    pub folder: String,
    /// Experiment files, recordings and arms, the newest first.
    pub files: Vec<Entry>,
    /// Whether there are more than are listed.
    pub more: bool,
}

/// An experiment file, a recording, or an arm that one can be about.
#[derive(Debug, Serialize)]
pub struct Entry {
    /// Relative to the folder.
    pub path: String,
    /// Which of them.
    pub kind: Kind,
    /// \[bytes\]; of a directory all of its files.
    pub size: u64,
    /// Last change \[s since 1970\].
    pub changed: u64,
}

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A `.toml` that names a recording.
    Experiment,
    /// A rosbag2 directory, `.mcap` or a table.
    Recording,
    /// A `.urdf`.
    Urdf,
}

/// Lists the folder at `root` and those in it.
pub fn list(root: &Path) -> Listing {
    let mut listing = Listing {
        folder: root
            .file_name()
            .unwrap_or(root.as_os_str())
            .to_string_lossy()
            .into_owned(),
        ..Listing::default()
    };
    look_into(root, root, DEPTH, &mut listing);
    listing
        .files
        .sort_by(|a, b| b.changed.cmp(&a.changed).then_with(|| a.path.cmp(&b.path)));
    listing
}

fn look_into(root: &Path, folder: &Path, depth: usize, listing: &mut Listing) {
    // What cannot be read is not there.
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        if listing.files.len() >= MOST {
            listing.more = true;
            return;
        }
        let path = entry.path();
        let name = entry.file_name();
        let hidden = name.to_string_lossy().starts_with('.');
        // Links are not followed: they may lead anywhere.
        let Ok(data) = entry.metadata() else {
            continue;
        };
        if hidden || data.is_symlink() {
            continue;
        }
        let kind = match data.is_dir() {
            true if path.join("metadata.yaml").is_file() => Some(Kind::Recording),
            true => {
                if depth > 0 && name != "target" && name != "node_modules" {
                    look_into(root, &path, depth - 1, listing);
                }
                None
            }
            false => kind_of(&path),
        };
        let Some(kind) = kind else {
            continue;
        };
        let changed = data.modified().ok();
        let changed = changed.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        listing.files.push(Entry {
            path: path
                .strip_prefix(root)
                .unwrap_or(&path)
                .display()
                .to_string(),
            kind,
            size: match data.is_dir() {
                true => size_of(&path),
                false => data.len(),
            },
            changed: changed.map_or(0, |since| since.as_secs()),
        });
    }
}

fn kind_of(path: &Path) -> Option<Kind> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "mcap" => Some(Kind::Recording),
        "urdf" => Some(Kind::Urdf),
        // Words, too, lie in files of that ending.
        "txt" | "dat" => {
            let table = Table::open(path, &[]).ok()?;
            (table.columns().len() > 1).then_some(Kind::Recording)
        }
        _ if Format::of(path).is_some() => Some(Kind::Recording),
        // Other programs have files of that ending, too.
        "toml" => {
            let text = fs::read_to_string(path).ok()?;
            let has = |key: &str| text.lines().any(|line| line.trim_start().starts_with(key));
            (has("recording") && has("[signals]") && has("[model]")).then_some(Kind::Experiment)
        }
        _ => None,
    }
}

fn size_of(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| entry.metadata().ok())
        .map(|data| data.len())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn experiments_and_recordings_are_listed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir_all(root.join("a/bag")).unwrap();
        fs::write(root.join("a/bag/metadata.yaml"), "x").unwrap();
        fs::write(root.join("a/bag/bag_0.mcap"), [0; 99]).unwrap();
        fs::write(root.join("a/x.csv"), "t_s\n").unwrap();
        fs::write(root.join("a/y.txt"), "0 1 2\n1 2 3\n").unwrap();
        fs::write(root.join("notes.txt"), "The bench was cold.\nMore oil.\n").unwrap();
        fs::write(root.join("Cargo.toml"), "[package]").unwrap();
        fs::write(root.join("two.urdf"), "<robot name=\"two\"/>").unwrap();
        fs::write(
            root.join("e.toml"),
            "recording = \"a/x.csv\"\n[signals]\n[model]\n",
        )
        .unwrap();
        fs::write(root.join(".hidden.csv"), "").unwrap();
        let listing = list(root);
        let mut found: Vec<_> = listing
            .files
            .iter()
            .map(|f| (f.path.as_str(), f.kind, f.size))
            .collect();
        found.sort_by_key(|entry| entry.0);
        assert_eq!(
            found,
            [
                ("a/bag", Kind::Recording, 100),
                ("a/x.csv", Kind::Recording, 4),
                ("a/y.txt", Kind::Recording, 12),
                ("e.toml", Kind::Experiment, 40),
                ("two.urdf", Kind::Urdf, 19),
            ]
        );
    }
}

//! The keys of this host and of those that it knows: a folder with two files of text,
//! `private_key`, and `known_hosts` with a name and a public key a line.

use std::{
    fs::{self, OpenOptions},
    io::{self, Write},
    os::unix::fs::{DirBuilderExt, OpenOptionsExt, PermissionsExt},
    path::{Path, PathBuf},
};

use ferntast_seal::{KeyError, PrivateKey, PublicKey};

/// Names the folder with the keys; else the user's configuration has it.
pub const FOLDER_VARIABLE: &str = "FERNTAST_LINK_KEYS";
const PRIVATE: &str = "private_key";
const KNOWN: &str = "known_hosts";

/// Why an end of the link has no keys.
#[derive(Debug, thiserror::Error)]
pub enum LinkKeyError {
    /// There is no folder for them.
    #[error("there is no folder for keys: set HOME, or {FOLDER_VARIABLE} to a folder")]
    NoFolder,
    /// A file cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// Others may read the private key.
    #[error(
        "{path} can be read by others: run 'chmod 600 {path}', and make a new key if anybody did"
    )]
    Open {
        /// The file.
        path: PathBuf,
    },
    /// What should be a key is none.
    #[error("{place}: {source}")]
    Key {
        /// File and line, or what was given.
        place: String,
        /// What is wrong with it.
        source: KeyError,
    },
    /// A line that is not a name and a key.
    #[error(
        "{path}, line {line}: not 'NAME KEY'; 'ferntast link keys add NAME KEY' writes such lines"
    )]
    Line {
        /// The file.
        path: PathBuf,
        /// From 1.
        line: usize,
    },
    /// There is no key, and the link leaves this host.
    #[error(
        "the link goes beyond this host ({endpoint}), and this host has no key in {folder}: run 'ferntast link keys new' \
         on both hosts, then on each 'ferntast link keys add NAME KEY' with what the other shows"
    )]
    NoKey {
        /// The link's endpoint.
        endpoint: String,
        /// Where keys are looked for.
        folder: PathBuf,
    },
    /// No other host is known.
    #[error(
        "the link goes beyond this host ({endpoint}), and {folder} knows no other: run 'ferntast link keys add NAME KEY' \
         with the key that 'ferntast link keys show' says on the other host"
    )]
    NobodyKnown {
        /// The link's endpoint.
        endpoint: String,
        /// Where keys are looked for.
        folder: PathBuf,
    },
    /// Several are known, or none of that name.
    #[error("which arm is to be operated? give --link-peer with one of: {known}")]
    WhichPeer {
        /// Names of those that are known.
        known: String,
    },
    /// The private key is there already.
    #[error("a private key is there already; remove {path} first, if it is to be replaced")]
    Exists {
        /// Where.
        path: PathBuf,
    },
    /// A host of that name is known already.
    #[error(
        "host {name:?} is known already; take line {line} out of {path} first, if its key is to be replaced"
    )]
    Known {
        /// The host.
        name: String,
        /// The file.
        path: PathBuf,
        /// Where in it, from 1.
        line: usize,
    },
    /// A name that cannot stand in the file.
    #[error("host name {0:?}: use 1 to 64 letters, digits, '-', '_' or '.'")]
    Name(String),
    /// The system has no random numbers.
    #[error("no random numbers from the system: {0}")]
    Random(String),
}

/// The keys of a host.
#[derive(Clone, Debug)]
pub struct LinkKeys {
    folder: PathBuf,
}

impl LinkKeys {
    /// Those of `folder`; without one of the folder that [`FOLDER_VARIABLE`] names, or
    /// of the user's configuration.
    ///
    /// # Errors
    ///
    /// [`LinkKeyError::NoFolder`].
    pub fn of(folder: Option<PathBuf>) -> Result<LinkKeys, LinkKeyError> {
        let variable = |name| std::env::var_os(name).map(PathBuf::from);
        let configuration = || {
            variable("XDG_CONFIG_HOME").or_else(|| variable("HOME").map(|own| own.join(".config")))
        };
        folder
            .or_else(|| variable(FOLDER_VARIABLE))
            .or_else(|| configuration().map(|own| own.join("ferntast").join("link")))
            .map(|folder| LinkKeys { folder })
            .ok_or(LinkKeyError::NoFolder)
    }

    /// Where they are.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// This host's own; `None` when it has none.
    ///
    /// # Errors
    ///
    /// A file that others may read, or that holds no key.
    pub fn own(&self) -> Result<Option<PrivateKey>, LinkKeyError> {
        let path = self.folder.join(PRIVATE);
        let Some(text) = read(&path)? else {
            return Ok(None);
        };
        let mode = fs::metadata(&path).map_err(file(&path))?.permissions();
        if mode.mode() & 0o077 != 0 {
            return Err(LinkKeyError::Open { path });
        }
        PrivateKey::from_text(&text)
            .map(Some)
            .map_err(|source| LinkKeyError::Key {
                place: path.display().to_string(),
                source,
            })
    }

    /// Makes this host's own.
    ///
    /// # Errors
    ///
    /// There is one; a file that cannot be written.
    pub fn make(&self) -> Result<PrivateKey, LinkKeyError> {
        self.make_folder()?;
        let key = PrivateKey::from_random(random()?);
        let path = self.folder.join(PRIVATE);
        // Whole or not at all, and never over another: two ends may start at once.
        let draft = self
            .folder
            .join(format!("{PRIVATE}.{}", std::process::id()));
        let written = OpenOptions::new()
            .write(true)
            .create_new(true)
            .mode(0o600)
            .open(&draft)
            .and_then(|mut file| writeln!(file, "{}", key.to_text()))
            .and_then(|()| fs::hard_link(&draft, &path));
        // The draft is ours; where it was not made there is nothing to remove.
        let _ = fs::remove_file(&draft);
        match written {
            Ok(()) => Ok(key),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                Err(LinkKeyError::Exists { path })
            }
            Err(error) => Err(file(&path)(error)),
        }
    }

    /// Hosts that are known, by name.
    ///
    /// # Errors
    ///
    /// A line that is none.
    pub fn known(&self) -> Result<Vec<(String, PublicKey)>, LinkKeyError> {
        let known = self.known_by_line()?.into_iter();
        Ok(known.map(|(_, name, key)| (name, key)).collect())
    }

    /// The same, each with its line in the file, from 1.
    fn known_by_line(&self) -> Result<Vec<(usize, String, PublicKey)>, LinkKeyError> {
        let path = self.folder.join(KNOWN);
        let text = read(&path)?.unwrap_or_default();
        let mut known = Vec::new();
        for (line, words) in (1..).zip(text.lines()) {
            let words: Vec<&str> = words.split_whitespace().collect();
            match words[..] {
                [] => {}
                [first, ..] if first.starts_with('#') => {}
                [name, key] => {
                    let key = PublicKey::from_text(key).map_err(|source| LinkKeyError::Key {
                        place: format!("{}, line {line}", path.display()),
                        source,
                    })?;
                    known.push((line, name.to_owned(), key));
                }
                _ => return Err(LinkKeyError::Line { path, line }),
            }
        }
        Ok(known)
    }

    /// Adds a host.
    ///
    /// # Errors
    ///
    /// A name that is taken or cannot be used, no key, a file that cannot be written.
    pub fn add(&self, name: &str, key: &str) -> Result<PublicKey, LinkKeyError> {
        let allowed = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        if name.is_empty() || name.len() > 64 || !name.chars().all(allowed) {
            return Err(LinkKeyError::Name(name.to_owned()));
        }
        let key = PublicKey::from_text(key).map_err(|source| LinkKeyError::Key {
            place: key.to_owned(),
            source,
        })?;
        let path = self.folder.join(KNOWN);
        let known = self.known_by_line()?;
        if let Some((line, ..)) = known.iter().find(|(_, own, _)| own == name) {
            return Err(LinkKeyError::Known {
                name: name.to_owned(),
                path,
                line: *line,
            });
        }
        self.make_folder()?;
        OpenOptions::new()
            .append(true)
            .create(true)
            .mode(0o600)
            .open(&path)
            .and_then(|mut file| writeln!(file, "{name} {key}"))
            .map_err(file(&path))?;
        Ok(key)
    }

    fn make_folder(&self) -> Result<(), LinkKeyError> {
        fs::DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(&self.folder)
            .map_err(file(&self.folder))
    }
}

/// 32 bytes of the system's randomness.
pub(super) fn random() -> Result<[u8; 32], LinkKeyError> {
    let mut bytes = [0; 32];
    getrandom::fill(&mut bytes).map_err(|error| LinkKeyError::Random(error.to_string()))?;
    Ok(bytes)
}

fn read(path: &Path) -> Result<Option<String>, LinkKeyError> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(file(path)(error)),
    }
}

fn file(path: &Path) -> impl Fn(io::Error) -> LinkKeyError {
    let path = path.to_owned();
    move |source| LinkKeyError::File {
        path: path.clone(),
        source,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A folder that goes with the test.
    pub struct Folder(PathBuf);

    impl Folder {
        pub fn keys(name: &str) -> (Folder, LinkKeys) {
            let folder =
                std::env::temp_dir().join(format!("ferntast-keys-{}-{name}", std::process::id()));
            let keys = LinkKeys {
                folder: folder.clone(),
            };
            (Folder(folder), keys)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn known_hosts_are_added_once() {
        let (_folder, keys) = Folder::keys("known");
        keys.make().unwrap();
        assert!(matches!(keys.make(), Err(LinkKeyError::Exists { .. })));
        let other = |number| PrivateKey::from_random([number; 32]).public();
        keys.add("arm", &other(1).to_string()).unwrap();
        let known = keys.add("arm", &other(2).to_string()).unwrap_err();
        assert!(matches!(&known, LinkKeyError::Known { name, line: 1, .. } if name == "arm"));
        assert!(known.to_string().contains("take line 1 out of"), "{known}");
        assert!(matches!(
            keys.add("a b", &other(2).to_string()),
            Err(LinkKeyError::Name(_))
        ));
        assert!(matches!(
            keys.add("other", "nonsense"),
            Err(LinkKeyError::Key { .. })
        ));
        assert_eq!(keys.known().unwrap(), [("arm".to_owned(), other(1))]);
    }

    #[test]
    fn a_key_that_others_may_read_is_not_used() {
        let (_folder, keys) = Folder::keys("open");
        keys.make().unwrap();
        let path = keys.folder().join(PRIVATE);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).unwrap();
        let error = keys.own().unwrap_err();
        assert!(error.to_string().contains("chmod 600"), "{error}");
    }
}

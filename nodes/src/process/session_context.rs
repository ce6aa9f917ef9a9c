//! What every process of a session needs to know.

use std::{
    fs,
    io::Write,
    net::SocketAddr,
    os::unix::fs::OpenOptionsExt,
    path::{Path, PathBuf},
};

use ferntast_config::Loaded;
use ferntast_control::planted::Planted;
use ferntast_msgs::sample::JointNames;
use serde::{Deserialize, Serialize};

use super::{Clock, End, link_end::LinkAccess};

/// What every process of a session needs to know. The supervisor writes it to
/// a file; each node reads that.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SessionContext {
    /// The session's name: shared memory and link keys carry it.
    pub session: String,
    /// UNIX time minus monotonic time \[ns\], the same in all processes.
    pub clock_offset_nanos: i64,
    /// The scenario with all that it names.
    #[serde(with = "ferntast_config::json")]
    pub loaded: Loaded,
    /// Folder of the recording to be written, or to be played.
    pub bag: Option<PathBuf>,
    /// How to play a recording.
    pub play: PlayOptions,
    /// Experiments whose models are held against the arm, one for a joint at most.
    pub twins: Vec<PathBuf>,
    /// The page; `None` without one.
    pub console: Option<ConsoleOptions>,
    /// Where the topics are shown to Foxglove; `None` without that.
    pub foxglove: Option<SocketAddr>,
    /// Which driver the arm's node has, as `--driver` has it; that of the arm's file, or
    /// the simulated one, without.
    #[serde(default)]
    pub driver: Option<String>,
    /// The end of the link that runs here; `None` for both.
    #[serde(default)]
    pub end: Option<End>,
    /// Whose frames the ends of the link take.
    pub link_access: LinkAccess,
    /// A safety rule that is taken out; in virtual time only, and only in builds for
    /// tests.
    #[serde(skip)]
    pub planted: Planted,
}

/// Where the page is served.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConsoleOptions {
    /// Address and port; `None` for the first free port of the loopback from 8080 on.
    pub listen: Option<SocketAddr>,
    /// What pages have to show.
    pub token: Option<String>,
}

/// How to play a recording.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlayOptions {
    /// Speed relative to the recording.
    pub rate: f64,
    /// Begin again at the end.
    pub repeat: bool,
    /// Whether a live estimator publishes in place of the recording.
    pub estimate: bool,
    /// Topics that are not played, because a live node publishes them.
    pub except: Vec<String>,
    /// The joints of the recording, where it says which.
    pub joints: Option<JointNames>,
}

impl Default for PlayOptions {
    fn default() -> Self {
        PlayOptions {
            rate: 1.0,
            repeat: false,
            estimate: false,
            except: Vec::new(),
            joints: None,
        }
    }
}

/// Why a session's file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ContextError {
    /// The file cannot be read or written.
    #[error("session file {path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The file is not what the supervisor writes.
    #[error("session file {path} is not one of this version of ferntast: {source}")]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// The name cannot be part of a file name and a key.
    #[error("session name {0:?}: use 1 to 32 letters, digits, '-' or '_'")]
    Name(String),
}

impl SessionContext {
    /// A context for a session of that name.
    ///
    /// # Errors
    ///
    /// A name that cannot be used.
    pub fn new(session: &str, loaded: Loaded) -> Result<SessionContext, ContextError> {
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if session.is_empty() || session.len() > 32 || !session.chars().all(allowed) {
            return Err(ContextError::Name(session.to_owned()));
        }
        Ok(SessionContext {
            session: session.to_owned(),
            clock_offset_nanos: Clock::start().offset_nanos(),
            ..SessionContext::in_virtual_time(loaded)
        })
    }

    /// A context in virtual time, for which no clock is read.
    pub fn in_virtual_time(loaded: Loaded) -> SessionContext {
        SessionContext {
            session: "lockstep".to_owned(),
            clock_offset_nanos: 0,
            loaded,
            bag: None,
            play: PlayOptions::default(),
            console: None,
            foxglove: None,
            twins: Vec::new(),
            driver: None,
            end: None,
            link_access: LinkAccess::default(),
            planted: Planted::NONE,
        }
    }

    /// The joints that there are topics of: those of the arm, in a playback
    /// those of the recording.
    pub fn joints(&self) -> JointNames {
        let recorded = self.play.joints;
        recorded.unwrap_or_else(|| self.loaded.arm.model.joint_names())
    }

    /// The session's clock.
    pub fn clock(&self) -> Clock {
        Clock::with_offset(self.clock_offset_nanos)
    }

    /// Reads the context that the supervisor wrote.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or understood.
    pub fn read(path: &Path) -> Result<SessionContext, ContextError> {
        let text = fs::read_to_string(path).map_err(|source| ContextError::File {
            path: path.to_owned(),
            source,
        })?;
        serde_json::from_str(&text).map_err(|source| ContextError::Content {
            path: path.to_owned(),
            source,
        })
    }

    /// Writes the context for the nodes, for the eyes of this user alone.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), ContextError> {
        let file_error = |source| ContextError::File {
            path: path.to_owned(),
            source,
        };
        let text = serde_json::to_string_pretty(self).map_err(|source| ContextError::Content {
            path: path.to_owned(),
            source,
        })?;
        // For this user alone, whatever was there before.
        let part = path.with_extension("part");
        match fs::remove_file(&part) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(file_error(error));
            }
            _ => {}
        }
        let mut options = fs::OpenOptions::new();
        let opened = options.write(true).create_new(true).mode(0o600).open(&part);
        opened
            .and_then(|mut file| file.write_all(text.as_bytes()))
            .and_then(|()| fs::rename(&part, path))
            .map_err(file_error)
    }
}

//! Sessions: where each keeps its shared memory, who is in it, and how to
//! remove what a dead one left.

use std::{ffi::CString, fs, io, os::unix::fs::MetadataExt, path::Path, time::Duration};

use iceoryx2::{
    config::Config,
    node::{Node, NodeState, NodeView},
    prelude::{CallbackProgression, FileName, Path as IoxPath, SemanticString},
};

use super::{MAX_PUBLISHERS, Service};
use crate::error::{CleanUpError, OpenError};

/// Longest session name \[byte\].
const MAX_NAME: usize = 48;

/// Where Linux shows POSIX shared memory as files.
const SHARED_MEMORY: &str = "/dev/shm";

/// Name of the nodes that only visit a session.
pub(super) const VISITOR: &str = "visitor";

/// Directory of a session's management files: in memory, too, since every one of
/// them is brought to the disk before anybody goes on, which takes long where
/// the disk is busy.
pub(super) fn directory(session: &str) -> String {
    format!("{SHARED_MEMORY}/ferntast.{session}")
}

/// What the names of all of a session's segments begin with. A session's name
/// holds no dot, so no session's prefix begins another's.
fn prefix(session: &str) -> String {
    format!("ferntast.{session}.")
}

/// The settings under which a session's processes meet, and others do not.
pub(super) fn config(session: &str) -> Result<Config, OpenError> {
    let bad_name = |reason: &str| OpenError::BadName {
        what: "session",
        name: session.into(),
        reason: reason.into(),
    };
    let allowed = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    if session.is_empty() || session.len() > MAX_NAME || !session.bytes().all(allowed) {
        return Err(bad_name("use 1 to 48 of a-z, A-Z, 0-9, - and _"));
    }
    let mut config = Config::default();
    config.global.prefix = FileName::new(prefix(session).as_bytes())
        .map_err(|error| bad_name(&format!("{error:?}")))?;
    let root = IoxPath::new(directory(session).as_bytes())
        .map_err(|error| bad_name(&format!("{error:?}")))?;
    config.global.set_root_path(&root);
    // A subscriber looks at this many places more each time that it asks whether something
    // came; what publishers that ended have left fills no more than this.
    config
        .defaults
        .publish_subscribe
        .subscriber_expired_connection_buffer = MAX_PUBLISHERS;
    Ok(config)
}

/// Whether the session has a directory, in use or left behind.
pub(super) fn is_there(session: &str) -> bool {
    Path::new(&directory(session)).is_dir()
}

/// Whether the session's directory, where there is one, can be used: anybody
/// may have put something there under its name.
pub(super) fn check_access(session: &str) -> Result<(), OpenError> {
    let path = directory(session);
    if let Ok(found) = fs::symlink_metadata(&path) {
        // SAFETY: geteuid cannot fail.
        let user = unsafe { libc::geteuid() };
        let reason = match () {
            () if !found.is_dir() => Some("it is not a directory".to_owned()),
            () if found.uid() != user => Some(format!(
                "it belongs to another user (number {}, you are {user})",
                found.uid()
            )),
            () if found.mode() & 0o022 != 0 => Some("others may write into it".to_owned()),
            () => None,
        };
        if let Some(reason) = reason {
            return Err(OpenError::NoPermission { path, reason });
        }
    }
    let Ok(text) = CString::new(path.as_str()) else {
        // A session's name holds no zero byte.
        return Ok(());
    };
    // SAFETY: the path ends in a zero byte and lives through the call.
    let denied = unsafe { libc::access(text.as_ptr(), libc::R_OK | libc::W_OK | libc::X_OK) } != 0;
    let error = io::Error::last_os_error();
    if denied && error.kind() == io::ErrorKind::PermissionDenied {
        return Err(OpenError::NoPermission {
            path,
            reason: error.to_string(),
        });
    }
    Ok(())
}

/// The sessions that have a directory, in use or left behind; sorted.
pub(super) fn sessions() -> Vec<String> {
    let Ok(entries) = fs::read_dir(SHARED_MEMORY) else {
        return Vec::new();
    };
    let mut sessions: Vec<String> = entries
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name();
            let session = name.to_str()?.strip_prefix("ferntast.")?;
            config(session).is_ok().then(|| session.to_owned())
        })
        .collect();
    sessions.sort();
    sessions
}

/// The processes that are in the session now, by id, sorted; this one too when it is.
pub(super) fn processes(session: &str) -> Result<Vec<u32>, OpenError> {
    list(session, |_| true)
}

/// The same without visitors.
pub(super) fn members(session: &str) -> Result<Vec<u32>, OpenError> {
    list(session, |name| name != VISITOR)
}

/// The processes of nodes whose name counts.
fn list(session: &str, counts: impl Fn(&str) -> bool) -> Result<Vec<u32>, OpenError> {
    let config = config(session)?;
    check_access(session)?;
    if !Path::new(&directory(session)).exists() {
        return Ok(Vec::new());
    }
    let mut processes = Vec::new();
    Node::<Service>::list(&config, |state| {
        // A node whose state cannot be read belongs to somebody: alive.
        let id = match &state {
            NodeState::Alive(node) => {
                let name = node.details().as_ref().map(|details| details.name());
                let counted = name.is_none_or(|name| counts(name.as_str()));
                counted.then(|| *node.id())
            }
            NodeState::Inaccessible(id) => Some(*id),
            NodeState::Dead(_) | NodeState::Undefined(_) => None,
        };
        if let Some(Ok(process)) = id.map(|id| id.pid::<Service>()) {
            processes.push(process.value() as u32);
        }
        CallbackProgression::Continue
    })
    .map_err(|error| OpenError::Middleware {
        transport: "shared memory",
        reason: format!("listing the processes of session {session:?} failed: {error}"),
    })?;
    processes.sort_unstable();
    processes.dedup();
    Ok(processes)
}

/// Removes everything that a dead session left; see
/// [`SharedMemoryBus::clean_up`](super::SharedMemoryBus::clean_up).
pub(super) fn clean_up(session: &str) -> Result<usize, CleanUpError> {
    let members = members(session)?;
    if !members.is_empty() {
        return Err(CleanUpError::InUse {
            session: session.into(),
            processes: members,
        });
    }
    if !processes(session)?.is_empty() {
        return Ok(0);
    }
    let directory = directory(session);
    let mut removed = count_files(Path::new(&directory));
    removed += remove_segments(&prefix(session))?;
    match fs::remove_dir_all(&directory) {
        Ok(()) => Ok(removed),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(removed),
        Err(error) => Err(CleanUpError::Directory {
            path: directory,
            reason: error.to_string(),
        }),
    }
}

/// Removes the segments of processes that died, while others of the session live on.
pub(super) fn remove_dead(config: &Config) {
    let list = Node::<Service>::list(config, |state| {
        if let NodeState::Dead(node) = state {
            // Whatever stays behind, the next one to open the session or
            // `clean_up` removes.
            let _ = node.blocking_remove_stale_resources(Duration::from_millis(100));
        }
        CallbackProgression::Continue
    });
    // A list that cannot be read means nothing to remove for us.
    let _ = list;
}

fn count_files(directory: &Path) -> usize {
    let Ok(entries) = fs::read_dir(directory) else {
        return 0;
    };
    entries
        .flatten()
        .map(|entry| match entry.file_type() {
            Ok(kind) if kind.is_dir() => count_files(&entry.path()),
            _ => 1,
        })
        .sum()
}

fn remove_segments(prefix: &str) -> Result<usize, CleanUpError> {
    let failed = |path: &Path, error: io::Error| CleanUpError::Directory {
        path: path.display().to_string(),
        reason: error.to_string(),
    };
    let shared_memory = Path::new(SHARED_MEMORY);
    let mut removed = 0;
    for entry in fs::read_dir(shared_memory).map_err(|error| failed(shared_memory, error))? {
        let path = entry.map_err(|error| failed(shared_memory, error))?.path();
        let is_ours = path
            .file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with(prefix));
        if !is_ours {
            continue;
        }
        match fs::remove_file(&path) {
            Ok(()) => removed += 1,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(failed(&path, error)),
        }
    }
    Ok(removed)
}

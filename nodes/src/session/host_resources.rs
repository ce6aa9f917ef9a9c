//! What a session holds on this host: its shared memory and its file.

use std::{fs, path::PathBuf};

use ferntast_bus::SharedMemoryBus;

use super::SessionError;
use crate::process::SessionContext;

/// Folder for the files of the sessions of this user.
pub fn runtime_folder() -> PathBuf {
    match std::env::var_os("XDG_RUNTIME_DIR") {
        Some(folder) => PathBuf::from(folder).join("ferntast"),
        // SAFETY: getuid cannot fail.
        None => std::env::temp_dir().join(format!("ferntast-{}", unsafe { libc::getuid() })),
    }
}

/// The shared memory and the file of a session. Every way out of the session
/// frees them: to be made before, and so dropped after, all that uses the
/// shared memory.
pub struct HostResources {
    session: String,
    folder: PathBuf,
    /// What the nodes read.
    pub session_file: PathBuf,
}

impl HostResources {
    /// Takes what the session of `context` needs and writes its file. What a
    /// session of the same name left behind when it was killed is removed.
    ///
    /// # Errors
    ///
    /// A session of that name runs; its file cannot be written.
    pub fn acquire(context: &SessionContext) -> Result<HostResources, SessionError> {
        SharedMemoryBus::clean_up(&context.session)?;
        let folder = runtime_folder().join(&context.session);
        fs::create_dir_all(&folder).map_err(|source| SessionError::Folder {
            path: folder.clone(),
            source,
        })?;
        let resources = HostResources {
            session: context.session.clone(),
            session_file: folder.join("session.json"),
            folder,
        };
        context.write(&resources.session_file)?;
        Ok(resources)
    }

    /// Frees them.
    ///
    /// # Errors
    ///
    /// Shared memory that is still in use.
    pub fn release(self) -> Result<(), SessionError> {
        SharedMemoryBus::clean_up(&self.session)?;
        // The folder goes when `self` is dropped.
        Ok(())
    }
}

impl Drop for HostResources {
    fn drop(&mut self) {
        // Nothing can be said here any more, and the next session of this
        // name tries again.
        let _ = SharedMemoryBus::clean_up(&self.session);
        let _ = fs::remove_dir_all(&self.folder);
    }
}

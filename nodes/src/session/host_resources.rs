//! What a session holds on this host: its name, its shared memory and its file.

use std::{
    env,
    fs::{self, File, TryLockError},
    io,
    os::unix::fs::MetadataExt,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use ferntast_bus::{Bus, CleanUpError, OpenError, SharedMemoryBus};

use super::{SessionError, private_folder};
use crate::process::SessionContext;

/// How long a name that is taken is waited for: a visitor that tidies up holds
/// it for some milliseconds.
const NAME_PATIENCE: Duration = Duration::from_secs(1);

/// Folder for the files of the sessions of this user: in `XDG_RUNTIME_DIR`,
/// which is nobody else's; where there is none a folder in the temporary one.
pub fn runtime_folder() -> PathBuf {
    let runtime = env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    match runtime.filter(|folder| folder.is_absolute() && folder.is_dir()) {
        Some(folder) => folder.join("ferntast"),
        None => env::temp_dir().join(format!("ferntast-{}", private_folder::user())),
    }
}

/// Makes the folder of the session of that name, for this user alone.
fn session_folder(session: &str) -> Result<PathBuf, SessionError> {
    let runtime = runtime_folder();
    private_folder::make(&runtime)?;
    let folder = runtime.join(session);
    private_folder::make(&folder)?;
    Ok(folder)
}

/// A lock on a session's name, which the system gives free when the process ends.
struct NameLock {
    _file: File,
}

impl NameLock {
    /// Takes it; `None` where another process has it.
    fn take(session: &str) -> Result<Option<(NameLock, PathBuf)>, SessionError> {
        loop {
            let folder = session_folder(session)?;
            let path = folder.join("lock");
            let failed = |source: io::Error| SessionError::Folder {
                path: path.clone(),
                source,
            };
            let file = match File::create(&path) {
                // The folder went with the session that had it.
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                opened => opened.map_err(failed)?,
            };
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Ok(None),
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
            // Who had it before may have removed the file that is locked now.
            let locked = file.metadata().map_err(failed)?;
            let is_there = |there: fs::Metadata| (there.dev(), there.ino());
            if fs::metadata(&path).ok().map(is_there) == Some(is_there(locked)) {
                return Ok(Some((NameLock { _file: file }, folder)));
            }
        }
    }
}

/// Name, shared memory and file of a session. Every way out of the session
/// frees them: to be made before, and so dropped after, all that uses the
/// shared memory.
pub struct HostResources {
    session: String,
    folder: PathBuf,
    _name: NameLock,
    /// What the nodes read.
    pub session_file: PathBuf,
}

impl HostResources {
    /// Takes what the session of `context` needs and writes its file. What a
    /// session of the same name left behind when it was killed is removed;
    /// visitors ([`Visit`]) are no hindrance.
    ///
    /// # Errors
    ///
    /// A session of that name runs; its file cannot be written.
    pub fn acquire(context: &SessionContext) -> Result<HostResources, SessionError> {
        let session = &context.session;
        let given_up = Instant::now() + NAME_PATIENCE;
        let taken = loop {
            match NameLock::take(session)? {
                None if Instant::now() < given_up => thread::sleep(Duration::from_millis(20)),
                taken => break taken,
            }
        };
        let Some((name, folder)) = taken else {
            return Err(SessionError::Taken(CleanUpError::InUse {
                session: session.clone(),
                processes: SharedMemoryBus::members(session).unwrap_or_default(),
            }));
        };
        SharedMemoryBus::clean_up(session)?;
        let resources = HostResources {
            session: session.clone(),
            session_file: folder.join("session.json"),
            folder,
            _name: name,
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
        remove(&self.folder);
    }
}

/// Removes a session's folder, while its lock is held.
fn remove(folder: &Path) {
    // What stays is taken by the next session of that name.
    let _ = fs::remove_dir_all(folder);
}

/// A command's look into a session that others run. It keeps no session from
/// starting or ending, and leaves nothing behind.
pub struct Visit {
    session: String,
    bus: Option<Bus>,
}

impl Visit {
    /// Joins the session; `None` where none of that name is on this host.
    ///
    /// # Errors
    ///
    /// [`OpenError`].
    pub fn open(session: &str) -> Result<Option<Visit>, OpenError> {
        let bus = SharedMemoryBus::visit(session)?;
        Ok(bus.map(|bus| Visit {
            session: session.to_owned(),
            bus: Some(Bus::SharedMemory(bus)),
        }))
    }

    /// The session's bus.
    pub fn bus(&self) -> Option<&Bus> {
        self.bus.as_ref()
    }
}

impl Drop for Visit {
    fn drop(&mut self) {
        self.bus = None;
        // Where no session runs, this was the only process in what a dead one
        // left; where one runs, it has the lock.
        if let Ok(Some((_name, folder))) = NameLock::take(&self.session) {
            let _ = SharedMemoryBus::clean_up(&self.session);
            remove(&folder);
        }
    }
}

//! A session apart from every other on this machine.

use std::{
    fs, io,
    path::{Path, PathBuf},
    process::{self, Command},
    sync::atomic::{AtomicU32, Ordering},
    thread,
    time::Duration,
};

use tempfile::TempDir;

use crate::{
    deadline::wait_until,
    domain::Domain,
    places::{ferntast, peer, python},
    ports::free_tcp_port,
    room::Room,
};

/// What a sourced ROS installation, or our own Python, may have put into the environment.
const FOREIGN: [&str; 12] = [
    "_ROS_WHEELS_BOOTSTRAP_COMPLETE",
    "AMENT_PREFIX_PATH",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "LD_LIBRARY_PATH",
    "PYTHONPATH",
    "RMW_IMPLEMENTATION",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_DISCOVERY_SERVER",
    "ROS_LOCALHOST_ONLY",
    "ROS_STATIC_PEERS",
    "ZENOH_SESSION_CONFIG_URI",
];

/// A session's name, ROS domain, ports and scratch folder, all its own.
///
/// When it is dropped, processes of the session that still run are killed; if
/// the test has not failed already, finding any fails it, and so does anything
/// left in shared memory.
#[derive(Debug)]
pub struct Session {
    name: String,
    domain: Domain,
    folder: TempDir,
    link_port: u16,
    router_port: u16,
    _room: Room,
}

impl Session {
    /// Opens one. Nothing is started.
    ///
    /// # Panics
    ///
    /// No scratch folder, domain or port can be had.
    pub fn new() -> Session {
        Session::within(Room::shared())
    }

    /// Opens one that no other runs beside in this process: for a page that shows a session, or
    /// a peer in Python that has to be in time, beside it (`room.rs`).
    ///
    /// # Panics
    ///
    /// As [`Session::new`].
    pub fn alone() -> Session {
        Session::within(Room::alone())
    }

    fn within(room: Room) -> Session {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        Session {
            // The end mark keeps `…-1` from being found in `…-12`.
            name: format!("test-{}-{count}-end", process::id()),
            domain: Domain::take(),
            folder: TempDir::new().unwrap_or_else(|error| panic!("no scratch folder: {error}")),
            link_port: free_tcp_port(),
            router_port: free_tcp_port(),
            _room: room,
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its ROS domain.
    pub fn domain(&self) -> u32 {
        self.domain.number()
    }

    /// A folder to write into, which goes with the session.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Where the ends of the link meet.
    pub fn link_endpoint(&self) -> String {
        format!("tcp/127.0.0.1:{}", self.link_port)
    }

    /// Where they meet over QUIC, on the port of that number.
    pub fn quic_endpoint(&self) -> String {
        format!("quic/127.0.0.1:{}", self.link_port)
    }

    /// The secret of both ends of its link, while it runs with this session's folder as
    /// `XDG_RUNTIME_DIR`.
    ///
    /// # Panics
    ///
    /// It does not run so.
    pub fn link_secret(&self) -> String {
        let folder = self.folder().join("ferntast").join(self.name());
        let text = fs::read_to_string(folder.join("session.json")).expect("the session's file");
        let file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let secret = file["link_access"]["secret"].as_str();
        secret.expect("a secret").to_owned()
    }

    /// Where the Zenoh router for ROS 2 listens.
    pub fn router_endpoint(&self) -> String {
        format!("tcp/127.0.0.1:{}", self.router_port)
    }

    /// `ferntast` with these arguments, as they are, in this session's domain and folder.
    pub fn ferntast(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(ferntast());
        command.args(arguments);
        self.prepare(command)
    }

    /// `ferntast session` or `ferntast node …` with this session's name and endpoints.
    pub fn ferntast_here(&self, arguments: &[&str]) -> Command {
        let mut command = self.ferntast(arguments);
        command
            .args(["--session", self.name()])
            .args(["--link-endpoint", &self.link_endpoint()])
            .args(["--router-endpoint", &self.router_endpoint()]);
        command
    }

    /// A peer of `tests/python/peers` in this session's domain. Over Zenoh, give
    /// `--router` and [`router_endpoint`](Session::router_endpoint).
    pub fn peer(&self, script: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(python());
        command.arg(peer(script)).args(arguments);
        self.prepare(command)
    }

    fn prepare(&self, mut command: Command) -> Command {
        for name in FOREIGN {
            command.env_remove(name);
        }
        command
            .env("ROS_DOMAIN_ID", self.domain().to_string())
            .env("ROS_LOG_DIR", self.folder().join("ros-log"))
            .env("FERNTAST_LINK_KEYS", self.folder().join("link-keys"))
            .env("FERNTAST_TEST_SESSION", self.name())
            .current_dir(self.folder());
        command
    }

    /// Processes that belong to this session, by id: those that were started in
    /// its environment, and their descendants.
    pub fn processes(&self) -> Vec<u32> {
        let mark = format!("FERNTAST_TEST_SESSION={}", self.name);
        let Ok(entries) = fs::read_dir("/proc") else {
            return Vec::new();
        };
        entries
            .flatten()
            .filter_map(|entry| entry.file_name().to_str()?.parse().ok())
            .filter(|&process: &u32| process != process::id())
            .filter(|process| {
                // Gone or not ours to read: not of this session.
                fs::read(format!("/proc/{process}/environ")).is_ok_and(|environment| {
                    environment
                        .split(|&byte| byte == 0)
                        .any(|entry| entry == mark.as_bytes())
                })
            })
            .collect()
    }

    /// Files of this session in shared memory and in the folder for temporary files.
    pub fn leftovers(&self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        for folder in ["/dev/shm", "/tmp"] {
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                if entry.file_name().to_string_lossy().contains(&self.name) {
                    found.push(entry.path());
                }
            }
        }
        found
    }

    fn remove_leftovers(&self) -> io::Result<()> {
        for path in self.leftovers() {
            if path.is_dir() {
                fs::remove_dir_all(path)?;
            } else {
                fs::remove_file(path)?;
            }
        }
        Ok(())
    }
}

impl Default for Session {
    fn default() -> Session {
        Session::new()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // What was just told to stop has a moment to do so.
        wait_until(Duration::from_secs(2), || self.processes().is_empty());
        let processes = self.processes();
        for process in processes.iter().filter_map(|&id| i32::try_from(id).ok()) {
            // SAFETY: kill takes no pointers; the process carries this session's mark.
            unsafe { libc::kill(process, libc::SIGKILL) };
        }
        wait_until(Duration::from_secs(2), || self.processes().is_empty());
        let leftovers = self.leftovers();
        let removed = self.remove_leftovers();
        if !thread::panicking() {
            assert!(
                processes.is_empty(),
                "processes {processes:?} outlived session {}",
                self.name
            );
            assert!(
                leftovers.is_empty(),
                "session {} left {leftovers:?} (removing: {removed:?})",
                self.name
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Process;

    fn sleeper(session: &Session) -> Process {
        let mut command = Command::new("sleep");
        command.arg("600");
        Process::spawn(session.prepare(command))
    }

    #[test]
    fn no_two_sessions_share_anything() {
        let (one, other) = (Session::new(), Session::new());
        assert_ne!(one.name(), other.name());
        assert_ne!(one.domain(), other.domain());
        assert_ne!(one.folder(), other.folder());
        assert_ne!(one.link_endpoint(), other.link_endpoint());
        assert_ne!(one.link_endpoint(), one.router_endpoint());
    }

    #[test]
    fn finds_its_processes_and_no_others() {
        let (session, other) = (Session::new(), Session::new());
        let process = sleeper(&session);
        assert_eq!(session.processes(), [process.id()]);
        assert!(other.processes().is_empty());
        drop(process);
        assert!(session.processes().is_empty());
    }

    #[test]
    #[should_panic(expected = "outlived session")]
    fn a_process_that_outlives_the_session_fails_the_test() {
        let session = Session::new();
        let process = sleeper(&session);
        drop(session);
        drop(process);
    }

    #[test]
    #[should_panic(expected = "left [\"/dev/shm/")]
    fn shared_memory_that_stays_behind_fails_the_test() {
        let session = Session::new();
        fs::write(format!("/dev/shm/ferntast.{}.segment", session.name()), "").unwrap();
    }
}

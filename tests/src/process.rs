//! Processes that end with the test.

use std::{
    fmt::Write as _,
    io::{BufRead, BufReader, Read},
    os::unix::process::CommandExt,
    process::{Child, Command, ExitStatus, Stdio},
    ptr,
    sync::{Arc, Mutex, PoisonError},
    thread::{self, JoinHandle},
    time::Duration,
};

use crate::deadline::{patience, wait_for, wait_until};

/// A process with its output captured, leader of a process group of its own
/// which is killed when this is dropped.
#[derive(Debug)]
pub struct Process {
    name: String,
    child: Child,
    stdout: Arc<Mutex<String>>,
    stderr: Arc<Mutex<String>>,
    readers: Vec<JoinHandle<()>>,
}

/// How a process ended, and what it said.
#[derive(Debug)]
pub struct Ended {
    /// Its exit status.
    pub status: ExitStatus,
    /// All of its standard output.
    pub stdout: String,
    /// All of its standard error.
    pub stderr: String,
}

impl Ended {
    /// The JSON value on its standard output.
    ///
    /// # Panics
    ///
    /// It is not exactly one JSON value.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("not one JSON value ({error}):\n{self:#?}"))
    }

    /// The same, if it ended with exit code 1: something failed on the way.
    ///
    /// # Panics
    ///
    /// It did not.
    pub fn failure(self) -> Ended {
        assert_eq!(self.status.code(), Some(1), "{self:#?}");
        self
    }

    /// The same, if it ended with exit code 0.
    ///
    /// # Panics
    ///
    /// It did not.
    pub fn success(self) -> Ended {
        assert!(
            self.status.success(),
            "ended with {}\n--- stdout\n{}\n--- stderr\n{}",
            self.status,
            self.stdout,
            self.stderr
        );
        self
    }
}

impl Process {
    /// Starts it with a disk that seems small: no file of it, or of what it starts,
    /// grows beyond that many bytes. Shared memory counts as files too.
    ///
    /// # Panics
    ///
    /// It cannot be started.
    pub fn spawn_on_a_small_disk(mut command: Command, bytes: u64) -> Process {
        // SAFETY: as `limit_files` says; it may be called after fork.
        unsafe {
            command.pre_exec(move || {
                // A write beyond the limit is to fail, not to kill.
                libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
                limit_files(0, bytes)
            });
        }
        Process::spawn(command)
    }

    /// Starts it.
    ///
    /// # Panics
    ///
    /// It cannot be started.
    pub fn spawn(mut command: Command) -> Process {
        let name = format!("{command:?}");
        // A shell starts what runs in the background deaf to Ctrl-C.
        // SAFETY: signal takes no pointers here; it may be called after fork.
        unsafe {
            command.pre_exec(|| {
                libc::signal(libc::SIGINT, libc::SIG_DFL);
                Ok(())
            });
        }
        let mut child = command
            .process_group(0)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("cannot start {name}: {error}"));
        let stdout = Arc::default();
        let stderr = Arc::default();
        let mut readers = Vec::new();
        if let Some(pipe) = child.stdout.take() {
            readers.push(collect(pipe, &stdout));
        }
        if let Some(pipe) = child.stderr.take() {
            readers.push(collect(pipe, &stderr));
        }
        Process {
            name,
            child,
            stdout,
            stderr,
            readers,
        }
    }

    /// Its process id, which is its group's too.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// What it wrote on standard output so far.
    pub fn stdout(&self) -> String {
        text(&self.stdout)
    }

    /// What it wrote on standard error so far.
    pub fn stderr(&self) -> String {
        text(&self.stderr)
    }

    /// Whether it still runs.
    pub fn is_running(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(None))
    }

    /// Waits until its standard error holds `words`.
    ///
    /// # Panics
    ///
    /// It ends before, or `limit` passes.
    pub fn await_stderr(&mut self, words: &str, limit: Duration) {
        let found = wait_for(limit, || {
            // In this order, so that the last words of one that ended are seen.
            let ended = !self.is_running();
            let found = self.stderr().contains(words);
            (found || ended).then_some(found)
        });
        assert!(
            found == Some(true),
            "no {words:?} within {limit:?} from {}",
            self.describe()
        );
    }

    /// As Ctrl-C does: SIGINT to the process.
    pub fn interrupt(&self) {
        signal(self.child.id(), libc::SIGINT);
    }

    /// SIGTERM to the process.
    pub fn terminate(&self) {
        signal(self.child.id(), libc::SIGTERM);
    }

    /// SIGKILL to the process alone, not to what it started: a crash.
    pub fn crash(&self) {
        signal(self.child.id(), libc::SIGKILL);
    }

    /// Waits for its end.
    ///
    /// # Panics
    ///
    /// It does not end within `limit`.
    pub fn wait(mut self, limit: Duration) -> Ended {
        let limit = patience(limit);
        let status = wait_for(limit, || self.child.try_wait().ok().flatten());
        let Some(status) = status else {
            panic!("still runs after {limit:?}: {}", self.describe());
        };
        // A descendant that lives on may hold the pipes open: do not wait for ever.
        wait_until(Duration::from_secs(2), || {
            self.readers.iter().all(JoinHandle::is_finished)
        });
        Ended {
            status,
            stdout: self.stdout(),
            stderr: self.stderr(),
        }
    }

    fn describe(&self) -> String {
        let mut words = self.name.clone();
        for (title, said) in [("stdout", self.stdout()), ("stderr", self.stderr())] {
            // Cannot fail: it writes into a string.
            let _ = write!(words, "\n--- {title}\n{said}");
        }
        words
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Its own group, whose id cannot have been given to another while the
        // child has not been waited for; after that, only if a descendant lives.
        if let Ok(group) = i32::try_from(self.child.id()) {
            // SAFETY: kill takes no pointers.
            unsafe { libc::kill(-group, libc::SIGKILL) };
        }
        let _ = self.child.wait();
        if thread::panicking() {
            eprintln!("{}", self.describe());
        }
    }
}

/// No file of `process` (0: this one) grows beyond that many bytes from now on.
/// It has to be deaf to SIGXFSZ ([`Process::spawn_on_a_small_disk`]).
///
/// # Errors
///
/// It is gone, or another's.
pub fn limit_files(process: libc::pid_t, bytes: u64) -> std::io::Result<()> {
    let limit = libc::rlimit {
        rlim_cur: bytes,
        rlim_max: libc::RLIM_INFINITY,
    };
    // SAFETY: the limit lives through the call, and no other is asked for.
    match unsafe {
        libc::prlimit(
            process,
            libc::RLIMIT_FSIZE,
            &raw const limit,
            ptr::null_mut(),
        )
    } {
        0 => Ok(()),
        _ => Err(std::io::Error::last_os_error()),
    }
}

fn signal(process: u32, number: libc::c_int) {
    if let Ok(process) = i32::try_from(process) {
        // SAFETY: kill takes no pointers. The child has not been waited for, or
        // else it is gone and nothing was started in between.
        unsafe { libc::kill(process, number) };
    }
}

fn text(said: &Mutex<String>) -> String {
    said.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Reads a pipe to its end, in a thread, so that the process never waits for us.
fn collect(pipe: impl Read + Send + 'static, into: &Arc<Mutex<String>>) -> JoinHandle<()> {
    let into = Arc::clone(into);
    thread::spawn(move || {
        let mut pipe = BufReader::new(pipe);
        let mut line = Vec::new();
        while matches!(pipe.read_until(b'\n', &mut line), Ok(1..)) {
            let mut said = into.lock().unwrap_or_else(PoisonError::into_inner);
            said.push_str(&String::from_utf8_lossy(&line));
            line.clear();
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: Duration = Duration::from_secs(20);

    fn shell(script: &str) -> Process {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        Process::spawn(command)
    }

    /// Dead, or a zombie that nobody has waited for yet.
    fn is_gone(process: &str) -> bool {
        std::fs::read_to_string(format!("/proc/{}/stat", process.trim()))
            .map_or(true, |stat| stat.contains(") Z "))
    }

    #[test]
    fn captures_output_and_status() {
        let ended = shell("echo '{\"a\": 1}'; echo words >&2; exit 3").wait(LIMIT);
        assert_eq!(ended.status.code(), Some(3));
        assert_eq!(ended.json()["a"], 1);
        assert_eq!(ended.stderr, "words\n");
    }

    #[test]
    fn an_interrupt_reaches_the_process() {
        let mut process =
            shell("trap 'echo caught; exit 0' INT; echo up >&2; while :; do sleep 0.05; done");
        process.await_stderr("up", LIMIT);
        assert!(process.is_running());
        process.interrupt();
        assert_eq!(process.wait(LIMIT).success().stdout, "caught\n");
    }

    #[test]
    fn dropping_ends_the_whole_group() {
        let mut process = shell("sleep 600 & echo $!; echo up >&2; wait");
        process.await_stderr("up", LIMIT);
        let descendant = process.stdout();
        assert!(!is_gone(&descendant));
        drop(process);
        assert!(wait_until(LIMIT, || is_gone(&descendant)));
    }

    #[test]
    #[should_panic(expected = "still runs after")]
    fn waiting_has_an_end() {
        shell("sleep 600").wait(Duration::from_millis(50));
    }

    #[test]
    #[should_panic(expected = "no \"never\"")]
    fn awaiting_words_stops_when_the_process_ends() {
        shell("echo other >&2").await_stderr("never", LIMIT);
    }

    #[test]
    #[should_panic(expected = "ended with")]
    fn success_is_exit_code_zero() {
        shell("exit 1").wait(LIMIT).success();
    }
}

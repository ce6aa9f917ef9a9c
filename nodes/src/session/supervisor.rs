//! Starts one process a node, watches them, restarts one that dies, stops all.

use std::{
    env,
    os::unix::process::CommandExt,
    path::PathBuf,
    process::{Child, Command, ExitStatus, Stdio},
    time::{Duration, Instant},
};

use ferntast_bus::frames::ONE_THREAD;

use crate::{link, process::SUPERVISOR_DIED};

/// A node that dies this often within [`RESTART_WINDOW`] is given up.
pub const RESTART_LIMIT: usize = 5;
const RESTART_WINDOW: Duration = Duration::from_secs(30);
/// How long to wait before a restart.
pub const RESTART_PAUSE: Duration = Duration::from_millis(200);
/// How long a node may take to stop before it is killed; the recorder closes
/// its files in that time.
const STOP_PATIENCE: Duration = Duration::from_secs(5);

/// Why a session cannot be supervised.
#[derive(Debug, thiserror::Error)]
pub enum SupervisorError {
    /// A process could not be started.
    #[error("cannot start node {node}: {source}")]
    Start {
        /// The node.
        node: &'static str,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// A node died again and again.
    #[error(
        "node {node} died {times} times within {window} s (last: {status}); see its messages above, or run it alone: ferntast node {node}"
    )]
    GivenUp {
        /// The node.
        node: &'static str,
        /// How often.
        times: usize,
        /// Within which time \[s\].
        window: u64,
        /// How it ended last.
        status: ExitStatus,
    },
    /// A node refused its configuration or its surroundings.
    #[error("node {node} could not start (see its message above)")]
    Refused {
        /// The node.
        node: &'static str,
    },
}

/// Exit code by which a node says that starting it again would not help.
pub const EXIT_REFUSED: i32 = 2;

/// How a node ended that did not end well when it was told to.
#[derive(Clone, Copy, Debug)]
pub enum Unclean {
    /// It did not in time, and was killed.
    Killed,
    /// It failed on the way.
    Failed(ExitStatus),
}

struct Process {
    node: &'static str,
    child: Option<Child>,
    deaths: Vec<Instant>,
    start_at: Option<Instant>,
    restarts: u32,
}

/// The processes of a session.
pub struct Supervisor {
    executable: PathBuf,
    session_file: PathBuf,
    processes: Vec<Process>,
}

impl Supervisor {
    /// A supervisor for `nodes`, run by `executable` with the session's file.
    pub fn new(executable: PathBuf, session_file: PathBuf, nodes: &[&'static str]) -> Supervisor {
        let processes = nodes
            .iter()
            .map(|&node| Process {
                node,
                child: None,
                deaths: Vec::new(),
                start_at: None,
                restarts: 0,
            })
            .collect();
        Supervisor {
            executable,
            session_file,
            processes,
        }
    }

    /// Starts every node that does not run yet.
    ///
    /// # Errors
    ///
    /// A process that cannot be started.
    pub fn start(&mut self) -> Result<(), SupervisorError> {
        for index in 0..self.processes.len() {
            if self.processes[index].child.is_none() {
                self.spawn(index)?;
            }
        }
        Ok(())
    }

    fn spawn(&mut self, index: usize) -> Result<(), SupervisorError> {
        let process = &mut self.processes[index];
        let mut command = Command::new(&self.executable);
        command
            .arg("node")
            .arg(process.node)
            .arg("--session-file")
            .arg(&self.session_file)
            .arg("--generation")
            .arg(process.restarts.to_string())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            // A group of its own: Ctrl-C reaches the supervisor alone, which
            // then stops the nodes in order.
            .process_group(0);
        let (name, value) = ONE_THREAD;
        let is_end = [link::LEADER, link::FOLLOWER].contains(&process.node);
        if is_end && env::var_os(name).is_none() {
            command.env(name, value);
        }
        // SAFETY: prctl is async-signal-safe and touches nothing of ours.
        unsafe {
            command.pre_exec(|| {
                libc::prctl(libc::PR_SET_PDEATHSIG, SUPERVISOR_DIED);
                Ok(())
            });
        }
        let child = command.spawn().map_err(|source| SupervisorError::Start {
            node: process.node,
            source,
        })?;
        process.child = Some(child);
        process.start_at = None;
        Ok(())
    }

    /// Looks after the processes: notes those that died and restarts them.
    /// Gives the nodes that died since the last call.
    ///
    /// # Errors
    ///
    /// A node that dies again and again, or that refused to start.
    pub fn watch(&mut self) -> Result<Vec<(&'static str, ExitStatus)>, SupervisorError> {
        let now = Instant::now();
        let mut died = Vec::new();
        for index in 0..self.processes.len() {
            let process = &mut self.processes[index];
            if let Some(child) = &mut process.child
                && let Ok(Some(status)) = child.try_wait()
            {
                process.child = None;
                if status.code() == Some(EXIT_REFUSED) {
                    return Err(SupervisorError::Refused { node: process.node });
                }
                died.push((process.node, status));
                process.deaths.push(now);
                process
                    .deaths
                    .retain(|&at| now.duration_since(at) < RESTART_WINDOW);
                if process.deaths.len() >= RESTART_LIMIT {
                    return Err(SupervisorError::GivenUp {
                        node: process.node,
                        times: process.deaths.len(),
                        window: RESTART_WINDOW.as_secs(),
                        status,
                    });
                }
                process.restarts += 1;
                process.start_at = Some(now + RESTART_PAUSE);
            }
            if self.processes[index].start_at.is_some_and(|at| at <= now) {
                self.spawn(index)?;
            }
        }
        Ok(died)
    }

    /// Whether every node has come to its own end, without a fault.
    ///
    /// # Errors
    ///
    /// A node that refused to start, or died.
    pub fn ended(&mut self) -> Result<bool, SupervisorError> {
        let mut running = false;
        for process in &mut self.processes {
            let Some(child) = &mut process.child else {
                continue;
            };
            match child.try_wait() {
                Ok(Some(status)) if status.success() => process.child = None,
                Ok(Some(_)) => return Err(SupervisorError::Refused { node: process.node }),
                _ => running = true,
            }
        }
        Ok(!running)
    }

    /// Every node with its process, if it runs, and how often it was restarted.
    pub fn nodes(&self) -> impl Iterator<Item = (&'static str, Option<u32>, u32)> + '_ {
        self.processes.iter().map(|process| {
            (
                process.node,
                process.child.as_ref().map(Child::id),
                process.restarts,
            )
        })
    }

    /// Stops every node, in the order of the list, and waits for each. Gives
    /// those that did not end well.
    pub fn stop(&mut self) -> Vec<(&'static str, Unclean)> {
        let mut unclean = Vec::new();
        for process in &mut self.processes {
            process.start_at = None;
            let Some(mut child) = process.child.take() else {
                continue;
            };
            signal(&child, libc::SIGTERM);
            let give_up = Instant::now() + STOP_PATIENCE;
            loop {
                match child.try_wait() {
                    Ok(None) if Instant::now() < give_up => {
                        std::thread::sleep(Duration::from_millis(5));
                    }
                    Ok(None) | Err(_) => {
                        // Nothing to be done if it is gone already.
                        let _ = child.kill();
                        let _ = child.wait();
                        unclean.push((process.node, Unclean::Killed));
                        break;
                    }
                    Ok(Some(status)) => {
                        // A node that the signal met before it could note it is stopped too.
                        if status.code().is_some_and(|code| code != 0) {
                            unclean.push((process.node, Unclean::Failed(status)));
                        }
                        break;
                    }
                }
            }
        }
        unclean
    }
}

impl Drop for Supervisor {
    fn drop(&mut self) {
        self.stop();
    }
}

fn signal(child: &Child, signal: libc::c_int) {
    // SAFETY: the child was not waited for yet, so the number is still its own.
    unsafe {
        libc::kill(child.id() as libc::pid_t, signal);
    }
}

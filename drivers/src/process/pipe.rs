//! A program that is talked to by its standard input and output.

use std::{
    io::{self, Read, Write},
    os::fd::AsRawFd,
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    time::{Duration, Instant},
};

use super::error::{At, Ending, PlantError};

/// How long a program may take to end once its input is closed.
const ENDS_WITHIN: Duration = Duration::from_secs(2);
/// The longest line of an answer.
const LONGEST_LINE: usize = 1 << 16;

/// A running program. Dropped, its input is closed; one that does not end is killed.
pub struct Pipe {
    child: Child,
    input: Option<ChildStdin>,
    output: ChildStdout,
}

impl Pipe {
    /// Starts `command` by the shell, so that it may have quotes and variables.
    pub fn start(command: &str) -> Result<Pipe, PlantError> {
        if command.trim().is_empty() {
            return Err(PlantError::NoCommand);
        }
        let mut child = Command::new("sh")
            // The program takes the shell's place: it is what ends and is ended.
            .args(["-c", &format!("exec {command}")])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(PlantError::Start)?;
        let missing = || PlantError::Start(io::ErrorKind::BrokenPipe.into());
        let input = Some(child.stdin.take().ok_or_else(missing)?);
        let output = child.stdout.take().ok_or_else(missing)?;
        Ok(Pipe {
            child,
            input,
            output,
        })
    }

    /// Sends all of `bytes`.
    pub fn send(&mut self, bytes: &[u8], at: At) -> Result<(), PlantError> {
        let closed = || io::Error::from(io::ErrorKind::BrokenPipe);
        let sent = match &mut self.input {
            Some(input) => input.write_all(bytes).and_then(|()| input.flush()),
            None => Err(closed()),
        };
        match sent {
            Ok(()) => Ok(()),
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(self.ended(at)),
            Err(source) => Err(PlantError::Pipe { at, source }),
        }
    }

    /// Fills `bytes`, waiting for `patience` at most.
    pub fn receive(
        &mut self,
        bytes: &mut [u8],
        patience: Duration,
        at: At,
    ) -> Result<(), PlantError> {
        let deadline = Instant::now() + patience;
        let mut filled = 0;
        while filled < bytes.len() {
            let left = deadline.saturating_duration_since(Instant::now());
            if !self.is_readable(left, at)? {
                let seconds = patience.as_secs_f64();
                return Err(PlantError::Silent { seconds, at });
            }
            match self.output.read(&mut bytes[filled..]) {
                Ok(0) => return Err(self.ended(at)),
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(source) => return Err(PlantError::Pipe { at, source }),
            }
        }
        Ok(())
    }

    /// A line without its end.
    pub fn receive_line(&mut self, patience: Duration, at: At) -> Result<String, PlantError> {
        let deadline = Instant::now() + patience;
        let mut line = Vec::new();
        loop {
            let mut byte = [0];
            let left = deadline.saturating_duration_since(Instant::now());
            match self.receive(&mut byte, left, at) {
                Err(PlantError::Silent { .. }) => {
                    let seconds = patience.as_secs_f64();
                    return Err(PlantError::Silent { seconds, at });
                }
                other => other?,
            }
            if byte == *b"\n" || line.len() >= LONGEST_LINE {
                return Ok(String::from_utf8_lossy(&line).into_owned());
            }
            line.extend(byte);
        }
    }

    /// Whether there is something to read, or the end, within `patience`.
    fn is_readable(&self, patience: Duration, at: At) -> Result<bool, PlantError> {
        let mut watched = libc::pollfd {
            fd: self.output.as_raw_fd(),
            events: libc::POLLIN,
            revents: 0,
        };
        // Rounded up: what is left of a millisecond is not spun through.
        let milliseconds = patience.as_micros().div_ceil(1000).min(1 << 30) as i32;
        loop {
            // SAFETY: one entry, which lives for as long as the call.
            let ready = unsafe { libc::poll(&raw mut watched, 1, milliseconds) };
            if ready >= 0 {
                return Ok(ready > 0);
            }
            let source = io::Error::last_os_error();
            if source.kind() != io::ErrorKind::Interrupted {
                return Err(PlantError::Pipe { at, source });
            }
        }
    }

    /// It has closed a pipe: most likely it has ended, or is about to.
    fn ended(&mut self, at: At) -> PlantError {
        let how = Ending(self.wait(Duration::from_millis(500)));
        PlantError::Ended { at, how }
    }

    fn wait(&mut self, patience: Duration) -> Option<std::process::ExitStatus> {
        let deadline = Instant::now() + patience;
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) if Instant::now() < deadline => {
                    std::thread::sleep(Duration::from_millis(2));
                }
                _ => return None,
            }
        }
    }
}

impl Drop for Pipe {
    fn drop(&mut self) {
        self.input = None;
        if self.wait(ENDS_WITHIN).is_none() {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

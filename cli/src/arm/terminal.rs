//! Keys as they are pressed.

use std::io::{self, IsTerminal};

use crate::Failure;

/// Standard input without waiting for a line and without an echo; as before once it is dropped.
/// Ctrl-C goes on ending the program.
pub struct RawTerminal {
    before: libc::termios,
}

impl RawTerminal {
    /// Sets standard input up.
    ///
    /// # Errors
    ///
    /// Nobody sits there, or the terminal cannot be set up.
    pub fn open() -> Result<RawTerminal, Failure> {
        if !io::stdin().is_terminal() {
            return Err(Failure::refused(
                "--move needs a person who holds a key: run it in a terminal, not behind a pipe or in the background",
            ));
        }
        let failed = || {
            let error = io::Error::last_os_error();
            Failure::refused(format!(
                "this terminal does not give keys one by one: {error}"
            ))
        };
        // SAFETY: a termios is numbers and bytes, of which zeros are a value; tcgetattr fills it.
        let mut before: libc::termios = unsafe { std::mem::zeroed() };
        // SAFETY: `before` is valid for writing.
        if unsafe { libc::tcgetattr(libc::STDIN_FILENO, &mut before) } != 0 {
            return Err(failed());
        }
        let mut raw = before;
        raw.c_lflag &= !(libc::ICANON | libc::ECHO);
        // Reading gives what is there, and does not wait.
        raw.c_cc[libc::VMIN] = 0;
        raw.c_cc[libc::VTIME] = 0;
        // SAFETY: `raw` is what tcgetattr gave, changed by its own flags.
        if unsafe { libc::tcsetattr(libc::STDIN_FILENO, libc::TCSAFLUSH, &raw) } != 0 {
            return Err(failed());
        }
        Ok(RawTerminal { before })
    }

    /// Whether the space bar was among what was pressed since it was asked last.
    pub fn holds_space(&mut self) -> bool {
        let mut keys = [0_u8; 64];
        // SAFETY: `keys` is valid for writing so many bytes.
        let read = unsafe { libc::read(libc::STDIN_FILENO, keys.as_mut_ptr().cast(), keys.len()) };
        usize::try_from(read).is_ok_and(|read| keys[..read.min(keys.len())].contains(&b' '))
    }
}

impl Drop for RawTerminal {
    fn drop(&mut self) {
        // SAFETY: `before` is what tcgetattr gave.
        unsafe { libc::tcsetattr(libc::STDIN_FILENO, libc::TCSAFLUSH, &self.before) };
    }
}

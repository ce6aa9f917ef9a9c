//! Programs that want all of a processor.

use std::process::{Child, Command, Stdio};

/// Programs that compute for ever, until this is dropped.
#[derive(Debug)]
pub struct BusyLoops(Vec<Child>);

impl BusyLoops {
    /// Starts so many.
    ///
    /// # Panics
    ///
    /// There is no shell.
    pub fn start(count: usize) -> BusyLoops {
        let one = || {
            let mut command = Command::new("sh");
            command.args(["-c", "while :; do :; done"]);
            command.stdin(Stdio::null()).spawn().expect("a shell")
        };
        BusyLoops((0..count).map(|_| one()).collect())
    }
}

impl Drop for BusyLoops {
    fn drop(&mut self) {
        for child in &mut self.0 {
            // It may be gone already.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

//! Ctrl-C, SIGTERM, the end of the supervisor, and going on after a stop.

use std::sync::{Arc, atomic::AtomicBool};

use signal_hook::consts::{SIGCONT, SIGINT, SIGTERM, SIGUSR1};

/// What a node is sent when its supervisor has died. Linux sends it as each thread of the
/// supervisor ends, so more than once, and it must not be a signal whose second one ends
/// the process at once: the recorder would not close its recording.
pub const SUPERVISOR_DIED: i32 = SIGUSR1;

/// A flag that Ctrl-C, SIGTERM and the end of the supervisor set. The second Ctrl-C or SIGTERM ends
/// the process at once, for the case that stopping hangs.
///
/// # Errors
///
/// The operating system's reason when the handlers cannot be installed.
pub fn stop_on_signals() -> Result<Arc<AtomicBool>, std::io::Error> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 130, Arc::clone(&stop))?;
        signal_hook::flag::register(signal, Arc::clone(&stop))?;
    }
    signal_hook::flag::register(SUPERVISOR_DIED, Arc::clone(&stop))?;
    Ok(stop)
}

/// A flag that is set when the process goes on after it was stopped, by Ctrl-Z, a debugger
/// or the system: what waits for the network in a library may have given up.
///
/// # Errors
///
/// The operating system's reason when the handler cannot be installed.
pub fn flag_continued() -> Result<Arc<AtomicBool>, std::io::Error> {
    let continued = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(SIGCONT, Arc::clone(&continued))?;
    Ok(continued)
}

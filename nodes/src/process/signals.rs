//! Ctrl-C, SIGTERM, and the end of the supervisor.

use std::sync::{Arc, atomic::AtomicBool};

use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};

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

//! Ctrl-C, SIGTERM, the end of the supervisor, and going on after a stop.

use std::{
    io, process,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

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
pub fn stop_on_signals() -> io::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 130, Arc::clone(&stop))?;
        signal_hook::flag::register(signal, Arc::clone(&stop))?;
    }
    signal_hook::flag::register(SUPERVISOR_DIED, Arc::clone(&stop))?;
    Ok(stop)
}

/// Ends the process when it goes on after it was stopped, by Ctrl-Z, a debugger or the
/// system, so that the supervisor starts it again; `why` is told. For nodes with a library
/// that does not survive a stop.
///
/// # Errors
///
/// The operating system's reason when handler or thread cannot be had.
pub fn end_after_a_stop(why: &'static str) -> io::Result<()> {
    let continued = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(SIGCONT, Arc::clone(&continued))?;
    let watch = move || {
        while !continued.load(Ordering::Relaxed) {
            thread::sleep(Duration::from_millis(100));
        }
        eprintln!("{why}");
        process::exit(1);
    };
    let watcher = thread::Builder::new().name("stopped".to_owned());
    watcher.spawn(watch).map(drop)
}

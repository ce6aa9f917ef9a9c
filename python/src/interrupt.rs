//! Long work without the interpreter's lock, which Ctrl-C ends.

use std::{
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
        mpsc::{Receiver, RecvTimeoutError, channel},
    },
    thread,
    time::{Duration, Instant},
};

use pyo3::{prelude::*, types::PyAny};

use crate::error::failed;

/// How often the caller's thread looks for Ctrl-C and tells how far the work is.
const LOOK: Duration = Duration::from_millis(50);
/// How long it waits, after Ctrl-C, for the work to end at its next step.
const PATIENCE: Duration = Duration::from_secs(2);

/// What work is told and tells; goes along with it.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    stop: Arc<AtomicBool>,
    /// Bits of the share done.
    share: Arc<AtomicU64>,
}

/// How stopped work unwinds.
struct Stopped;

impl Watch {
    /// So much is done, 0 … 1.
    pub fn tell(&self, share: f64) {
        self.share.store(share.to_bits(), Ordering::Relaxed);
    }

    /// What says that the work has to end.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Whether the work has to end.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// So much is done; unwinds out of the work if it has to end.
    pub fn step(&self, share: f64) {
        self.tell(share);
        if self.is_stopped() {
            resume_unwind(Box::new(Stopped));
        }
    }
}

/// Runs `work` on a thread of its own. The caller's waits without the interpreter's
/// lock, hears Ctrl-C, and calls `progress` with the share that is done.
///
/// # Errors
///
/// KeyboardInterrupt or what `progress` raises: the work ends at its next step. What
/// the work itself gives as its error.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> PyResult<T> + Send + 'static,
) -> PyResult<T> {
    let watch = Watch::default();
    let (sender, receiver) = channel();
    let own = watch.clone();
    let worker = thread::Builder::new().name("ferntast".to_owned());
    let worker = worker.spawn(move || {
        let result = catch_unwind(AssertUnwindSafe(|| work(&own)));
        // Whoever does not wait any more needs no result.
        let _ = sender.send(result);
    });
    worker.map_err(failed)?;
    let results = Results(Mutex::new(receiver));
    let mut told = 0.0;
    loop {
        match py.detach(|| results.next()) {
            Ok(Ok(result)) => return result,
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Disconnected) => return Err(failed("the work broke off")),
            Err(RecvTimeoutError::Timeout) => {}
        }
        let share = f64::from_bits(watch.share.load(Ordering::Relaxed));
        let looked = py.check_signals().and_then(|()| match progress {
            Some(progress) if share > told => progress.call1((share,)).map(drop),
            _ => Ok(()),
        });
        told = share;
        if let Err(raised) = looked {
            watch.stop.store(true, Ordering::Relaxed);
            py.detach(|| results.wait());
            return Err(raised);
        }
    }
}

/// What comes of the work, for a thread that may give the interpreter's lock away.
struct Results<T>(Mutex<Receiver<T>>);

impl<T> Results<T> {
    fn next(&self) -> Result<T, RecvTimeoutError> {
        let receiver = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        receiver.recv_timeout(LOOK)
    }

    /// Waits until the work has ended, so that its files are closed, or for long enough.
    fn wait(&self) {
        let begun = Instant::now();
        while begun.elapsed() < PATIENCE {
            match self.next() {
                Err(RecvTimeoutError::Timeout) => {}
                _ => return,
            }
        }
    }
}

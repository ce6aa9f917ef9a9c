//! What the machine itself does to real time.
//!
//! A host may stop all processes of a virtual machine, or one of its processors,
//! for tens of milliseconds. A bound in milliseconds therefore holds up to what
//! a bare timer was late in the same window, and a test says that number.

use std::{
    any::Any,
    env, fmt,
    fs::File,
    mem,
    panic::{self, AssertUnwindSafe},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use ferntast_msgs::Time;

/// Period of a bare timer.
const PERIOD: Duration = Duration::from_millis(1);
/// A timer that is later than this was stalled.
const LATE: Duration = Duration::from_micros(500);
/// Above the 1 kHz loops of a session, so that these are no stalls.
const PRIORITY: libc::c_int = 80;
/// Stalls longer than this in all, within one [`STRETCH`], may disturb a session by
/// themselves: the shortest watchdog waits for 20 ms.
const LIMIT: Duration = Duration::from_millis(15);
/// Stalls that follow each other sooner add up: what came late in the first has not been
/// made up for in the next.
const STRETCH: Duration = Duration::from_millis(50);
/// So many windows are measured before the machine is given up.
const WINDOWS: usize = 6;

/// A span of UNIX time, as in the stamps of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Its begin.
    pub from: Time,
    /// Its end.
    pub to: Time,
}

impl Window {
    /// Whether a stamp lies within.
    pub fn contains(&self, stamp: Time) -> bool {
        (self.from..=self.to).contains(&stamp)
    }

    fn seconds(&self) -> f64 {
        self.to.seconds_since(self.from)
    }
}

/// The machine, held by one test at a time, with a bare timer on each processor.
pub struct Machine {
    stalls: Arc<Mutex<Vec<Window>>>,
    stop: Arc<AtomicBool>,
    timers: Vec<JoinHandle<()>>,
    _alone: File,
}

impl fmt::Debug for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Machine")
            .field("timers", &self.timers.len())
            .finish_non_exhaustive()
    }
}

impl Machine {
    /// Waits until no other test holds it, and starts the timers: at real-time
    /// priority where that is allowed.
    ///
    /// # Panics
    ///
    /// The lock file cannot be written.
    pub fn alone() -> Machine {
        let path = env::temp_dir().join("ferntast-tests-machine.lock");
        let lock = File::create(&path)
            .and_then(|file| file.lock().map(|()| file))
            .unwrap_or_else(|error| panic!("cannot lock {}: {error}", path.display()));
        let stalls = Arc::default();
        let stop = Arc::default();
        let timers = processors()
            .into_iter()
            .map(|processor| {
                let (stalls, stop) = (Arc::clone(&stalls), Arc::clone(&stop));
                thread::spawn(move || watch(processor, &stalls, &stop))
            })
            .collect();
        Machine {
            stalls,
            stop,
            timers,
            _alone: lock,
        }
    }

    /// Seconds of a window in which a processor did not run.
    pub fn stalled(&self, window: Window) -> f64 {
        let mut within = self.stalls_in(window);
        within.sort_by_key(|stall| stall.from);
        let (mut sum, mut end) = (0.0, window.from);
        for stall in within {
            let from = stall.from.max(end);
            if stall.to > from {
                sum += stall.to.seconds_since(from);
                end = stall.to;
            }
        }
        sum
    }

    /// The longest stall that overlaps a window \[s\].
    pub fn longest_stall(&self, window: Window) -> f64 {
        let stalls = self.stalls_in(window);
        stalls.iter().map(Window::seconds).fold(0.0, f64::max)
    }

    /// Whether the machine stalled for less than a session may be disturbed by.
    pub fn is_quiet(&self, window: Window) -> bool {
        let stretch = i64::try_from(STRETCH.as_nanos()).unwrap_or(0);
        self.stalls_in(window).iter().all(|stall| {
            let from = stall.from;
            let to = window.to.min(from.plus_nanos(stretch));
            self.stalled(Window { from, to }) <= LIMIT.as_secs_f64()
        })
    }

    /// What `test` gives, and the window that it took. Where it fails in a window
    /// in which the machine stalled for longer than 15 ms of 50, that is said and
    /// another window is measured; any other failure is one.
    ///
    /// # Panics
    ///
    /// `test` does, or every window was disturbed.
    pub fn undisturbed<T>(&self, mut test: impl FnMut() -> T) -> (T, Window) {
        for count in 1..=WINDOWS {
            let from = now();
            let done = panic::catch_unwind(AssertUnwindSafe(&mut test));
            let window = Window { from, to: now() };
            match done {
                Ok(value) => return (value, window),
                Err(failure) => self.excuse(count, window, failure),
            }
        }
        panic!("this machine stalled in each of {WINDOWS} windows: too busy to measure on");
    }

    /// Goes on with the panic unless the machine stalled.
    fn excuse(&self, count: usize, window: Window, failure: Box<dyn Any + Send>) {
        let (longest, all) = (self.longest_stall(window), self.stalled(window));
        let told = format!(
            "window {count} of {WINDOWS}: the machine stalled for {:.1} ms at most, {:.1} ms in all of {:.1} s",
            1e3 * longest,
            1e3 * all,
            window.seconds()
        );
        if self.is_quiet(window) {
            eprintln!("{told}, which is no excuse");
            panic::resume_unwind(failure);
        }
        eprintln!("{told}: measured again");
    }

    fn stalls_in(&self, window: Window) -> Vec<Window> {
        let all = self.stalls.lock().unwrap_or_else(PoisonError::into_inner);
        let overlap = all.iter().map(|stall| Window {
            from: stall.from.max(window.from),
            to: stall.to.min(window.to),
        });
        overlap.filter(|stall| stall.from < stall.to).collect()
    }
}

impl Drop for Machine {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for timer in self.timers.drain(..) {
            // A timer that panicked has said so.
            let _ = timer.join();
        }
    }
}

/// UNIX time now.
pub fn now() -> Time {
    let since = std::time::UNIX_EPOCH.elapsed().unwrap_or_default();
    Time::from_nanos(i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}

/// Sleeps for one period after the other and notes when it woke late.
fn watch(processor: usize, stalls: &Mutex<Vec<Window>>, stop: &AtomicBool) {
    pin(processor);
    while !stop.load(Ordering::Relaxed) {
        let start = Instant::now();
        thread::sleep(PERIOD);
        let late = start.elapsed().saturating_sub(PERIOD);
        if late > LATE {
            let to = now();
            let from = to.plus_nanos(-i64::try_from(late.as_nanos()).unwrap_or(0));
            let mut all = stalls.lock().unwrap_or_else(PoisonError::into_inner);
            all.push(Window { from, to });
        }
    }
}

/// The processors that this process may run on.
fn processors() -> Vec<usize> {
    // SAFETY: a set of processors is plain data, written by the call.
    let allowed = unsafe {
        let mut set: libc::cpu_set_t = mem::zeroed();
        libc::sched_getaffinity(0, size_of::<libc::cpu_set_t>(), &raw mut set);
        set
    };
    let all = 0..libc::CPU_SETSIZE.unsigned_abs() as usize;
    // SAFETY: the numbers are below the size of the set.
    all.filter(|&processor| unsafe { libc::CPU_ISSET(processor, &allowed) })
        .collect()
}

/// Keeps this thread on one processor, before all else there where that is allowed.
fn pin(processor: usize) {
    let priority = libc::sched_param {
        sched_priority: PRIORITY,
    };
    // SAFETY: both take plain data of this thread; what is refused stays as it was.
    unsafe {
        let mut set: libc::cpu_set_t = mem::zeroed();
        libc::CPU_SET(processor, &mut set);
        libc::sched_setaffinity(0, size_of::<libc::cpu_set_t>(), &raw const set);
        libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const priority);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(stalls: &[(i64, i64)]) -> Machine {
        let machine = Machine {
            stalls: Arc::default(),
            stop: Arc::default(),
            timers: Vec::new(),
            _alone: tempfile::tempfile().unwrap(),
        };
        let windows = stalls.iter().map(|&(from, to)| window(from, to));
        machine.stalls.lock().unwrap().extend(windows);
        machine
    }

    /// In milliseconds.
    fn window(from: i64, to: i64) -> Window {
        let time = |at: i64| Time::from_nanos(at * 1_000_000);
        Window {
            from: time(from),
            to: time(to),
        }
    }

    #[test]
    fn stalls_of_two_processors_count_once() {
        let machine = machine(&[(100, 110), (105, 120), (300, 301), (900, 950)]);
        let all = window(0, 800);
        assert!((machine.stalled(all) - 0.021).abs() < 1e-9);
        assert!((machine.longest_stall(all) - 0.015).abs() < 1e-9);
        assert!((machine.stalled(window(108, 115)) - 0.007).abs() < 1e-9);
        assert_eq!(machine.stalled(window(400, 800)), 0.0);
    }

    #[test]
    fn short_stalls_in_a_row_disturb_and_apart_they_do_not() {
        let all = window(0, 1000);
        assert!(machine(&[(100, 109), (160, 169), (400, 414)]).is_quiet(all));
        assert!(!machine(&[(100, 109), (130, 139)]).is_quiet(all));
        assert!(!machine(&[(100, 116)]).is_quiet(all));
        assert!(!machine(&[(100, 160)]).is_quiet(all));
    }

    #[test]
    fn a_timer_runs_on_every_processor() {
        let machine = Machine::alone();
        assert_eq!(machine.timers.len(), processors().len());
        assert!(!machine.timers.is_empty());
    }

    #[test]
    #[should_panic(expected = "a fault")]
    fn a_failure_in_a_quiet_window_is_a_failure() {
        machine(&[]).undisturbed(fails);
    }

    fn fails() {
        panic!("a fault");
    }

    /// Notes 20 ms of stall, up to now.
    fn stall(machine: &Machine) {
        thread::sleep(Duration::from_millis(25));
        let to = now();
        let from = to.plus_nanos(-20_000_000);
        machine.stalls.lock().unwrap().push(Window { from, to });
    }

    #[test]
    fn a_failure_in_a_stalled_window_is_measured_again() {
        let machine = machine(&[]);
        let mut count = 0;
        let (value, window) = machine.undisturbed(|| {
            count += 1;
            stall(&machine);
            assert_eq!(count, 3);
            count
        });
        assert_eq!(value, 3);
        assert!((machine.stalled(window) - 0.02).abs() < 1e-9);
    }

    #[test]
    #[should_panic(expected = "too busy to measure on")]
    fn a_machine_that_always_stalls_is_given_up() {
        let machine = machine(&[]);
        machine.undisturbed(|| {
            stall(&machine);
            fails();
        });
    }
}

//! The lockstep executor: virtual time, no clock.
//!
//! Time advances by whole ticks. In a tick every task that is due is stepped,
//! in the order in which they were added. Tasks meet in a context that each
//! of them is handed: a bus in memory, say. Where a message published at time
//! t is only seen by steps later than t, the order of tasks does not matter.

use ferntast_msgs::Time;

/// Something that is stepped in virtual time.
pub trait Task<Context> {
    /// One step at `now`.
    fn step(&mut self, now: Time, context: &mut Context);
}

impl<Context, Function: FnMut(Time, &mut Context)> Task<Context> for Function {
    fn step(&mut self, now: Time, context: &mut Context) {
        self(now, context);
    }
}

/// Why a task was not added, or an executor not made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LockstepError {
    /// The tick is not positive.
    #[error("a tick of {nanos} ns is no time; take 1 ms or the like")]
    Tick {
        /// \[ns\]
        nanos: i64,
    },
    /// The period is not a positive multiple of the tick.
    #[error("a period of {period} ns is not a multiple of the tick of {tick} ns")]
    Period {
        /// \[ns\]
        period: i64,
        /// \[ns\]
        tick: i64,
    },
    /// The start is no valid time.
    #[error("virtual time cannot start at {nanos} ns: stamps of zero and below are invalid")]
    Start {
        /// \[ns since the UNIX epoch\]
        nanos: i64,
    },
}

struct Entry<'a, Context> {
    period: i64,
    task: Box<dyn Task<Context> + 'a>,
}

/// Steps tasks in virtual time.
pub struct Lockstep<'a, Context> {
    start: Time,
    now: Time,
    tick: i64,
    tasks: Vec<Entry<'a, Context>>,
}

impl<'a, Context> Lockstep<'a, Context> {
    /// An executor at `start` that advances by `tick` \[ns\].
    ///
    /// # Errors
    ///
    /// [`LockstepError`] for a start or a tick that is not positive.
    pub fn new(start: Time, tick: i64) -> Result<Self, LockstepError> {
        if !start.is_valid() {
            return Err(LockstepError::Start {
                nanos: start.nanos(),
            });
        }
        if tick <= 0 {
            return Err(LockstepError::Tick { nanos: tick });
        }
        Ok(Lockstep {
            start,
            now: start,
            tick,
            tasks: Vec::new(),
        })
    }

    /// Adds a task that is stepped at the start and every `period` \[ns\] after it.
    ///
    /// # Errors
    ///
    /// [`LockstepError::Period`] when that is not a positive multiple of the tick.
    pub fn add(&mut self, period: i64, task: impl Task<Context> + 'a) -> Result<(), LockstepError> {
        if period <= 0 || period % self.tick != 0 {
            let tick = self.tick;
            return Err(LockstepError::Period { period, tick });
        }
        self.tasks.push(Entry {
            period,
            task: Box::new(task),
        });
        Ok(())
    }

    /// Virtual time: that of the next tick.
    pub fn now(&self) -> Time {
        self.now
    }

    /// One tick: steps every task that is due, then advances time.
    pub fn tick(&mut self, context: &mut Context) {
        let since = self.now.nanos_since(self.start);
        for entry in &mut self.tasks {
            if since % entry.period == 0 {
                entry.task.step(self.now, context);
            }
        }
        self.now = self.now.plus_nanos(self.tick);
    }

    /// As many ticks as fit into `seconds` \[s\], rounded.
    pub fn run(&mut self, seconds: f64, context: &mut Context) {
        let ticks = (seconds * 1e9 / self.tick as f64).round() as i64;
        for _ in 0..ticks {
            self.tick(context);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;
    const START: Time = Time::from_nanos(1_700_000_000_000_000_000);

    #[test]
    fn tasks_are_stepped_when_they_are_due() {
        let mut executor = Lockstep::new(START, MS).unwrap();
        let note = |name: char| {
            move |now: Time, log: &mut Vec<(char, i64)>| {
                log.push((name, now.nanos_since(START) / MS));
            }
        };
        executor.add(MS, note('a')).unwrap();
        executor.add(3 * MS, note('b')).unwrap();
        let mut log = Vec::new();
        executor.run(0.005, &mut log);
        let expected = [
            ('a', 0),
            ('b', 0),
            ('a', 1),
            ('a', 2),
            ('a', 3),
            ('b', 3),
            ('a', 4),
        ];
        assert_eq!(log, expected);
        assert_eq!(executor.now(), START.plus_nanos(5 * MS));
    }

    #[test]
    fn what_cannot_be_is_refused() {
        assert!(Lockstep::<()>::new(Time::INVALID, MS).is_err());
        assert!(Lockstep::<()>::new(START, 0).is_err());
        let mut executor = Lockstep::new(START, MS).unwrap();
        let task = |_: Time, _: &mut ()| {};
        for period in [0, -MS, MS / 2, MS + 1] {
            assert!(executor.add(period, task).is_err(), "{period}");
        }
    }
}

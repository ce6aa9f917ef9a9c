//! Nodes of the graph on a bus in memory, in virtual time.

use std::{cell::RefCell, rc::Rc};

use ferntast_bus::{
    Bus, MemoryBus,
    frames::{self, Door, FrameReceiver, FrameSender, LinkDirection},
};
use ferntast_msgs::{Time, sample::Faults};

use super::RunError;
use crate::{
    graph::{Build, Make, NodeRow, STEP_NANOS},
    link::LinkWire,
    node::HealthMeter,
    process::{NodeError, SessionContext, link_end::seeded_end},
};

/// Why virtual time does not begin, or a task has no place in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VirtualTimeError {
    /// The period is not a positive multiple of a step.
    #[error(
        "a period of {period} ns is not a multiple of {STEP_NANOS} ns, the step of virtual time"
    )]
    Period {
        /// \[ns\]
        period: i64,
    },
    /// The start is no valid time.
    #[error("virtual time cannot start at {nanos} ns: stamps of zero and below are invalid")]
    Start {
        /// \[ns since the UNIX epoch\]
        nanos: i64,
    },
}

/// Nodes and other tasks in virtual time, which meet on a bus in memory. No
/// clock is read: time advances by steps, in each of which every task that is
/// due is called, in the order in which they were added.
///
/// A message published at time t is seen by steps later than t, so that the
/// order of tasks counts for nothing but the order in which messages of one
/// time and topic (`/diagnostics`) are recorded.
pub struct VirtualTime {
    start: Time,
    now: Time,
    tasks: Vec<Task>,
    bus: Bus,
    /// The node that can do no more, and why.
    failure: Rc<RefCell<Option<NodeError>>>,
}

struct Task {
    period: i64,
    step: Box<dyn FnMut(Time)>,
}

impl VirtualTime {
    /// Nothing yet, at `start`.
    ///
    /// # Errors
    ///
    /// A start that is no valid time.
    pub fn new(start: Time) -> Result<VirtualTime, VirtualTimeError> {
        if !start.is_valid() {
            let nanos = start.nanos();
            return Err(VirtualTimeError::Start { nanos });
        }
        Ok(VirtualTime {
            start,
            now: start,
            tasks: Vec::new(),
            bus: Bus::Memory(MemoryBus::new()),
            failure: Rc::default(),
        })
    }

    /// Adds the nodes of `rows`; services have no place in virtual time and
    /// are left out.
    ///
    /// # Errors
    ///
    /// A node that cannot be made; a period that is no multiple of [`STEP_NANOS`].
    pub fn add_nodes<'a>(
        &mut self,
        rows: impl IntoIterator<Item = &'a NodeRow>,
        session: &SessionContext,
    ) -> Result<(), RunError> {
        let mut link = MemoryLink::new(&session.session, session.loaded.scenario.seed);
        for row in rows {
            let Make::Step { make, .. } = row.make else {
                continue;
            };
            let mut node = make(Build {
                session,
                bus: &self.bus,
                virtual_time: true,
                open_link: &mut |sends| link.open(sends),
                meter: HealthMeter::new(row.name, 0, row.period_nanos, Faults::default()),
            })?;
            let failure = Rc::clone(&self.failure);
            self.add_every(row.period_nanos, move |now| {
                node.tick(now, 0, 0);
                if let Some(reason) = node.failure() {
                    let failed = NodeError::Broken(reason);
                    failure.borrow_mut().get_or_insert(failed);
                }
            })?;
        }
        Ok(())
    }

    /// Adds something that is called every [`STEP_NANOS`].
    pub fn add(&mut self, step: impl FnMut(Time) + 'static) {
        self.tasks.push(Task {
            period: STEP_NANOS,
            step: Box::new(step),
        });
    }

    /// Adds something that is called at the start and every `period` \[ns\] after it.
    ///
    /// # Errors
    ///
    /// [`VirtualTimeError::Period`].
    pub fn add_every(
        &mut self,
        period: i64,
        step: impl FnMut(Time) + 'static,
    ) -> Result<(), VirtualTimeError> {
        if period <= 0 || period % STEP_NANOS != 0 {
            return Err(VirtualTimeError::Period { period });
        }
        let step = Box::new(step);
        self.tasks.push(Task { period, step });
        Ok(())
    }

    /// One step; gives its time.
    pub fn tick(&mut self) -> Time {
        let now = self.now;
        let since = now.nanos_since(self.start);
        for task in &mut self.tasks {
            // Most are due each time: not divided for.
            if task.period == STEP_NANOS || since % task.period == 0 {
                (task.step)(now);
            }
        }
        self.now = now.plus_nanos(STEP_NANOS);
        now
    }

    /// Why a node can do no more, told once.
    pub fn take_failure(&mut self) -> Option<NodeError> {
        self.failure.take()
    }

    /// As many steps as fit into `seconds` \[s\], rounded; none after one in which a node
    /// failed.
    pub fn run(&mut self, seconds: f64) {
        let steps = (seconds * 1e9 / STEP_NANOS as f64).round() as i64;
        for _ in 0..steps {
            if self.failure.borrow().is_some() {
                return;
            }
            self.tick();
        }
    }

    /// Virtual time: that of the next step.
    pub fn now(&self) -> Time {
        self.now
    }

    /// Where the nodes meet.
    pub fn bus(&self) -> &Bus {
        &self.bus
    }
}

/// A link between two nodes of one process.
struct MemoryLink {
    session: String,
    /// Of both ends, and of what they draw.
    seed: u64,
    forward: Option<(FrameSender, FrameReceiver)>,
    back: Option<(FrameSender, FrameReceiver)>,
}

impl MemoryLink {
    fn new(session: &str, seed: u64) -> MemoryLink {
        let (up_sender, up_receiver) = frames::memory();
        let (down_sender, down_receiver) = frames::memory();
        MemoryLink {
            session: session.to_owned(),
            seed,
            forward: Some((up_sender, down_receiver)),
            back: Some((down_sender, up_receiver)),
        }
    }

    fn open(&mut self, sends: LinkDirection) -> Result<LinkWire, NodeError> {
        let (end, number) = match sends {
            LinkDirection::Forward => (&mut self.forward, 1),
            LinkDirection::Back => (&mut self.back, 2),
        };
        let (sender, receiver) = end.take().ok_or(NodeError::NoLink)?;
        Ok(LinkWire {
            sender,
            receiver,
            secure: seeded_end(&self.session, self.seed, 0, number, sends),
            door: Door::default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Time = Time::from_nanos(1_700_000_000_000_000_000);

    #[test]
    fn tasks_are_called_when_they_are_due() {
        let mut time = VirtualTime::new(START).unwrap();
        let log = Rc::new(RefCell::new(Vec::new()));
        for (name, steps) in [('a', 1), ('b', 3)] {
            let log = log.clone();
            let note = move |now: Time| {
                let at = now.nanos_since(START) / STEP_NANOS;
                log.borrow_mut().push((name, at));
            };
            time.add_every(steps * STEP_NANOS, note).unwrap();
        }
        time.run(0.005);
        let expected = [
            ('a', 0),
            ('b', 0),
            ('a', 1),
            ('a', 2),
            ('a', 3),
            ('b', 3),
            ('a', 4),
        ];
        assert_eq!(*log.borrow(), expected);
        assert_eq!(time.now(), START.plus_nanos(5 * STEP_NANOS));
    }

    #[test]
    fn what_cannot_be_is_refused() {
        assert!(VirtualTime::new(Time::INVALID).is_err());
        let mut time = VirtualTime::new(START).unwrap();
        for period in [0, -STEP_NANOS, STEP_NANOS / 2, STEP_NANOS + 1] {
            assert!(time.add_every(period, |_| {}).is_err(), "{period}");
        }
    }

    #[test]
    fn an_end_of_the_link_is_given_once() {
        let mut link = MemoryLink::new("lockstep", 1);
        assert!(link.open(LinkDirection::Forward).is_ok());
        assert!(link.open(LinkDirection::Back).is_ok());
        assert!(link.open(LinkDirection::Back).is_err());
    }
}

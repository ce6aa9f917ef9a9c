//! Nodes of the graph on a bus in memory, in virtual time.

use ferntast_bus::{
    Bus, MemoryBus,
    frames::{self, FrameReceiver, FrameSender, LinkDirection},
};
use ferntast_msgs::{Time, sample::Faults};

use super::{RunError, executor::Lockstep};
use crate::{
    graph::{Build, Make, NodeRow, STEP_NANOS},
    node::HealthMeter,
    process::{NodeError, SessionContext},
};

/// Nodes and other tasks in virtual time, which meet on a bus in memory.
///
/// A message published at time t is seen by steps later than t, so that the
/// order of tasks counts for nothing but the order in which messages of one
/// time and topic (`/diagnostics`) are recorded.
pub struct VirtualTime {
    executor: Lockstep<'static, ()>,
    bus: Bus,
}

impl VirtualTime {
    /// Nothing yet, at `start`.
    ///
    /// # Errors
    ///
    /// A start that is no valid time.
    pub fn new(start: Time) -> Result<VirtualTime, RunError> {
        Ok(VirtualTime {
            executor: Lockstep::new(start, STEP_NANOS)?,
            bus: Bus::Memory(MemoryBus::new()),
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
        let mut link = MemoryLink::new();
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
            self.executor
                .add(row.period_nanos, move |now: Time, _: &mut ()| {
                    node.tick(now, 0, 0);
                })?;
        }
        Ok(())
    }

    /// Adds something that is called every [`STEP_NANOS`].
    ///
    /// # Errors
    ///
    /// None that a caller could cause.
    pub fn add(&mut self, mut step: impl FnMut(Time) + 'static) -> Result<(), RunError> {
        let task = move |now: Time, _: &mut ()| step(now);
        Ok(self.executor.add(STEP_NANOS, task)?)
    }

    /// One step; gives its time.
    pub fn tick(&mut self) -> Time {
        let now = self.executor.now();
        self.executor.tick(&mut ());
        now
    }

    /// As many steps as fit into `seconds` \[s\], rounded.
    pub fn run(&mut self, seconds: f64) {
        self.executor.run(seconds, &mut ());
    }

    /// Virtual time: that of the next step.
    pub fn now(&self) -> Time {
        self.executor.now()
    }

    /// Where the nodes meet.
    pub fn bus(&self) -> &Bus {
        &self.bus
    }
}

/// A link between two nodes of one process.
struct MemoryLink {
    forward: Option<(FrameSender, FrameReceiver)>,
    back: Option<(FrameSender, FrameReceiver)>,
}

impl MemoryLink {
    fn new() -> MemoryLink {
        let (up_sender, up_receiver) = frames::memory();
        let (down_sender, down_receiver) = frames::memory();
        MemoryLink {
            forward: Some((up_sender, down_receiver)),
            back: Some((down_sender, up_receiver)),
        }
    }

    fn open(&mut self, sends: LinkDirection) -> Result<(FrameSender, FrameReceiver), NodeError> {
        let end = match sends {
            LinkDirection::Forward => &mut self.forward,
            LinkDirection::Back => &mut self.back,
        };
        end.take().ok_or(NodeError::NoLink)
    }
}

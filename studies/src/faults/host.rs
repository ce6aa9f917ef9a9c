//! A host: its clock, its bus, its nodes and who starts them again.

use ferntast_bus::{Bus, MemoryBus};
use ferntast_msgs::{Time, sample::Faults};
use ferntast_nodes::{
    graph::{Build, Make, NodeRow, OpenLink, STEP_NANOS},
    node::{HealthMeter, Ticking},
    process::{NodeError, SessionContext},
    session::{RESTART_LIMIT, RESTART_PAUSE},
};

use super::clock::HostClock;

/// From the death of a process to its first step \[steps\]: the supervisor's
/// pause, and what a process takes to start.
const RESTART_STEPS: i64 = RESTART_PAUSE.as_millis() as i64 + 20;

/// What makes a node: its row's own function, but for the arm.
pub type MakeNode<'a> = Box<dyn Fn(Build) -> Result<Box<dyn Ticking>, NodeError> + 'a>;

struct Slot<'a> {
    row: NodeRow,
    make: MakeNode<'a>,
    node: Option<Box<dyn Ticking>>,
    deaths: u32,
    start_at: Option<i64>,
    stalled_until: i64,
    missed: u64,
}

/// A host.
pub struct Host<'a> {
    session: &'a SessionContext,
    /// Its clock.
    pub clock: HostClock,
    bus: Bus,
    slots: Vec<Slot<'a>>,
    stalled_until: i64,
    /// A node was given up: the supervisor has ended the session.
    ended: bool,
}

/// What becomes of a node's process in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Run {
    /// It was stepped.
    Stepped,
    /// It does not run: dead, or stalled.
    Still,
}

impl<'a> Host<'a> {
    /// A host without nodes.
    pub fn new(session: &'a SessionContext, start: Time) -> Host<'a> {
        Host {
            session,
            clock: HostClock::right(start),
            bus: Bus::Memory(MemoryBus::new()),
            slots: Vec::new(),
            stalled_until: 0,
            ended: false,
        }
    }

    /// Where its nodes meet.
    pub fn bus(&self) -> &Bus {
        &self.bus
    }

    /// Adds the node of `row`, made by the row's own function or by `make`.
    ///
    /// # Errors
    ///
    /// It cannot be made.
    pub fn add(
        &mut self,
        row: &NodeRow,
        make: Option<MakeNode<'a>>,
        open_link: &mut OpenLink<'_>,
    ) -> Result<(), NodeError> {
        let make = match (make, row.make) {
            (Some(make), _) => make,
            (None, Make::Step { make, .. }) => Box::new(make),
            (None, Make::Service(_)) => return Ok(()),
        };
        let mut slot = Slot {
            row: *row,
            make,
            node: None,
            deaths: 0,
            start_at: None,
            stalled_until: 0,
            missed: 0,
        };
        start(&mut slot, self.session, &self.bus, open_link)?;
        self.slots.push(slot);
        Ok(())
    }

    fn slot(&mut self, node: &str) -> Option<&mut Slot<'a>> {
        self.slots.iter_mut().find(|slot| slot.row.name == node)
    }

    /// The node dies at `tick`.
    pub fn crash(&mut self, node: &str, tick: i64) {
        let mut given_up = false;
        if let Some(slot) = self.slot(node)
            && slot.node.take().is_some()
        {
            slot.deaths += 1;
            slot.start_at = Some(tick + RESTART_STEPS);
            // No schedule is as long as the time after which deaths are forgotten.
            given_up = slot.deaths as usize >= RESTART_LIMIT;
        }
        if given_up {
            self.ended = true;
            for slot in &mut self.slots {
                slot.node = None;
                slot.start_at = None;
            }
        }
    }

    /// The node is not run before `until` \[step\].
    pub fn stall(&mut self, node: &str, until: i64) {
        if let Some(slot) = self.slot(node) {
            slot.stalled_until = slot.stalled_until.max(until);
        }
    }

    /// Nothing is run before `until` \[step\].
    pub fn stall_all(&mut self, until: i64) {
        self.stalled_until = self.stalled_until.max(until);
    }

    /// A new session begins: every node anew, on a new bus.
    pub fn begin_anew(&mut self, tick: i64) {
        self.bus = Bus::Memory(MemoryBus::new());
        self.ended = false;
        for slot in &mut self.slots {
            slot.node = None;
            slot.deaths = 0;
            slot.start_at = Some(tick + RESTART_STEPS);
        }
    }

    /// Whether there is a process of the node.
    pub fn lives(&self, node: &str) -> bool {
        let slot = self.slots.iter().find(|slot| slot.row.name == node);
        slot.is_some_and(|slot| slot.node.is_some())
    }

    /// The step `tick` of every node that runs and is due; `each` is told what
    /// became of whom.
    ///
    /// # Errors
    ///
    /// A node that cannot be made again.
    pub fn step(
        &mut self,
        tick: i64,
        open_link: &mut OpenLink<'_>,
        mut each: impl FnMut(&'static str, Run),
    ) -> Result<(), NodeError> {
        let now = self.clock.now(tick);
        let stalled = tick < self.stalled_until;
        for slot in &mut self.slots {
            let period = slot.row.period_nanos / STEP_NANOS;
            if tick % period != 0 {
                continue;
            }
            if slot.start_at.is_some_and(|at| tick >= at) {
                start(slot, self.session, &self.bus, open_link)?;
            }
            if stalled || tick < slot.stalled_until {
                slot.missed += 1;
                each(slot.row.name, Run::Still);
                continue;
            }
            match &mut slot.node {
                Some(node) => {
                    let missed = std::mem::take(&mut slot.missed);
                    let late = missed as i64 * slot.row.period_nanos;
                    node.tick(now, late, missed);
                    each(slot.row.name, Run::Stepped);
                }
                None => each(slot.row.name, Run::Still),
            }
        }
        Ok(())
    }
}

fn start(
    slot: &mut Slot,
    session: &SessionContext,
    bus: &Bus,
    open_link: &mut OpenLink<'_>,
) -> Result<(), NodeError> {
    slot.start_at = None;
    slot.missed = 0;
    let row = &slot.row;
    slot.node = Some((slot.make)(Build {
        session,
        bus,
        virtual_time: true,
        open_link,
        meter: HealthMeter::new(row.name, slot.deaths, row.period_nanos, Faults::default()),
    })?);
    Ok(())
}

//! The recorder's way of forwarding, onto a disk in memory that may be full, or
//! into a recording.

use ferntast_bus::{Bus, CreateError, MemoryBus};
use ferntast_control::planted::Planted;
use ferntast_msgs::{Time, sample::JointNames, topics::EVENT_QUEUE};
use ferntast_nodes::bridge::forwarder::{Forwarder, Forwarding, Stamp};

/// What became of the messages of a host's bus.
struct Source {
    bus: MemoryBus,
    forwarder: Forwarder,
    /// Published before the recorder heard of the bus.
    before: u64,
    forwarded: u64,
    failed: u64,
}

/// Forwards every topic of the hosts.
pub struct Recorder {
    disk: MemoryBus,
    sources: Vec<Source>,
    planted: Planted,
}

impl Recorder {
    /// A recorder of nothing yet.
    pub fn new(planted: Planted) -> Recorder {
        Recorder {
            disk: MemoryBus::new(),
            sources: Vec::new(),
            planted,
        }
    }

    /// Forwards what is published on `bus` from now on.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn add(&mut self, bus: &Bus, joints: &JointNames) -> Result<(), CreateError> {
        let Bus::Memory(memory) = bus else {
            return Ok(());
        };
        let to = Bus::Memory(self.disk.clone());
        let forwarder = everything(bus, &to, joints)?.planted(self.planted);
        self.sources.push(Source {
            before: memory.published(),
            bus: memory.clone(),
            forwarder,
            forwarded: 0,
            failed: 0,
        });
        Ok(())
    }

    /// The host at `place` has a new bus: what was on the old one is forwarded to
    /// its end.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn replace(
        &mut self,
        place: usize,
        bus: &Bus,
        joints: &JointNames,
    ) -> Result<(), CreateError> {
        self.add(bus, joints)?;
        let newest = self.sources.len() - 1;
        self.sources.swap(place, newest);
        Ok(())
    }

    /// The disk is full, or no longer.
    pub fn fill(&self, full: bool) {
        self.disk.refuse(full);
    }

    /// One round; `now` of each host, in the order in which they were added.
    pub fn round(&mut self, now: impl Fn(usize) -> Time) {
        for (place, source) in self.sources.iter_mut().enumerate() {
            let forwarded = source.forwarder.forward(now(place));
            source.forwarded += forwarded.messages;
            source.failed += forwarded.failed;
        }
    }

    /// What was published and neither forwarded nor told to be lost; after the
    /// last round.
    pub fn lost_silently(&self) -> Option<String> {
        for source in &self.sources {
            let (mut lost, mut refused) = (0, 0);
            source.forwarder.inputs(&mut |_, counts| {
                lost += counts.overflowed;
                refused += counts.refused();
            });
            let published = source.bus.published() - source.before;
            let told = source.forwarded + source.failed + lost + refused;
            if published != told {
                return Some(format!(
                    "{published} messages were published, {} recorded, {} told to have failed, \
                     {lost} told to be lost, {refused} refused",
                    source.forwarded, source.failed
                ));
            }
        }
        None
    }
}

/// Every topic from a bus to another, as the recorder forwards them.
///
/// # Errors
///
/// A topic that cannot be opened.
pub fn everything(from: &Bus, to: &Bus, joints: &JointNames) -> Result<Forwarder, CreateError> {
    let mut forwarder = Forwarder::default();
    forwarder.add_topics(from, to, Stamp::Received, joints, |_| Forwarding::Every {
        queue: EVENT_QUEUE,
    })?;
    Ok(forwarder)
}

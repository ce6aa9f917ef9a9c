//! Joins a node, its ports and its health.

use ferntast_bus::{Bus, CreateError, Publisher};
use ferntast_msgs::{Time, sample::HealthSample, topics};

use super::{HealthMeter, InputWatch, Node, Output, Ports};

/// A node that is connected to a bus, whatever its type.
pub trait Ticking {
    /// One step at `now`, `late_nanos` \[ns\] after it was due, with `missed`
    /// periods skipped before it: reads, steps and publishes. Takes from the
    /// heap no more than the node's own step does.
    fn tick(&mut self, now: Time, late_nanos: i64, missed: u64);

    /// Why the node can do no more.
    fn failure(&self) -> Option<String>;
}

/// A node, its ports and its health. The same runner serves a process of its
/// own and virtual time.
pub struct Runner<P: Ports> {
    node: P::Node,
    ports: P,
    input: <P::Node as Node>::Input,
    output: <P::Node as Node>::Output,
    meter: HealthMeter,
    diagnostics: Publisher<HealthSample>,
    watch: InputWatch,
    unsent: u64,
}

impl<P: Ports> Runner<P> {
    /// Connects `node` with its `ports`; its health goes to `/diagnostics` of `bus`.
    ///
    /// # Errors
    ///
    /// `/diagnostics` cannot be opened.
    pub fn new(
        bus: &Bus,
        node: P::Node,
        ports: P,
        meter: HealthMeter,
    ) -> Result<Runner<P>, CreateError> {
        Ok(Runner {
            node,
            ports,
            input: Default::default(),
            output: Default::default(),
            meter,
            diagnostics: bus.publisher(topics::DIAGNOSTICS)?,
            watch: InputWatch::default(),
            unsent: 0,
        })
    }
}

impl<P: Ports> Ticking for Runner<P> {
    fn failure(&self) -> Option<String> {
        self.node.failure()
    }

    fn tick(&mut self, now: Time, late_nanos: i64, missed: u64) {
        self.ports.read(now, &mut self.input);
        self.output.clear();
        self.node.step(now, &self.input, &mut self.output);
        self.unsent += self.ports.write(now, &self.output);
        let health = self.output.health();
        health.lost += self.unsent;
        // What was refused is told when the health is, and counted until then.
        if self.meter.is_due(now) {
            self.watch.note(|each| self.ports.counts(each), health);
        }
        if let Some(sample) = self.meter.step(now, late_nanos, missed, health)
            && self.diagnostics.publish(now, &sample).is_err()
        {
            self.unsent += 1;
        }
    }
}

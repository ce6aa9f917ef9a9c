//! What a node is: a pure step, its ports, and the runner that joins them.

mod fields;
mod health;
mod input;
mod input_watch;
mod operating_state;
mod per_joint;
mod ports;
mod runner;
#[cfg(test)]
mod tests;

pub use crate::{ports, topic_names};
pub use fields::{Incoming, InputPort, Outgoing};
pub(crate) use health::HEALTH_PERIOD_NANOS;
pub use health::{HealthMeter, NodeHealth};
pub use input::{BATCH, Batch, Newest};
pub use input_watch::InputWatch;
pub use operating_state::{StatePublisher, is_because, to_law};
pub use per_joint::PerJoint;
pub use ports::Ports;
pub use runner::{Runner, Ticking};

use ferntast_msgs::Time;

/// One part of the system, stepped at a fixed period: it reads the newest
/// messages of its input topics, computes, and publishes on its output topics.
/// What it computes by (a delay law, a servo, an estimator) is its own, and
/// lies in a pure crate where it is more than a few lines.
pub trait Node {
    /// The newest messages of each input topic.
    type Input: Default;
    /// What to publish after the step.
    type Output: Output;

    /// One step at time `now`. Does not fail, allocate, block or read a clock;
    /// what goes wrong is a value in `output`.
    fn step(&mut self, now: Time, input: &Self::Input, output: &mut Self::Output);

    /// Why it can do no more; virtual time ends then.
    fn failure(&self) -> Option<String> {
        None
    }
}

/// What every node's output has beside its messages.
pub trait Output: Default {
    /// How the node is doing, for `/diagnostics`.
    fn health(&mut self) -> &mut NodeHealth;

    /// Forgets the messages of the last step.
    fn clear(&mut self);
}

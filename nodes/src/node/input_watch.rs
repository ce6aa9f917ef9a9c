//! What the bus refused on the way in, made visible.

use ferntast_bus::SubscriberCounts;
use ferntast_control::planted::{Planted, Rule};
use ferntast_msgs::{
    Text,
    sample::{Fault, Level},
    topics::TopicName,
};

use super::NodeHealth;

/// More inputs than any node or gateway has.
const INPUTS: usize = 64;

/// Follows the counts of a node's inputs: what was refused and lost, and what
/// was wrong with the message that was refused last.
#[derive(Debug)]
pub struct InputWatch {
    seen: [u64; INPUTS],
    message: Text<96>,
    planted: Planted,
}

impl Default for InputWatch {
    fn default() -> Self {
        InputWatch {
            seen: [0; INPUTS],
            message: Text::EMPTY,
            planted: Planted::NONE,
        }
    }
}

impl InputWatch {
    /// A watch with a planted bug.
    pub fn planted(planted: Planted) -> InputWatch {
        InputWatch {
            planted,
            ..InputWatch::default()
        }
    }

    /// Adds to `health` what `inputs` tells of each input: its topic and its
    /// counts. Raises a fault for each topic of which a message was refused since the
    /// last call. What the node itself has to say goes before.
    pub fn note(
        &mut self,
        inputs: impl FnOnce(&mut dyn FnMut(&TopicName, &SubscriberCounts)),
        health: &mut NodeHealth,
    ) {
        let mut index = 0;
        if self.planted.lacks(Rule::RefusalsTold) {
            return;
        }
        inputs(&mut |topic, counts| {
            health.refused += counts.refused();
            health.lost += counts.overflowed;
            if let Some(seen) = self.seen.get_mut(index)
                && counts.refused() > *seen
            {
                *seen = counts.refused();
                self.message =
                    Text::display(format_args!("{topic} refused: {}", counts.last_refusal));
                health.raise(fault(topic), Level::WARN);
            }
            index += 1;
        });
        if health.message.is_empty() {
            health.message = self.message;
        }
    }
}

/// What it means that a message on `topic` is refused.
fn fault(topic: &TopicName) -> Fault {
    let topic = topic.as_str();
    if topic.ends_with("/state_command") {
        Fault::StateCommandRefused
    } else if topic == "/follower/measured_js" {
        Fault::MeasurementInvalid
    } else {
        Fault::CommandInvalid
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_is_told_once_with_topic_and_reason() {
        let mut watch = InputWatch::default();
        let mut counts = SubscriberCounts::default();
        let mut tell = |counts: &SubscriberCounts| {
            let mut health = NodeHealth::default();
            let topic = TopicName::constant("/follower/servo_cp");
            watch.note(|each| each(&topic, counts), &mut health);
            health
        };
        assert!(!tell(&counts).faults.has(Fault::CommandInvalid));
        counts.invalid = 1;
        counts.last_refusal = Text::new("position is NaN, not a finite number");
        let health = tell(&counts);
        assert!(health.faults.has(Fault::CommandInvalid));
        assert_eq!(health.refused, 1);
        assert_eq!(
            health.message.as_str(),
            "/follower/servo_cp refused: position is NaN, not a finite number"
        );
        let health = tell(&counts);
        assert!(!health.faults.has(Fault::CommandInvalid));
        assert!(!health.message.is_empty());
    }
}

//! `ros2 param set /link law wave`: the delay law as a parameter on ROS 2.

use ferntast_bus::{Bus, Choice, Depth, ParameterNode, Publisher, Subscriber};
use ferntast_control::delay::Law;
use ferntast_msgs::{
    Text, Time,
    sample::{LawCommandSample, LinkStatusSample},
    topics,
};

use crate::process::{ProcessError, Surroundings};

/// A wish that was not followed for this long is taken back \[s\]: two seconds
/// of round trip, and the switch.
const PATIENCE: f64 = 5.0;

/// Passes wishes on to the link, and tells which law it runs.
pub struct LawParameter {
    node: Option<ParameterNode>,
    command: Publisher<LawCommandSample>,
    status: Subscriber<LinkStatusSample>,
    /// The link's last word.
    runs: Text<24>,
    /// A wish, and when it was passed on.
    wished: Option<(Text<24>, Time)>,
}

impl LawParameter {
    /// Offers the parameter on `ros`.
    ///
    /// # Errors
    ///
    /// A topic or the parameter's node that cannot be opened.
    pub fn open(around: &Surroundings, ros: &Bus) -> Result<LawParameter, ProcessError> {
        let first = around.context.loaded.scenario.law.name();
        let choice = Choice {
            node: "link".to_owned(),
            name: "law".to_owned(),
            description: "The delay law, at both ends of the link".to_owned(),
            choices: Law::NAMES.iter().map(|name| (*name).to_owned()).collect(),
            value: first.to_owned(),
        };
        Ok(LawParameter {
            node: ParameterNode::open(ros, choice)?,
            command: around.bus.publisher(topics::LINK_LAW_COMMAND)?,
            status: around.bus.subscriber(topics::LINK_STATUS, Depth::Newest)?,
            runs: Text::new(first),
            wished: None,
        })
    }

    /// One round.
    pub fn round(&mut self, now: Time) {
        let Some(node) = &mut self.node else {
            return;
        };
        if let Some(name) = node.wish() {
            let law = Text::new(&name);
            let command = LawCommandSample { stamp: now, law };
            // One that does not get through is taken back below.
            let _ = self.command.publish(now, &command);
            self.wished = Some((law, now));
        }
        let Some(received) = self.status.newest(now) else {
            return;
        };
        let law = received.message.law;
        let changed = law != self.runs;
        let followed = self.wished.is_some_and(|(wish, _)| wish == law);
        let late = self
            .wished
            .is_some_and(|(_, since)| now.seconds_since(since) > PATIENCE);
        if followed || late {
            self.wished = None;
        }
        if late || (changed && self.wished.is_none()) {
            // Refused only if it were no choice, which the link does not run.
            let _ = node.tell(law.as_str());
        }
        self.runs = law;
    }
}

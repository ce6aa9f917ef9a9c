//! What a session does by choice, as parameters on ROS 2:
//! `ros2 param set /link law wave`, `ros2 param set /servo friction twin`.

use ferntast_bus::{Bus, Choice, CreateError, Depth, ParameterNode};
use ferntast_control::delay::Law;
use ferntast_msgs::{
    Text, Time,
    sample::{FrictionCommand, FrictionCommandSample, FrictionSource, LawCommandSample},
    topics,
};

use crate::process::{NodeError, ProcessContext};

/// A wish that was not followed for this long is taken back \[s\]: two seconds
/// of round trip, and the switch.
const PATIENCE: f64 = 5.0;

/// A value of a parameter.
type Value = Text<24>;

/// Why peers may not choose, where the scenario does not let them.
fn closed(process: &ProcessContext) -> Option<String> {
    let why = "peers on ROS 2 may look and not choose: begin the session with --ros-commands, or say it \
         on the page or by `ferntast link law` and `ferntast twin`";
    let open = process.session.loaded.scenario.gateway.commands;
    (!open).then(|| why.to_owned())
}

/// Passes wishes on to a node, and tells what that node does.
pub struct ChoiceParameter {
    node: Option<ParameterNode>,
    pass_on: Box<dyn FnMut(Time, Value)>,
    /// What the node said since the last call.
    heard: Box<dyn FnMut(Time) -> Option<Value>>,
    /// The node's last word.
    does: Value,
    /// A wish, and when it was passed on.
    wished: Option<(Value, Time)>,
}

impl ChoiceParameter {
    /// The delay law: parameter `law` of node `/link` on `ros`.
    ///
    /// # Errors
    ///
    /// A topic or the parameter's node that cannot be opened.
    pub fn law(process: &ProcessContext, ros: &Bus) -> Result<ChoiceParameter, NodeError> {
        let choice = Choice {
            node: "link".to_owned(),
            name: "law".to_owned(),
            description: "The delay law, at both ends of the link".to_owned(),
            choices: Law::NAMES.iter().map(|name| (*name).to_owned()).collect(),
            value: process.session.loaded.scenario.law.name().to_owned(),
            closed: closed(process),
        };
        let mut command = process.bus.publisher(topics::LINK_LAW_COMMAND)?;
        let mut status = process.bus.subscriber(topics::LINK_STATUS, Depth::Newest)?;
        let pass_on = move |now, law| {
            // One that does not get through is taken back later.
            let _ = command.publish(now, &LawCommandSample { stamp: now, law });
        };
        let heard = move |now| Some(status.newest(now)?.message.law);
        Self::open(ros, choice, Box::new(pass_on), Box::new(heard))
    }

    /// The servo's friction feed-forward: parameter `friction` of node `/servo` on `ros`.
    ///
    /// # Errors
    ///
    /// A topic or the parameter's node that cannot be opened.
    pub fn friction(process: &ProcessContext, ros: &Bus) -> Result<ChoiceParameter, NodeError> {
        let names = FrictionSource::ALL
            .into_iter()
            .filter_map(FrictionSource::name);
        let choice = Choice {
            node: "servo".to_owned(),
            name: "friction".to_owned(),
            description: "Where the friction that is fed forward comes from".to_owned(),
            choices: names.map(str::to_owned).collect(),
            value: "configured".to_owned(),
            closed: closed(process),
        };
        let bus = &process.bus;
        let mut command = bus.publisher(topics::FOLLOWER_FRICTION_COMMAND)?;
        let friction = topics::FOLLOWER_JOINT_FRICTION.of_joints(&process.session.joints());
        let mut joints = Vec::new();
        for topic in friction.map_err(CreateError::from)? {
            joints.push((bus.subscriber(topic, Depth::Newest)?, None));
        }
        let pass_on = move |now, source: Value| {
            let wish = match FrictionSource::from_name(source.as_str()) {
                Some(FrictionSource::TWIN) => FrictionCommand::TAKE_OVER,
                _ => FrictionCommand::GIVE_BACK,
            };
            let _ = command.publish(now, &FrictionCommandSample::new(now, wish));
        };
        let heard = move |now| {
            for (joint, source) in &mut joints {
                if let Some(received) = joint.newest(now) {
                    *source = Some(received.message.source);
                }
            }
            // One joint that goes by the twin is enough.
            let sources = joints.iter().filter_map(|(_, source)| *source);
            let source = sources.max_by_key(|source| source.0)?;
            source.name().map(Text::new)
        };
        Self::open(ros, choice, Box::new(pass_on), Box::new(heard))
    }

    fn open(
        ros: &Bus,
        choice: Choice,
        pass_on: Box<dyn FnMut(Time, Value)>,
        heard: Box<dyn FnMut(Time) -> Option<Value>>,
    ) -> Result<ChoiceParameter, NodeError> {
        Ok(ChoiceParameter {
            does: Text::new(&choice.value),
            node: ParameterNode::open(ros, &choice)?,
            pass_on,
            heard,
            wished: None,
        })
    }

    /// One round.
    pub fn round(&mut self, now: Time) {
        let Some(node) = &mut self.node else {
            return;
        };
        if let Some(name) = node.wish() {
            let wish = Text::new(&name);
            (self.pass_on)(now, wish);
            self.wished = Some((wish, now));
        }
        let Some(does) = (self.heard)(now) else {
            return;
        };
        let changed = does != self.does;
        let followed = self.wished.is_some_and(|(wish, _)| wish == does);
        let late = self
            .wished
            .is_some_and(|(_, since)| now.seconds_since(since) > PATIENCE);
        if followed || late {
            self.wished = None;
        }
        if late || (changed && self.wished.is_none()) {
            // Refused only if it were no choice, which the node does not do.
            let _ = node.tell(does.as_str());
        }
        self.does = does;
    }
}

//! Twins of many sessions, heard over a Zenoh router.

use std::collections::{BTreeMap, BTreeSet};

use ferntast_bus::{CreateError, Depth, ZenohBus, zenoh_ros::ZenohSubscriber};
use ferntast_msgs::{
    Message, Time,
    sample::{TemperatureSample, TwinParametersSample},
    topics::{
        Delivery, EVENT_QUEUE, FOLLOWER_JOINT_TEMPERATURE, JointNameError, TWIN_PARAMETERS, Topic,
        TopicName, TopicNameError,
    },
};

use crate::aggregate::Aggregate;

/// Why a twin cannot be heard.
#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    /// Its topic has a name that we have no room for.
    #[error("{name}: {source}; give its session a shorter --namespace")]
    Name {
        /// The topic.
        name: String,
        /// What is wrong.
        source: TopicNameError,
    },
    /// Its joint has such a name.
    #[error(transparent)]
    Joint(#[from] JointNameError),
    /// It cannot be subscribed to.
    #[error(transparent)]
    Create(#[from] CreateError),
}

/// A session whose twins are heard.
struct Heard {
    robot: String,
    namespace: String,
    twins: ZenohSubscriber<TwinParametersSample>,
    /// By joint; `None` where it cannot be heard, which was told.
    temperatures: BTreeMap<String, Option<ZenohSubscriber<TemperatureSample>>>,
}

/// Hears the twins of all sessions that a router knows.
pub struct Listener {
    bus: ZenohBus,
    heard: BTreeMap<String, Heard>,
    refused: BTreeSet<String>,
}

impl Listener {
    /// Over that bus, in whose namespace everything is looked for.
    pub fn new(bus: ZenohBus) -> Listener {
        Listener {
            bus,
            heard: BTreeMap::new(),
            refused: BTreeSet::new(),
        }
    }

    /// Looks for sessions that came since; what cannot be heard is told once.
    pub fn look(&mut self) -> Vec<ListenError> {
        let mut wrong = Vec::new();
        let ending = TWIN_PARAMETERS.name.as_str();
        for (name, _) in self.bus.topics_seen() {
            let Some(namespace) = name.strip_suffix(ending) else {
                continue;
            };
            if self.heard.contains_key(&name) || self.refused.contains(&name) {
                continue;
            }
            match subscribe(&self.bus, &name, TWIN_PARAMETERS.delivery) {
                Ok(twins) => {
                    let heard = Heard {
                        robot: robot(namespace),
                        namespace: namespace.to_owned(),
                        twins,
                        temperatures: BTreeMap::new(),
                    };
                    self.heard.insert(name, heard);
                }
                Err(error) => {
                    self.refused.insert(name);
                    wrong.push(error);
                }
            }
        }
        wrong
    }

    /// Takes what was said since into `days`. Gives the joints that were heard for the first
    /// time, as robot and joint; what cannot be heard is told once.
    pub fn take(
        &mut self,
        now: Time,
        days: &mut Aggregate,
    ) -> (Vec<(String, String)>, Vec<ListenError>) {
        let (mut new, mut wrong) = (Vec::new(), Vec::new());
        for own in self.heard.values_mut() {
            while let Some(word) = own.twins.next(now) {
                let joint = word.message.joint.to_string();
                days.said(&own.robot, &word.message);
                if own.temperatures.contains_key(&joint) {
                    continue;
                }
                let heard = temperature(&self.bus, &own.namespace, &joint);
                let heard = heard.map_err(|error| wrong.push(error)).ok();
                new.push((own.robot.clone(), joint.clone()));
                own.temperatures.insert(joint, heard);
            }
            for (joint, topic) in &mut own.temperatures {
                while let Some(told) = topic.as_mut().and_then(|own| own.newest(now)) {
                    days.temperature(
                        &own.robot,
                        joint,
                        told.message.stamp,
                        told.message.temperature,
                    );
                }
            }
        }
        (new, wrong)
    }
}

/// What a robot is called: its namespace.
fn robot(namespace: &str) -> String {
    match namespace.trim_matches('/') {
        "" => "/".to_owned(),
        name => name.to_owned(),
    }
}

fn temperature(
    bus: &ZenohBus,
    namespace: &str,
    joint: &str,
) -> Result<ZenohSubscriber<TemperatureSample>, ListenError> {
    let topic = FOLLOWER_JOINT_TEMPERATURE.of(joint)?;
    subscribe(bus, &format!("{namespace}{}", topic.name), topic.delivery)
}

fn subscribe<M: Message>(
    bus: &ZenohBus,
    name: &str,
    delivery: Delivery,
) -> Result<ZenohSubscriber<M>, ListenError> {
    let topic = TopicName::new(name).map_err(|source| ListenError::Name {
        name: name.to_owned(),
        source,
    })?;
    Ok(bus.subscriber(Topic::<M>::new(topic, delivery), Depth::Queue(EVENT_QUEUE))?)
}

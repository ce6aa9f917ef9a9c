//! All nodes in one process and virtual time.

mod executor;

pub use executor::{Lockstep, LockstepError};

use std::collections::BTreeMap;

use ferntast_bus::{Bus, CreateError, McapBus, MemoryBus, frames, mcap::BagOptions};
use ferntast_lab::experiment::RECORD;
use ferntast_model::ParameterError;
use ferntast_msgs::{
    Message, Text, Time,
    sample::{
        Faults, FrictionCommand, FrictionCommandSample, LawCommandSample, StateCommand,
        StateCommandSample,
    },
    topics::{self, Topic},
};
use ferntast_sim::arm::SimulatedArmError;

use crate::{
    arm::{ArmNode, ArmPorts},
    carry::{Carrier, Carry, Stamp},
    config::{ConfigError, Loaded},
    estimator::{EstimatorNode, EstimatorPorts},
    link::{
        FollowerLinkNode, FollowerLinkPorts, LeaderLinkNode, LeaderLinkPorts, LinkPorts,
        LinkTransport, session_number,
    },
    master::{MasterNode, MasterPorts},
    node::{HealthMeter, Node, Output, Ports, Runner},
    node_name::NodeName,
    process::PERIOD_NANOS,
    servo::{ServoNode, ServoPorts},
    session::Monitor,
    twin::{Assessing, TwinModel, TwinNode, TwinPorts},
};

/// The session's name in lockstep.
const SESSION: &str = "lockstep";
/// When the arm is armed, after the start \[ns\].
const ENABLE_AT_NANOS: i64 = 20_000_000;

/// Why lockstep cannot run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The configuration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A parameter is out of its bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The simulated arm cannot be made.
    #[error(transparent)]
    Arm(#[from] SimulatedArmError),
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// The executor refused a task.
    #[error(transparent)]
    Executor(#[from] LockstepError),
    /// The recording cannot be written.
    #[error("recording: {0}")]
    Recording(String),
}

/// Options of a recording that tell what it was made of: `mode` is `session`
/// or `lockstep`; scenario, arm and link are kept as JSON.
pub fn bag_options(loaded: &Loaded, mode: &str) -> BagOptions {
    let json = |value: Result<String, serde_json::Error>| value.unwrap_or_default();
    let record: BTreeMap<String, String> = [
        ("mode".to_owned(), mode.to_owned()),
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        (
            "scenario".to_owned(),
            json(serde_json::to_string(&loaded.scenario)),
        ),
        ("arm".to_owned(), json(serde_json::to_string(&loaded.arm))),
        ("link".to_owned(), json(serde_json::to_string(&loaded.link))),
    ]
    .into();
    BagOptions {
        custom: [(RECORD.to_owned(), record)].into(),
        ..BagOptions::default()
    }
}

/// A scenario in virtual time.
pub struct LockstepSession {
    executor: Lockstep<'static, Bus>,
    bus: Bus,
    recording: Option<McapBus>,
    monitor: Monitor,
}

/// Puts a node on the bus and among the executor's tasks.
/// # Errors
///
/// A topic that cannot be opened.
pub fn add<P: Ports + 'static>(
    executor: &mut Lockstep<'static, Bus>,
    bus: &Bus,
    name: NodeName,
    node: P::Node,
    ports: P,
) -> Result<(), RunError>
where
    P::Node: 'static,
    <P::Node as Node>::Input: 'static,
    <P::Node as Node>::Output: Output + 'static,
{
    let meter = HealthMeter::new(name.as_str(), 0, PERIOD_NANOS, Faults::default());
    let mut runner = Runner::new(bus, node, ports, meter)?;
    executor.add(PERIOD_NANOS, move |now: Time, _: &mut Bus| {
        runner.tick(now, 0, 0);
    })?;
    Ok(())
}

impl LockstepSession {
    /// All nodes of the scenario, on a bus in memory; `record` is where to.
    ///
    /// # Errors
    ///
    /// Configuration that cannot be used, a recording that cannot be made.
    pub fn new(loaded: &Loaded, record: Option<&std::path::Path>) -> Result<Self, RunError> {
        let scenario = &loaded.scenario;
        let start = Time::from_nanos(scenario.start.saturating_mul(1_000_000_000));
        let bus = Bus::Memory(MemoryBus::new());
        let mut executor = Lockstep::new(start, PERIOD_NANOS)?;
        let seed = scenario.seed;
        let session = session_number(SESSION);
        let (up_sender, up_receiver) = frames::memory();
        let (down_sender, down_receiver) = frames::memory();
        let at_leader = LinkTransport::new(
            up_sender,
            down_receiver,
            loaded.link.down.clone(),
            seed.wrapping_add(2),
        )?;
        let at_follower = LinkTransport::new(
            down_sender,
            up_receiver,
            loaded.link.up.clone(),
            seed.wrapping_add(1),
        )?;

        let master = MasterNode::new(&scenario.master, loaded.hand()?)?;
        add(
            &mut executor,
            &bus,
            NodeName::Master,
            master,
            MasterPorts::connect(&bus)?,
        )?;
        let ports = LinkPorts::new(LeaderLinkPorts::connect(&bus)?, at_leader);
        let node = LeaderLinkNode::new(loaded.laws(), session, scenario.link.buffer);
        add(&mut executor, &bus, NodeName::LinkLeader, node, ports)?;
        let ports = LinkPorts::new(FollowerLinkPorts::connect(&bus)?, at_follower);
        let node = FollowerLinkNode::new(loaded.laws(), session, scenario.link.buffer);
        add(&mut executor, &bus, NodeName::LinkFollower, node, ports)?;
        let servo = ServoNode::new(&loaded.arm.model, &scenario.servo)?;
        add(
            &mut executor,
            &bus,
            NodeName::Servo,
            servo,
            ServoPorts::connect(&bus)?,
        )?;
        let estimator = EstimatorNode::new(&loaded.arm.model, &loaded.arm.estimator)?;
        add(
            &mut executor,
            &bus,
            NodeName::Estimator,
            estimator,
            EstimatorPorts::connect(&bus)?,
        )?;
        let arm = ArmNode::new(&loaded.arm.whole()?, seed)?;
        add(
            &mut executor,
            &bus,
            NodeName::Arm,
            arm,
            ArmPorts::connect(&bus)?,
        )?;

        let mut follower = bus.publisher(topics::FOLLOWER_STATE_COMMAND)?;
        let mut leader = bus.publisher(topics::LEADER_STATE_COMMAND)?;
        let enable_at = start.plus_nanos(ENABLE_AT_NANOS);
        executor.add(PERIOD_NANOS, move |now: Time, _: &mut Bus| {
            if now == enable_at {
                let enable = StateCommandSample::new(now, StateCommand::ENABLE);
                // Memory does not refuse what is valid.
                let _ = follower.publish(now, &enable);
                let _ = leader.publish(now, &enable);
            }
        })?;

        let recording = match record {
            None => None,
            Some(folder) => {
                let recording = McapBus::create_with(folder, bag_options(loaded, "lockstep"))
                    .map_err(|error| RunError::Recording(error.to_string()))?;
                let mut carrier = Carrier::default();
                carrier.add_topics(&bus, &Bus::Mcap(recording.clone()), Stamp::Received, |_| {
                    Carry::Every { queue: 64 }
                })?;
                executor.add(PERIOD_NANOS, move |now: Time, _: &mut Bus| {
                    carrier.carry(now);
                })?;
                Some(recording)
            }
        };
        let monitor = Monitor::new(&bus)?;
        Ok(LockstepSession {
            executor,
            bus,
            recording,
            monitor,
        })
    }

    /// Holds the model of a joint against it. What the lab says of it comes at
    /// known times: virtual time waits for it.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn add_twin(&mut self, model: TwinModel) -> Result<(), RunError> {
        let node = TwinNode::new(model, Assessing::Inline);
        let ports = TwinPorts::connect(&self.bus)?;
        add(&mut self.executor, &self.bus, NodeName::Twin, node, ports)
    }

    /// Asks the link for the law of that name, `seconds` \[s\] after now.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn switch_law_at(&mut self, seconds: f64, law: &str) -> Result<(), RunError> {
        let law = Text::new(law);
        self.publish_at(seconds, topics::LINK_LAW_COMMAND, move |stamp| {
            LawCommandSample { stamp, law }
        })
    }

    /// Gives a command to the servo's friction feed-forward, `seconds` \[s\] after now.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn command_friction_at(
        &mut self,
        seconds: f64,
        command: FrictionCommand,
    ) -> Result<(), RunError> {
        let topic = topics::FOLLOWER_FRICTION_COMMAND;
        self.publish_at(seconds, topic, move |now| {
            FrictionCommandSample::new(now, command)
        })
    }

    fn publish_at<M: Message>(
        &mut self,
        seconds: f64,
        topic: Topic<M>,
        message: impl Fn(Time) -> M + 'static,
    ) -> Result<(), RunError> {
        let mut publisher = self.bus.publisher(topic)?;
        let at = self.executor.now().plus_nanos((seconds * 1e9) as i64);
        let mut published = false;
        self.executor
            .add(PERIOD_NANOS, move |now: Time, _: &mut Bus| {
                if !published && now >= at {
                    published = true;
                    // Memory does not refuse what is valid.
                    let _ = publisher.publish(now, &message(now));
                }
            })?;
        Ok(())
    }

    /// Runs `seconds` \[s\] of virtual time.
    pub fn run(&mut self, seconds: f64) {
        let mut left = seconds;
        // The monitor's queues hold half a second.
        while left > 1e-9 {
            let slice = left.min(0.1);
            self.executor.run(slice, &mut self.bus);
            self.monitor.update(self.executor.now());
            left -= slice;
        }
    }

    /// What was seen.
    pub fn monitor(&mut self) -> &mut Monitor {
        &mut self.monitor
    }

    /// Virtual time.
    pub fn now(&self) -> Time {
        self.executor.now()
    }

    /// The bus, for tests that look at every message.
    pub fn bus(&self) -> &Bus {
        &self.bus
    }

    /// Ends the run; closes the recording.
    ///
    /// # Errors
    ///
    /// The recording cannot be closed.
    pub fn finish(self) -> Result<(), RunError> {
        let LockstepSession {
            executor,
            recording,
            ..
        } = self;
        drop(executor);
        match recording {
            None => Ok(()),
            Some(recording) => recording
                .finish()
                .map(|_| ())
                .map_err(|error| RunError::Recording(error.to_string())),
        }
    }
}

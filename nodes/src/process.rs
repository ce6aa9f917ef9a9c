//! A node as a process of its own.

use std::{
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
};

use ferntast_bus::{
    Bus, CreateError, OpenError, SharedMemoryBus, SharedMemoryConfig,
    frames::{LinkDirection, LinkEndpoint, ZenohLink, ZenohLinkConfig},
};
use ferntast_emulation::channel::ChannelConfig;
use ferntast_model::ParameterError;
use ferntast_msgs::sample::{Fault, Faults};
use ferntast_sim::arm::SimulatedArmError;

use crate::{
    arm::{ArmNode, ArmPorts},
    clock::Clock,
    config::ConfigError,
    console,
    estimator::{EstimatorNode, EstimatorPorts},
    foxglove, gateway,
    link::{
        FollowerLinkNode, FollowerLinkPorts, LeaderLinkNode, LeaderLinkPorts, LinkPorts,
        LinkTransport, session_number,
    },
    master::{MasterNode, MasterPorts},
    node::{HealthMeter, Ports, Runner},
    node_name::NodeName,
    pace, player, recorder,
    servo::{ServoNode, ServoPorts},
    session::SessionContext,
    twin::{self, Assessing, TwinNode, TwinOpenError, TwinPorts},
};

/// Period of the servo loops \[ns\].
pub const PERIOD_NANOS: i64 = 1_000_000;

/// Why a node cannot run.
#[derive(Debug, thiserror::Error)]
pub enum ProcessError {
    /// A bus cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// A parameter is out of its bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The simulated arm cannot be made.
    #[error(transparent)]
    Arm(#[from] SimulatedArmError),
    /// The configuration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The page cannot be served.
    #[error(transparent)]
    Page(#[from] ferntast_console::ServerError),
    /// A recording is needed and none is named.
    #[error("no recording is named: give --bag DIR")]
    NoBag,
    /// An address is needed and none is given.
    #[error("no address is given for Foxglove: give --foxglove")]
    NoFoxglove,
    /// An experiment is needed and none is named.
    #[error("no experiment is named: give --twin EXPERIMENT.toml")]
    NoTwin,
    /// The experiment cannot be followed.
    #[error(transparent)]
    Twin(#[from] Box<TwinOpenError>),
    /// A recording cannot be opened or created.
    #[error("{path}: {reason}")]
    Bag {
        /// The recording.
        path: PathBuf,
        /// What is wrong, and how to mend it.
        reason: String,
    },
    /// It failed while it ran.
    #[error("{0}")]
    Broken(String),
}

/// What every loop needs.
pub struct Surroundings<'a> {
    /// The session.
    pub context: &'a SessionContext,
    /// The host's bus.
    pub bus: Bus,
    /// The session's clock.
    pub clock: Clock,
    /// Set when it is time to stop.
    pub stop: &'a AtomicBool,
    /// The node.
    pub name: NodeName,
    /// How often it was started before.
    pub generation: u32,
}

impl Surroundings<'_> {
    /// A meter for a loop of `period_nanos` \[ns\].
    pub fn meter(&self, period_nanos: i64, standing: Faults) -> HealthMeter {
        HealthMeter::new(
            self.name.as_str(),
            std::process::id(),
            period_nanos,
            standing,
        )
    }

    /// Asks for real-time priority; what stands against it is said, and is a
    /// standing fault. Threads that are started later inherit the priority: a
    /// link node asks before it opens the link, so that frames are received
    /// and stamped no later than the loop runs.
    fn request_realtime(&self) -> Faults {
        let mut standing = Faults::default();
        if let Err(error) = pace::request_realtime() {
            standing.set(Fault::NoRealtime);
            eprintln!(
                "node {}: no real-time priority ({error}); it runs on without, wake-ups may be late. \
                 `ferntast doctor` says how to get it",
                self.name
            );
        }
        standing
    }

    /// Runs a 1 kHz loop.
    fn run<P: Ports>(&self, standing: Faults, node: P::Node, ports: P) -> Result<(), ProcessError> {
        let meter = self.meter(PERIOD_NANOS, standing);
        let mut runner = Runner::new(&self.bus, node, ports, meter)?;
        pace::run(self.clock, PERIOD_NANOS, self.stop, |wake| {
            runner.tick(wake.now, wake.late_nanos, wake.missed)
        });
        Ok(())
    }

    fn link(
        &self,
        sends: LinkDirection,
        endpoint: LinkEndpoint,
        incoming: &ChannelConfig,
        seed: u64,
    ) -> Result<LinkTransport, ProcessError> {
        let clock = self.clock;
        let link = ZenohLink::open(ZenohLinkConfig {
            session: self.context.session.clone(),
            endpoint,
            sends,
            clock: Arc::new(move || clock.now()),
        })?;
        Ok(LinkTransport::new(
            link.sender,
            link.receiver,
            incoming.clone(),
            seed,
        )?)
    }
}

/// Runs `name` until `stop` is set.
///
/// # Errors
///
/// What keeps it from running.
pub fn run(
    name: NodeName,
    context: &SessionContext,
    generation: u32,
    stop: &AtomicBool,
) -> Result<(), ProcessError> {
    let bus = Bus::SharedMemory(SharedMemoryBus::open(&SharedMemoryConfig {
        session: context.session.clone(),
    })?);
    let around = Surroundings {
        context,
        clock: context.clock(),
        stop,
        name,
        generation,
        bus,
    };
    let bus = &around.bus;
    let loaded = &context.loaded;
    let scenario = &loaded.scenario;
    let session = session_number(&context.session);
    let standing = match name {
        NodeName::Gateway
        | NodeName::Recorder
        | NodeName::Player
        | NodeName::Console
        | NodeName::Foxglove
        | NodeName::Twin => Faults::default(),
        _ => around.request_realtime(),
    };
    match name {
        NodeName::Arm => around.run(
            standing,
            ArmNode::new(&loaded.arm.whole()?, scenario.seed)?,
            ArmPorts::connect(bus)?,
        ),
        NodeName::Servo => around.run(
            standing,
            ServoNode::new(&loaded.arm.model, &scenario.servo)?,
            ServoPorts::connect(bus)?,
        ),
        NodeName::Estimator => around.run(
            standing,
            EstimatorNode::new(&loaded.arm.model, &loaded.arm.estimator)?,
            EstimatorPorts::connect(bus)?,
        ),
        NodeName::Twin => {
            let path = context.twin.as_deref().ok_or(ProcessError::NoTwin)?;
            let model = twin::open(path).map_err(Box::new)?;
            around.run(
                standing,
                TwinNode::new(model, Assessing::OnThread),
                TwinPorts::connect(bus)?,
            )
        }
        NodeName::Master => around.run(
            standing,
            MasterNode::new(&scenario.master, loaded.hand()?)?,
            MasterPorts::connect(bus)?,
        ),
        NodeName::LinkLeader => {
            let endpoint = LinkEndpoint::Connect(scenario.link.endpoint.clone());
            let transport = around.link(
                LinkDirection::Forward,
                endpoint,
                &loaded.link.down,
                scenario.seed.wrapping_add(2),
            )?;
            around.run(
                standing,
                LeaderLinkNode::new(loaded.laws(), session, scenario.link.buffer),
                LinkPorts::new(LeaderLinkPorts::connect(bus)?, transport),
            )
        }
        NodeName::LinkFollower => {
            let endpoint = LinkEndpoint::Listen(scenario.link.endpoint.clone());
            let transport = around.link(
                LinkDirection::Back,
                endpoint,
                &loaded.link.up,
                scenario.seed.wrapping_add(1),
            )?;
            around.run(
                standing,
                FollowerLinkNode::new(loaded.laws(), session, scenario.link.buffer),
                LinkPorts::new(FollowerLinkPorts::connect(bus)?, transport),
            )
        }
        NodeName::Gateway => gateway::run(&around),
        NodeName::Recorder => recorder::run(&around),
        NodeName::Player => player::run(&around),
        NodeName::Console => console::run(&around),
        NodeName::Foxglove => foxglove::run(&around),
    }
}

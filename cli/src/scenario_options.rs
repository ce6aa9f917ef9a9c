//! The options by which a scenario is chosen and changed.

use std::{path::PathBuf, str::FromStr};

use clap::{Args, builder::RangedI64ValueParser};
use ferntast_bus::dds::MAX_DOMAIN;
use ferntast_config::{ARM, Changes, HandSource, LINK, Loaded, Middleware, SCENARIO};
use ferntast_control::codec::Codec;
use ferntast_drivers::{Choice, UnknownDriver, simulated};
use ferntast_msgs::sample::JointNames;
use ferntast_nodes::twin;

use super::Failure;

/// Which scenario, and what is to be different from it.
#[derive(Debug, Args)]
pub struct ScenarioOptions {
    /// Scenario.
    #[arg(long, default_value = "rokviss", value_name = "NAME|FILE",
        help = format!("Scenario: a shipped one ({}) or a file", SCENARIO.listed()))]
    pub scenario: String,

    /// Another arm than the scenario's.
    #[arg(long, value_name = "NAME|FILE|URDF",
        help = format!("Another arm than the scenario's: a shipped one ({}), a file, or a URDF alone (arm.urdf). The \
            scripted hand then touches what is beside it", ARM.listed()))]
    pub arm: Option<String>,

    /// Channel between operator and arm.
    #[arg(long, value_name = "NAME|FILE",
        help = format!("Channel between operator and arm: a shipped one ({}) or a file", LINK.listed()))]
    pub link: Option<String>,

    /// Delay law to start with: position_force, position_position, four_channel, wave, tdpa, model_mediated, two_layer, auto.
    #[arg(long, value_name = "NAME")]
    pub law: Option<String>,

    /// Constant round-trip time of the channel instead of the one in the link's file [ms].
    #[arg(long, value_name = "MS", allow_negative_numbers = true)]
    pub rtt: Option<f64>,

    /// Which frames the link carries: all of them, at 500 Hz, or with deadband those that a hand could tell
    /// from what was sent before, and keep-alives ([link] deadband sets how far).
    #[arg(long, value_name = "none|deadband", value_parser = Codec::NAMES)]
    pub codec: Option<String>,

    /// Whose hand: scripted, crtk (a CRTK client on ROS 2), haply (an Inverse3, by its Inverse Service on this
    /// host), leader (a second arm, by its joints: --arm-leader), or a CSV file with recorded motion (t_s,x_m,y_m).
    #[arg(long, value_name = "scripted|crtk|haply|leader|FILE")]
    pub hand: Option<String>,

    /// The arm that is the hand, with --hand leader: a shipped one (so101, ur5), a file, or a URDF alone. The hand's
    /// middle is where its tip is at home; the force is put on its motors, its own weight carried.
    #[arg(long, value_name = "NAME|FILE|URDF")]
    pub arm_leader: Option<String>,

    /// What is behind the leader arm's joints, as --driver says it of the arm's; simulated: a scripted hand moves a
    /// simulated one.
    #[arg(
        long,
        value_name = "simulated|dynamixel|feetech|process:COMMAND|ros2[:KEY=VALUE,…]"
    )]
    pub driver_leader: Option<Driver>,

    /// What is behind the arm's topics: simulated (the arm's file says what is true of it); dynamixel or
    /// feetech, motors on a serial bus that the arm's file lists (docs/motors.md); process:COMMAND, a plant in a
    /// program of its own, stepped over a pipe (docs/process_driver.md); or ros2, a robot that others drive over
    /// ROS 2 (docs/ros2_driver.md): [driver.ros2] of the arm's file, or ros2:KEY=VALUE,…, says how.
    #[arg(
        long,
        value_name = "simulated|dynamixel|feetech|process:COMMAND|ros2[:KEY=VALUE,…]"
    )]
    pub driver: Option<Driver>,

    /// Seed of everything that is random.
    #[arg(long)]
    pub seed: Option<u64>,

    /// How ROS 2 is reached.
    #[arg(long, value_enum)]
    pub middleware: Option<Middleware>,

    /// ROS domain (else ROS_DOMAIN_ID, else that of the scenario).
    #[arg(long, value_name = "ID", value_parser = domains())]
    pub domain: Option<u32>,

    /// Namespace of all topics, services and nodes on ROS 2, so that two sessions stand in one domain: /left.
    #[arg(long, value_name = "NAME")]
    pub namespace: Option<String>,

    /// Let peers on ROS 2 arm devices and choose law, friction, channel and recording; without it they may
    /// only pause and disable.
    #[arg(long)]
    pub ros_commands: bool,

    /// Endpoint at which the arm's end of the link listens: quic (TLS with both hosts' certificates), on the
    /// loopback also tcp or udp.
    #[arg(long, value_name = "quic|tcp|udp/HOST:PORT")]
    pub link_endpoint: Option<String>,

    /// Which of the known hosts has the arm, where several are known (see ferntast link keys --help).
    #[arg(long, value_name = "NAME")]
    pub link_peer: Option<String>,

    /// Endpoint of the Zenoh router for ROS 2 (with --middleware zenoh).
    #[arg(long, value_name = "tcp/HOST:PORT")]
    pub router_endpoint: Option<String>,

    /// Zenoh configuration of that router: TLS, access control, where it listens (the kind of file that
    /// ZENOH_ROUTER_CONFIG_URI names to rmw_zenoh's own router).
    #[arg(long, value_name = "FILE", conflicts_with = "router_endpoint")]
    pub router_config: Option<PathBuf>,
}

impl ScenarioOptions {
    /// The driver, as a session's context has it.
    pub fn driver(&self) -> Option<String> {
        self.driver.as_ref().map(|own| own.0.clone())
    }

    /// Loads the scenario with all that it names.
    ///
    /// # Errors
    ///
    /// What is wrong with it, where, and how to correct it.
    pub fn load(&self) -> Result<Loaded, Failure> {
        let mut loaded = ferntast_config::load_scenario(&self.scenario, simulated::load_arm)
            .map_err(Failure::refused)?;
        if let Some(arm) = &self.arm {
            loaded
                .set_arm(arm, simulated::load_arm)
                .map_err(Failure::refused)?;
        }
        if let Some(arm) = &self.arm_leader {
            loaded
                .set_leader(arm, simulated::load_arm)
                .map_err(Failure::refused)?;
        }
        let scenario = &mut loaded.scenario;
        if let (Some(driver), Some(leader)) = (&self.driver_leader, &mut scenario.hand.leader) {
            leader.driver.clone_from(&driver.0);
        }
        if let Some(middleware) = self.middleware {
            scenario.gateway.middleware = middleware;
        }
        if let Some(domain) = self.domain {
            scenario.gateway.domain_id = domain;
        } else if let Some(domain) = domain_of_environment()? {
            scenario.gateway.domain_id = domain;
        }
        if let Some(namespace) = &self.namespace {
            scenario.gateway.namespace = format!("/{}", namespace.trim_matches('/'));
        }
        scenario.gateway.commands |= self.ros_commands;
        if let Some(codec) = self.codec.as_deref().and_then(Codec::by_name) {
            scenario.link.codec = codec;
        }
        if let Some(endpoint) = &self.link_endpoint {
            scenario.link.endpoint.clone_from(endpoint);
        }
        if let Some(endpoint) = &self.router_endpoint {
            scenario.gateway.router_endpoint.clone_from(endpoint);
        }
        if let Some(file) = &self.router_config {
            scenario.gateway.router_config = Some(file.clone());
        }
        let changes = Changes {
            link: self.link.clone(),
            law: self.law.clone(),
            rtt_ms: self.rtt,
            hand: self.hand.clone(),
            seed: self.seed,
        };
        changes.apply(&mut loaded).map_err(Failure::refused)?;
        let of_leader = self.arm_leader.is_some() || self.driver_leader.is_some();
        if of_leader && loaded.scenario.hand.source != HandSource::Leader {
            return Err(Failure::refused(
                "--arm-leader and --driver-leader are of a leader arm: add --hand leader",
            ));
        }
        Ok(loaded)
    }
}

/// A driver as it is written, which is one that there is.
#[derive(Clone, Debug)]
pub struct Driver(pub String);

impl FromStr for Driver {
    type Err = UnknownDriver;

    fn from_str(text: &str) -> Result<Driver, UnknownDriver> {
        text.parse::<Choice>().map(|_| Driver(text.to_owned()))
    }
}

/// Refuses experiments that twins of an arm of those joints cannot follow, before any node is
/// started.
///
/// # Errors
///
/// What is wrong with them, where, and how to correct it.
pub fn check_twins(experiments: &[PathBuf], joints: JointNames) -> Result<(), Failure> {
    twin::open_all(experiments, joints)
        .map(drop)
        .map_err(Failure::refused)
}

/// Takes what is a ROS domain.
pub fn domains() -> RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(..=i64::from(MAX_DOMAIN))
}

/// The ROS domain that the environment asks for.
///
/// # Errors
///
/// `ROS_DOMAIN_ID` is none.
pub fn domain_of_environment() -> Result<Option<u32>, Failure> {
    match std::env::var("ROS_DOMAIN_ID") {
        Err(_) => Ok(None),
        Ok(text) if text.trim().is_empty() => Ok(None),
        Ok(text) => match text.trim().parse() {
            Ok(domain) if domain <= MAX_DOMAIN => Ok(Some(domain)),
            _ => Err(Failure::refused(format!(
                "ROS_DOMAIN_ID is {text:?}, which is no ROS domain; set it to 0 … {MAX_DOMAIN} or unset it"
            ))),
        },
    }
}

//! A scenario: what a session is made of.

use std::path::PathBuf;

use ferntast_control::{
    codec::{Codec, Deadband},
    delay::Law,
    haptics::MasterConfig,
    playout::LONGEST_BUFFER,
    servo::ServoConfig,
};
use ferntast_emulation::hand::{RecordedHandConfig, ScriptedHandConfig};
use ferntast_model::parameters;
use serde::{Deserialize, Serialize};

use super::{HaplyConfig, LeaderConfig};

parameters! {
    /// A file of `config/scenarios/`.
    pub struct Scenario {
        /// Its name.
        pub name: String,
        /// What it is, in a sentence.
        pub description: String,
        /// The arm: a file of `config/arms/` or a path.
        pub arm: String,
        /// Seed of everything that is random.
        pub seed: u64,
        /// Length in lockstep, where no other is asked for \[s\].
        pub duration: f64 [0.01..=1e6, "s"],
        /// Where virtual time starts: seconds since the UNIX epoch \[s\].
        pub start: i64 [1.0..=2e9, "s"],
        /// The hand on the master.
        pub hand: HandSection [section],
        /// The link.
        pub link: LinkSection [section],
        /// The delay law.
        pub law: Law [section],
        /// Parameters of the laws that it may be switched to; one that is not
        /// listed has its defaults, and the scales and the offset of `law`.
        #[serde(default)]
        pub laws: Vec<Law> [section],
        /// The joint servo.
        #[serde(default)]
        pub servo: ServoConfig [section],
        /// The haptic master bridge.
        #[serde(default)]
        pub master: MasterConfig [section],
        /// ROS 2.
        #[serde(default)]
        pub gateway: GatewaySection [section],
        /// Recordings.
        #[serde(default)]
        pub recorder: RecorderSection [section],
        /// Warnings near the arm's limits; without this section there are none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub limits: Option<LimitsSection> [section],
    }
}

parameters! {
    /// The hand on the master.
    pub struct HandSection {
        /// Whose hand.
        pub source: HandSource,
        /// The scripted operator.
        #[serde(default)]
        pub scripted: Option<ScriptedHandConfig> [section],
        /// File with recorded motion (t_s,x_m,y_m), relative to the scenario's folder.
        #[serde(default)]
        pub recording: Option<PathBuf>,
        /// How a recorded motion is played.
        #[serde(default)]
        pub recorded: RecordedHandConfig [section],
        /// How a Haply Inverse3 is met.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub haply: Option<HaplyConfig> [section],
        /// The arm that is the master.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub leader: Option<LeaderConfig> [section],
    }
}

/// Whose hand moves the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HandSource {
    /// A script, with the impedance of a hand.
    Scripted,
    /// Recorded human motion.
    Recorded,
    /// A CRTK client on ROS 2.
    Crtk,
    /// A Haply Inverse3, by its service on this host.
    Haply,
    /// A second arm, by its joints.
    Leader,
}

impl HandSource {
    /// Whether a person moves the master.
    pub fn is_a_person(self) -> bool {
        matches!(
            self,
            HandSource::Crtk | HandSource::Haply | HandSource::Leader
        )
    }

    /// Whether virtual time does not reach it, whatever is behind it.
    pub fn has_its_own_time(self) -> bool {
        matches!(self, HandSource::Crtk | HandSource::Haply)
    }
}

parameters! {
    /// The link.
    pub struct LinkSection {
        /// The channel: a file of `config/links/` or a path.
        pub channel: String,
        /// Where the arm's end listens and the operator's end connects to.
        #[serde(default = "link_endpoint")]
        pub endpoint: String,
        /// Jitter buffer at both ends: frames are played out evenly, this much after
        /// the quickest way; 0 acts on the newest at once. Four standard deviations of the
        /// delay keep jitter from pausing the arm \[s\].
        #[serde(default)]
        pub buffer: f64 [0.0..=LONGEST_BUFFER, "s"],
        /// The arm goes on by itself, on its ramp, after gaps in the link up to this
        /// long; 0: after every gap an operator has to say so \[s\].
        #[serde(default, skip_serializing_if = "is_zero")]
        pub rearm_after_gap: f64 [0.0..=LONGEST_BRIDGED_GAP, "s"],
        /// Which frames are sent: `none`, all of them, or `deadband`, those that a hand could
        /// tell from what was sent before.
        #[serde(default, skip_serializing_if = "Codec::is_none")]
        pub codec: Codec,
        /// What a hand cannot tell, with `codec = "deadband"`.
        #[serde(default, skip_serializing_if = "Deadband::is_default")]
        pub deadband: Deadband [section],
    }
}

/// Nobody stands beside an arm and expects it to go on by itself after longer \[s\].
const LONGEST_BRIDGED_GAP: f64 = 1.0;

/// What bridges no gap is not written into recordings, which had none before.
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn link_endpoint() -> String {
    "tcp/127.0.0.1:7448".to_owned()
}

/// How ROS 2 is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Middleware {
    /// DDS: works with any stock ROS 2.
    Dds,
    /// Zenoh, wire-compatible with rmw_zenoh; the session is its own router.
    Zenoh,
}

parameters! {
    /// ROS 2.
    pub struct GatewaySection {
        /// How ROS 2 is reached.
        pub middleware: Middleware = Middleware::Dds,
        /// ROS domain.
        pub domain_id: u32 [0.0..=232.0, "-"] = 0,
        /// Name of the node on ROS 2.
        pub node_name: String = "ferntast".to_owned(),
        /// Namespace on ROS 2 of all topics, services and nodes: `/`, or `/left`.
        #[serde(skip_serializing_if = "is_root")]
        pub namespace: String = "/".to_owned(),
        /// Endpoint of our own Zenoh router.
        pub router_endpoint: String = "tcp/127.0.0.1:7447".to_owned(),
        /// Settings of that router, in a file of Zenoh's own format, in place of the endpoint.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub router_config: Option<PathBuf> = None,
        /// Most messages a second on a servo stream of the follower \[Hz\].
        pub stream_rate: f64 [1.0..=1000.0, "Hz"] = 250.0,
        /// Most messages a second on a servo stream of the leader \[Hz\].
        pub leader_rate: f64 [1.0..=1000.0, "Hz"] = 500.0,
        /// Whether peers may arm devices, and choose law, friction, channel and
        /// recording. Without it they may pause and disable, and nothing else.
        #[serde(skip_serializing_if = "is_off")]
        pub commands: bool = false,
        /// Whether peers may command joint positions on `/follower/servo_jp`, past
        /// the master, the link and the authority of who holds them.
        #[serde(skip_serializing_if = "is_off")]
        pub servo_jp: bool = false,
    }
}

/// The root is not written into recordings, which had no namespace before.
fn is_root(namespace: &str) -> bool {
    namespace == "/"
}

/// A switch that is off is not written into recordings, which had none before.
fn is_off(switch: &bool) -> bool {
    !switch
}

impl GatewaySection {
    /// The endpoint at which the session is a Zenoh router, if it is one and no file says
    /// where.
    pub fn own_router(&self) -> Option<&str> {
        let by_endpoint = self.middleware == Middleware::Zenoh && self.router_config.is_none();
        by_endpoint.then_some(self.router_endpoint.as_str())
    }
}

parameters! {
    /// Recordings.
    #[derive(Copy)]
    pub struct RecorderSection {
        /// Messages of one topic that may wait for the recorder.
        pub queue: usize [1.0..=64.0, "messages"] = 64,
    }
}

parameters! {
    /// How near to the arm's limits is near.
    #[derive(Copy)]
    pub struct LimitsSection {
        /// From the end of a joint's range \[rad\].
        pub position_margin: f64 [0.0..=3.0, "rad"] = 0.1,
        /// Share of the torque sensor's range \[-\].
        pub torque_share: f64 [0.0..=1.0, "-"] = 0.8,
        /// Temperature of a joint \[degC\].
        pub temperature: f64 [-50.0..=150.0, "degC"] = 60.0,
    }
}

impl Scenario {
    /// A servo with nobody who operates it: all else as it is by default.
    pub fn without_operator(servo: ServoConfig, seed: u64) -> Scenario {
        Scenario {
            name: "without_operator".to_owned(),
            description: String::new(),
            arm: String::new(),
            seed,
            duration: 1.0,
            start: 1,
            hand: HandSection {
                source: HandSource::Crtk,
                scripted: None,
                recording: None,
                recorded: RecordedHandConfig::default(),
                haply: None,
                leader: None,
            },
            link: LinkSection {
                channel: "direct".to_owned(),
                endpoint: link_endpoint(),
                rearm_after_gap: 0.0,
                buffer: 0.0,
                codec: Codec::None,
                deadband: Deadband::default(),
            },
            law: Law::default(),
            laws: Vec::new(),
            servo,
            master: MasterConfig::default(),
            gateway: GatewaySection::default(),
            recorder: RecorderSection::default(),
            limits: None,
        }
    }
}

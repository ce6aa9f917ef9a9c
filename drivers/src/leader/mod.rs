//! A second arm as the hand: GELLO, an SO-101 leader, any arm behind a driver.
//!
//! Its tip is `/leader/measured_cp`, under a source of its own; `/leader/servo_cf`, which the master
//! has limited, is what its joints give beside its own weight
//! ([`LeaderArm`](ferntast_control::haptics::LeaderArm)). They give the weight alone where the
//! master is not enabled, another hand holds the authority, or the force is silent. Drives that cannot
//! be told a torque ([`Driver::gives_torque`](crate::Driver::gives_torque)) are off, so that the arm is limp. While its
//! joints are silent, its driver lets go of it or, as motors on a bus, holds it where it was. Silent
//! joints are no hand: the master lets go and the arm pauses, as with any client.

mod device;
mod held;
mod node;

pub use device::Device;
pub use held::HeldArm;
pub use node::{LeaderInput, LeaderNode, LeaderOutput, LeaderPorts, SOURCE};

use ferntast_config::{ConfigError, LeaderConfig, Loaded};
use ferntast_nodes::{
    graph::Build,
    node::Ticking,
    process::{NodeError, SessionContext},
};

use crate::choice::Choice;

/// The node of the graph.
pub(crate) fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let session = build.session;
    let loaded = &session.loaded;
    let config = loaded.scenario.hand.leader.clone().unwrap_or_default();
    let (Some(file), Some(axes)) = (&loaded.leader, config.turned()) else {
        let missing = ConfigError::NoHand {
            path: loaded.path.clone(),
            source_name: "leader",
            missing: "leader",
        };
        return Err(missing.into());
    };
    let Some(serial) = file.model.serial() else {
        let arm = config.arm;
        return Err(ConfigError::Leader { arm }.into());
    };
    let choice: Choice = config.driver.parse().map_err(NodeError::own)?;
    let device = match choice {
        Choice::Simulated => {
            let hand = loaded.scenario.hand.scripted.clone().unwrap_or_default();
            let held = HeldArm::new(file, serial, axes, &hand, loaded.scenario.seed)?;
            Device::Held(Box::new(held))
        }
        other => {
            let as_arm = driven(session, &config);
            Device::Driven(other.driver(&as_arm, build.virtual_time)?)
        }
    };
    let turns = config.orientation.unwrap_or(serial.arm.turns_tool());
    let node = LeaderNode::new(device, serial.arm.clone(), axes, turns);
    if !node.renders_force() && !build.virtual_time {
        eprintln!(
            "node leader: driver {} cannot command torques: the leader arm is limp, there is no force in the hand",
            config.driver
        );
    }
    let ports = LeaderPorts::connect(build.bus, &session.joints())?;
    build.join(node, ports)
}

/// The session as a driver has it whose arm is the leader.
fn driven(session: &SessionContext, config: &LeaderConfig) -> SessionContext {
    let mut own = SessionContext {
        driver: Some(config.driver.clone()),
        ..session.clone()
    };
    let Loaded {
        arm,
        scenario,
        leader,
        ..
    } = &mut own.loaded;
    if let Some(leader) = leader.take() {
        if let Some(serial) = leader.model.serial() {
            scenario.servo = serial.servo.clone();
        }
        *arm = leader;
    }
    // Two drivers on ROS 2 are two nodes there.
    scenario.gateway.node_name.push_str("_leader");
    own
}

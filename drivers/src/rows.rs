//! The rows of the graph behind which there is a driver.

use ferntast_config::HandSource;
use ferntast_nodes::{
    DrivenRows,
    graph::{Build, NodeRow},
    node::Ticking,
    process::{End, NodeError, Priority},
};

use crate::{
    choice::Choice,
    leader::{self, LeaderPorts},
    node::{ArmNode, ArmPorts},
};

/// The rows of the arm and of the arm that is the master, whatever their drivers.
pub const fn rows() -> DrivenRows {
    DrivenRows {
        arm: NodeRow::step::<ArmPorts>(
            "arm",
            "The simulated arm; hardware takes its place by speaking the same topics",
            Priority::Arm,
            arm,
        )
        .at(End::Arm),
        leader: NodeRow {
            end: Some(End::Operator),
            in_session: |session| session.loaded.scenario.hand.source == HandSource::Leader,
            ..NodeRow::step::<LeaderPorts>(
                "leader",
                "A second arm as the hand: where its tip is, and the force through its joints",
                Priority::Hand,
                leader::make,
            )
        },
    }
}

fn arm(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let driver = Choice::of(build.session)?.driver(build.session, build.virtual_time)?;
    ArmNode::new(driver)?.join(build)
}

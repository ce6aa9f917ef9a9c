//! The nodes, and what runs them: supervisor, lockstep, replay.

pub mod bridge;
mod console;
pub mod estimator;
pub mod events;
pub mod graph;
mod haply;
pub mod limits;
pub mod link;
pub mod lockstep;
pub mod master;
pub mod node;
pub mod process;
pub mod replay;
pub mod servo;
pub mod session;
pub mod twin;

use ferntast_config::HandSource;

use bridge::{foxglove, gateway, player, recorder};
use graph::{Graph, NodeRow, always, never};
use process::{End, Priority};

/// The rows of nodes that have a driver, which nodes know nothing of.
#[derive(Clone, Copy, Debug)]
pub struct DrivenRows {
    /// The arm.
    pub arm: NodeRow,
    /// An arm that is the master.
    pub leader: NodeRow,
}

/// The nodes of a session in the order in which they are stopped: first what
/// moves the arm, last the recorder. `driven` are the rows of what has a driver.
///
/// Supervisor, the process of a node, lockstep, replay and experiments know
/// of the nodes what stands here. In one tick of virtual time nodes are stepped
/// in this order, too: a recording's `/diagnostics` show it.
pub fn session_graph(driven: DrivenRows) -> Graph {
    Graph::new(vec![
        NodeRow {
            // 250 Hz for the hand of the page, where 100 Hz would do. The server's
            // threads hear the stop; the loop asks for real time itself, after them.
            period_nanos: 4_000_000,
            in_session: |session| session.console.is_some(),
            ..NodeRow::service(
                "console",
                "Serves the page",
                Priority::Supervision,
                console::run,
            )
        },
        NodeRow {
            in_session: |session| session.foxglove.is_some(),
            in_playback: |session| session.foxglove.is_some(),
            ..NodeRow::service(
                "foxglove",
                "Shows every topic to Foxglove",
                Priority::Display,
                foxglove::run,
            )
        },
        NodeRow {
            end: Some(End::Operator),
            in_session: |session| session.loaded.scenario.hand.source == HandSource::Haply,
            ..NodeRow::service(
                "haply",
                "A Haply Inverse3 as the hand",
                Priority::Hand,
                haply::run,
            )
        },
        driven.leader,
        NodeRow::step::<master::MasterPorts>(
            "master",
            "The haptic master bridge",
            Priority::Master,
            master::make,
        )
        .at(End::Operator),
        NodeRow::step::<link::LeaderLinkPorts>(
            link::LEADER,
            "The operator's end of the link",
            Priority::Link,
            link::make_leader,
        )
        .at(End::Operator),
        NodeRow::step::<link::FollowerLinkPorts>(
            link::FOLLOWER,
            "The arm's end of the link",
            Priority::Link,
            link::make_follower,
        )
        .at(End::Arm),
        NodeRow {
            end: Some(End::Arm),
            in_replay: always,
            ..NodeRow::step::<servo::ServoPorts>(
                "servo",
                "The 1 kHz joint servo with CRTK operating states",
                Priority::Servo,
                servo::make,
            )
        },
        NodeRow {
            end: Some(End::Arm),
            in_playback: |session| session.play.estimate,
            in_replay: always,
            ..NodeRow::step::<estimator::EstimatorPorts>(
                "estimator",
                "The contact-force estimator (equations 5 and 6)",
                Priority::Estimator,
                estimator::make,
            )
        },
        driven.arm,
        NodeRow {
            in_playback: always,
            ..NodeRow::service(
                "gateway",
                "Carries the topics to and from ROS 2",
                Priority::Gateway,
                gateway::run,
            )
        },
        NodeRow {
            period_nanos: 10_000_000,
            end: Some(End::Arm),
            in_session: |session| session.loaded.scenario.limits.is_some(),
            ..NodeRow::step::<limits::LimitsPorts>(
                "limits",
                "Warns before the arm comes to its limits",
                Priority::Advice,
                limits::make,
            )
        },
        NodeRow {
            end: Some(End::Arm),
            in_session: |session| !session.twins.is_empty(),
            in_playback: |session| !session.twins.is_empty(),
            in_replay: |session| !session.twins.is_empty(),
            ..NodeRow::step::<twin::TwinPorts>(
                twin::NAME,
                "The model of a joint held against it while it moves",
                Priority::Advice,
                twin::make,
            )
        },
        NodeRow {
            period_nanos: 10_000_000,
            // The page can have it record at any time.
            in_session: |session| session.bag.is_some() || session.console.is_some(),
            ..NodeRow::service(
                recorder::NAME,
                "Writes a rosbag2 directory",
                Priority::Recording,
                recorder::run,
            )
        },
        NodeRow {
            // A playback starts it once all others are ready.
            in_session: never,
            ..NodeRow::service(
                player::NAME,
                "Puts a recording back on the topics",
                Priority::Gateway,
                player::run,
            )
        },
    ])
}

//! A row of the graph: all that the program has to know of a node.

use ferntast_msgs::{
    sample::JointNames,
    topics::{JointNameError, TopicName},
};

use super::Build;
use crate::{
    node::{Ports, Ticking},
    process::{End, NodeError, Priority, ProcessContext, SessionContext},
};

/// Period of the servo loops, and least period of virtual time \[ns\].
pub const STEP_NANOS: i64 = 1_000_000;

/// Whether a node takes part, given what the session is made of.
pub type When = fn(&SessionContext) -> bool;

/// It always takes part.
pub fn always(_: &SessionContext) -> bool {
    true
}

/// It never takes part.
pub fn never(_: &SessionContext) -> bool {
    false
}

/// A node.
#[derive(Clone, Copy, Debug)]
pub struct NodeRow {
    /// On the command line and in `/diagnostics`; 24 bytes at most.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// From one step to the next \[ns\].
    pub period_nanos: i64,
    /// What its process asks the scheduler for, before it makes the node.
    pub priority: Priority,
    /// The end of the link that it belongs to; `None` for both.
    pub end: Option<End>,
    /// Whether a session runs it; in virtual time too, if it is [`Make::Step`].
    pub in_session: When,
    /// Whether the playback of a recording runs it.
    pub in_playback: When,
    /// Whether a replay feeds it the recording again and compares what it publishes.
    pub in_replay: When,
    /// What makes it.
    pub make: Make,
}

/// Names of topics, for an arm of those joints.
pub type TopicNames = fn(&JointNames) -> Result<Vec<TopicName>, JointNameError>;

/// What makes a node.
#[derive(Clone, Copy, Debug)]
pub enum Make {
    /// Something that is stepped: in a process of its own or in virtual time.
    Step {
        /// Topics that it takes.
        inputs: TopicNames,
        /// Topics that it publishes, beside `/diagnostics`.
        outputs: TopicNames,
        /// Makes it.
        make: fn(Build) -> Result<Box<dyn Ticking>, NodeError>,
    },
    /// A loop of its own, for as long as the process runs.
    Service(fn(&ProcessContext) -> Result<(), NodeError>),
}

impl NodeRow {
    /// A node that is stepped: 1 kHz, in every session.
    pub const fn step<P: Ports>(
        name: &'static str,
        about: &'static str,
        priority: Priority,
        make: fn(Build) -> Result<Box<dyn Ticking>, NodeError>,
    ) -> NodeRow {
        NodeRow {
            name,
            about,
            period_nanos: STEP_NANOS,
            priority,
            end: None,
            in_session: always,
            in_playback: never,
            in_replay: never,
            make: Make::Step {
                inputs: P::inputs,
                outputs: P::outputs,
                make,
            },
        }
    }

    /// A process beside the control path, in every session.
    pub const fn service(
        name: &'static str,
        about: &'static str,
        priority: Priority,
        run: fn(&ProcessContext) -> Result<(), NodeError>,
    ) -> NodeRow {
        NodeRow {
            name,
            about,
            period_nanos: STEP_NANOS,
            priority,
            end: None,
            in_session: always,
            in_playback: never,
            in_replay: never,
            make: Make::Service(run),
        }
    }

    /// The same at one end of the link.
    pub const fn at(self, end: End) -> NodeRow {
        NodeRow {
            end: Some(end),
            ..self
        }
    }

    /// Whether it takes part in `session` on this host.
    pub fn takes_part(&self, session: &SessionContext) -> bool {
        let is_here = self.end.is_none_or(|own| own.is_at(session.end));
        is_here && (self.in_session)(session)
    }

    /// Topics that it takes of an arm of those joints; none of a service, which
    /// goes by the table of topics.
    ///
    /// # Errors
    ///
    /// A joint's name that cannot be part of a topic's.
    pub fn inputs(&self, joints: &JointNames) -> Result<Vec<TopicName>, JointNameError> {
        match self.make {
            Make::Step { inputs, .. } => inputs(joints),
            Make::Service(_) => Ok(Vec::new()),
        }
    }

    /// Topics that it publishes beside `/diagnostics`; none of a service.
    ///
    /// # Errors
    ///
    /// As [`NodeRow::inputs`].
    pub fn outputs(&self, joints: &JointNames) -> Result<Vec<TopicName>, JointNameError> {
        match self.make {
            Make::Step { outputs, .. } => outputs(joints),
            Make::Service(_) => Ok(Vec::new()),
        }
    }
}

//! All nodes in one process and virtual time.

mod virtual_time;

use std::{cell::Cell, rc::Rc};

use ferntast_bus::{Bus, CreateError, McapBus};
use ferntast_msgs::{
    Message, Text, Time,
    sample::{
        FrictionCommand, FrictionCommandSample, LawCommandSample, StateCommand, StateCommandSample,
    },
    topics::{self, EVENT_QUEUE, Topic},
};

use crate::{
    bridge::{
        forwarder::{Forwarder, Forwarding, Stamp},
        recorder::bag_options,
    },
    graph::Graph,
    process::{NodeError, SessionContext},
    session::{Monitor, ROUND_NANOS},
};

pub use virtual_time::{VirtualTime, VirtualTimeError};

/// When the arm is armed, after the start \[ns\].
const ENABLE_AT_NANOS: i64 = 20_000_000;

/// Why lockstep cannot run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A node cannot be made.
    #[error(transparent)]
    Node(#[from] NodeError),
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// A start that is no valid time, a period that is none of virtual time.
    #[error(transparent)]
    Time(#[from] VirtualTimeError),
    /// The recording cannot be written.
    #[error("recording: {0}")]
    Recording(String),
    /// A part of the messages could not be written.
    #[error("the recording is not whole: {lost} messages could not be written (is the disk full?)")]
    Lost {
        /// How many.
        lost: u64,
    },
}

/// A scenario in virtual time.
pub struct LockstepSession {
    time: VirtualTime,
    recording: Option<McapBus>,
    /// Messages that could not be recorded.
    lost: Rc<Cell<u64>>,
    monitor: Monitor,
}

impl LockstepSession {
    /// The nodes of `graph` that a session of `session` has, on a bus in
    /// memory; `session.bag` is where to record.
    ///
    /// # Errors
    ///
    /// Configuration that cannot be used, a recording that cannot be made.
    pub fn new(graph: &Graph, session: &SessionContext) -> Result<Self, RunError> {
        let loaded = &session.loaded;
        let joints = session.joints();
        let start = Time::from_nanos(loaded.scenario.start.saturating_mul(1_000_000_000));
        let mut time = VirtualTime::new(start)?;
        let rows = graph.rows().filter(|row| row.takes_part(session));
        time.add_nodes(rows, session)?;

        let mut follower = time.bus().publisher(topics::FOLLOWER_STATE_COMMAND)?;
        let mut leader = time.bus().publisher(topics::LEADER_STATE_COMMAND)?;
        let enable_at = start.plus_nanos(ENABLE_AT_NANOS);
        time.add(move |now| {
            if now == enable_at {
                let enable = StateCommandSample::new(now, StateCommand::ENABLE);
                // Memory does not refuse what is valid.
                let _ = follower.publish(now, &enable);
                let _ = leader.publish(now, &enable);
            }
        });

        let lost = Rc::new(Cell::new(0));
        let recording = match &session.bag {
            None => None,
            Some(folder) => {
                let recording = McapBus::create_with(folder, bag_options(loaded, "lockstep"))
                    .map_err(|error| RunError::Recording(error.to_string()))?;
                let mut forwarder = Forwarder::default();
                let to = Bus::Mcap(recording.clone());
                forwarder.add_topics(time.bus(), &to, Stamp::Received, &joints, |_| {
                    Forwarding::Every { queue: EVENT_QUEUE }
                })?;
                let lost = Rc::clone(&lost);
                time.add(move |now| {
                    let forwarded = forwarder.forward(now);
                    lost.set(lost.get() + forwarded.failed);
                });
                Some(recording)
            }
        };
        let mapping = loaded.scenario.law.mapping();
        let monitor = Monitor::new(time.bus(), &joints, None)?.comparing(time.bus(), mapping)?;
        Ok(LockstepSession {
            time,
            recording,
            lost,
            monitor,
        })
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

    /// Gives a word to the master, `seconds` \[s\] after now.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn command_leader_at(
        &mut self,
        seconds: f64,
        command: StateCommand,
    ) -> Result<(), RunError> {
        let topic = topics::LEADER_STATE_COMMAND;
        self.publish_at(seconds, topic, move |now| {
            StateCommandSample::new(now, command)
        })
    }

    fn publish_at<M: Message>(
        &mut self,
        seconds: f64,
        topic: Topic<M>,
        message: impl Fn(Time) -> M + 'static,
    ) -> Result<(), RunError> {
        let mut publisher = self.time.bus().publisher(topic)?;
        let at = self.time.now().plus_nanos((seconds * 1e9) as i64);
        let mut published = false;
        self.time.add(move |now| {
            if !published && now >= at {
                published = true;
                // Memory does not refuse what is valid.
                let _ = publisher.publish(now, &message(now));
            }
        });
        Ok(())
    }

    /// Runs `seconds` \[s\] of virtual time, less where a node fails on the way:
    /// [`finish`](Self::finish) tells then.
    pub fn run(&mut self, seconds: f64) {
        // The monitor looks as often as in a session.
        let round = ROUND_NANOS as f64 / 1e9;
        let mut left = seconds;
        while left > 1e-9 {
            let slice = left.min(round);
            self.time.run(slice);
            self.monitor.update(self.time.now());
            left -= slice;
        }
    }

    /// What was seen.
    pub fn monitor(&mut self) -> &mut Monitor {
        &mut self.monitor
    }

    /// Virtual time.
    pub fn now(&self) -> Time {
        self.time.now()
    }

    /// The bus, for tests that look at every message.
    pub fn bus(&self) -> &Bus {
        self.time.bus()
    }

    /// Ends the run; closes the recording.
    ///
    /// # Errors
    ///
    /// A node that failed on the way; a recording that cannot be closed, or lacks messages.
    pub fn finish(self) -> Result<(), RunError> {
        let LockstepSession {
            mut time,
            recording,
            lost,
            ..
        } = self;
        let failure = time.take_failure();
        drop(time);
        if let Some(recording) = recording {
            recording
                .finish()
                .map_err(|error| RunError::Recording(error.to_string()))?;
        }
        match (failure, lost.get()) {
            (Some(failure), _) => Err(failure.into()),
            (None, 0) => Ok(()),
            (None, lost) => Err(RunError::Lost { lost }),
        }
    }
}

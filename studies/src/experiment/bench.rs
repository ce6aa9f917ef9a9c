//! The arm, its servo and a recorder in virtual time: what an experiment runs on.

use std::{
    cell::Cell,
    collections::BTreeMap,
    path::{Path, PathBuf},
    rc::Rc,
};

use ferntast_bag::BagOptions;
use ferntast_bus::{Bus, Depth, McapBus, Publisher, Subscriber};
use ferntast_config::{Loaded, joint_names};
use ferntast_control::servo::ServoConfig;
use ferntast_drivers::simulated;
use ferntast_lab::experiment::RECORD;
use ferntast_msgs::{
    Time,
    sample::{
        ContactStateSample, Frame, JointNames, JointSample, OperatingState, OperatingStateSample,
        PoseSample, StateCommand, StateCommandSample,
    },
    topics::{self, TopicName},
};
use ferntast_nodes::{
    bridge::forwarder::{Forwarder, Forwarding, Stamp},
    graph::STEP_NANOS,
    lockstep::{RunError, VirtualTime},
    process::SessionContext,
    session_graph,
};
use ferntast_sim::arm::ArmConfig;

use super::{
    ExperimentError,
    program::{Program, Seen, Target},
};

/// Sampling period of the paper's measurements, and of ours \[ns\].
pub const SAMPLE_NANOS: i64 = 12_000_000;
/// When the arm is armed \[ns\], and when the first command is sent.
const ENABLE_AT_NANOS: i64 = 20_000_000;
const COMMAND_AT_NANOS: i64 = 40_000_000;
/// Time to go to where the motion begins \[s\].
const SETTLE: f64 = 2.5;
/// Longest stretch between two looks at the servo's state \[s\].
const SLICE: f64 = 0.5;

/// Everything that one run needs.
pub struct Bench {
    /// For people and for the recording: the experiment's name.
    pub kind: &'static str,
    /// The arm, as it is and as it is believed.
    pub arm: ArmConfig,
    /// The servo's tuning.
    pub servo: ServoConfig,
    /// The motion.
    pub program: Box<dyn Program>,
    /// Whether the contact forces are estimated, recorded and held.
    pub contact: bool,
    /// Virtual time at the start.
    pub start: Time,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// What else the recording is to say of itself.
    pub record: BTreeMap<String, String>,
}

/// Commands that a program gives, through the servo's own topics.
struct Commander {
    program: Box<dyn Program>,
    begin: Time,
    seen: Subscriber<ContactStateSample>,
    names: JointNames,
    joints: Publisher<JointSample>,
    tip: Publisher<PoseSample>,
    state: Publisher<StateCommandSample>,
    enable_at: Time,
    command_at: Time,
}

impl Commander {
    fn step(&mut self, now: Time) {
        if now == self.enable_at {
            // Memory does not refuse what is valid.
            let _ = self
                .state
                .publish(now, &StateCommandSample::new(now, StateCommand::ENABLE));
        }
        if now < self.command_at {
            return;
        }
        let contact = self.seen.newest(now).map(|received| received.message);
        let seen = Seen {
            normal_force: contact
                .filter(|state| state.in_contact == 1)
                .map_or(0.0, |state| state.normal_force),
        };
        let time = now.seconds_since(self.begin).max(0.0);
        let dt = STEP_NANOS as f64 * 1e-9;
        let _ = match self.program.target(time, dt, &seen) {
            Target::Joints(position) => self.joints.publish(
                now,
                &JointSample::empty(self.names, now).with_position(position),
            ),
            Target::Tip([x, y]) => self
                .tip
                .publish(now, &PoseSample::at(now, Frame::FOLLOWER_BASE, [x, y, 0.0])),
        };
    }
}

/// Which topics are recorded, and how often: measurements every 12 ms.
fn carry(topic: &str, contact: bool) -> Forwarding {
    let sampled = Forwarding::Newest {
        period_nanos: SAMPLE_NANOS,
    };
    let always = [
        topics::FOLLOWER_MEASURED_JS.name,
        topics::FOLLOWER_MOTOR_JS.name,
        topics::FOLLOWER_SETPOINT_JS.name,
    ];
    let temperature = topics::FOLLOWER_JOINT_TEMPERATURE.joint_of(topic).is_some();
    let in_contact = [
        topics::FOLLOWER_MEASURED_CP.name,
        topics::FOLLOWER_CONTACT_CF.name,
        topics::FOLLOWER_CONTACT_STATE.name,
    ];
    let events = [
        topics::FOLLOWER_OPERATING_STATE.name,
        topics::FOLLOWER_STATE_COMMAND.name,
    ];
    let any = |names: &[TopicName]| names.iter().any(|name| *name == *topic);
    if temperature || any(&always) || (contact && any(&in_contact)) {
        sampled
    } else if any(&events) {
        Forwarding::Every { queue: 16 }
    } else {
        Forwarding::Not
    }
}

impl Bench {
    fn options(&mut self) -> BagOptions {
        let mut record = std::mem::take(&mut self.record);
        record.insert("mode".to_owned(), "experiment".to_owned());
        record.insert("experiment".to_owned(), self.kind.to_owned());
        record.insert("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        // Numbers and names always have a JSON form.
        let arm = serde_json::to_string(&self.arm).unwrap_or_default();
        record.insert("arm".to_owned(), arm);
        BagOptions {
            // Few messages a second: small chunks would not compress.
            flush_interval_ns: 20_000_000_000,
            custom: [(RECORD.to_owned(), record)].into(),
            ..BagOptions::default()
        }
    }

    fn commander(
        &mut self,
        bus: &Bus,
        program: Box<dyn Program>,
    ) -> Result<Commander, ExperimentError> {
        let command_at = self.start.plus_nanos(COMMAND_AT_NANOS);
        Ok(Commander {
            program,
            begin: command_at.plus_seconds(SETTLE),
            seen: bus.subscriber(topics::FOLLOWER_CONTACT_STATE, Depth::Newest)?,
            names: joint_names(&self.arm.model()),
            joints: bus.publisher(topics::FOLLOWER_SERVO_JP)?,
            tip: bus.publisher(topics::FOLLOWER_SERVO_CP)?,
            state: bus.publisher(topics::FOLLOWER_STATE_COMMAND)?,
            enable_at: self.start.plus_nanos(ENABLE_AT_NANOS),
            command_at,
        })
    }

    /// Runs the experiment into the rosbag2 directory `folder`, which must not
    /// exist yet. `progress` hears of virtual time passed \[s\]. Gives the
    /// virtual time that it took \[s\].
    ///
    /// # Errors
    ///
    /// A configuration that cannot be used, a recording that cannot be
    /// written, a servo that stopped on the way.
    pub fn run(mut self, folder: &Path, progress: &dyn Fn(f64)) -> Result<f64, ExperimentError> {
        let recording_error = |reason: String| ExperimentError::Recording {
            path: folder.to_owned(),
            reason,
        };
        let loaded = Loaded::without_operator(
            simulated::arm_file(&self.arm)?,
            self.servo.clone(),
            self.seed,
        );
        let nodes = match self.contact {
            true => &["arm", "servo", "estimator"][..],
            false => &["arm", "servo"],
        };
        let graph = session_graph(ferntast_drivers::rows());
        let rows = graph.rows().filter(|row| nodes.contains(&row.name));
        let mut time = VirtualTime::new(self.start).map_err(RunError::from)?;
        time.add_nodes(rows, &SessionContext::in_virtual_time(loaded))?;
        let program = std::mem::replace(&mut self.program, Box::new(Nothing));
        let duration = SETTLE + program.duration();
        let mut commander = self.commander(time.bus(), program)?;
        time.add(move |now| commander.step(now));

        let recording = McapBus::create_with(folder, self.options())
            .map_err(|error| recording_error(error.to_string()))?;
        let mut forwarder = Forwarder::default();
        let contact = self.contact;
        let joints = joint_names(&self.arm.model());
        forwarder.add_topics(
            time.bus(),
            &Bus::Mcap(recording.clone()),
            Stamp::Received,
            &joints,
            |topic| carry(&topic.name, contact),
        )?;
        let lost = Rc::new(Cell::new(0));
        let count = Rc::clone(&lost);
        time.add(move |now| count.set(count.get() + forwarder.forward(now).failed));

        let operating_state = topics::FOLLOWER_OPERATING_STATE;
        let mut states = time.bus().subscriber(operating_state, Depth::Queue(64))?;
        let mut stopped = None;
        let mut done = 0.0;
        while done < duration && stopped.is_none() {
            let slice = (duration - done).min(SLICE);
            time.run(slice);
            done += slice;
            progress(slice);
            let now = time.now();
            while let Some(received) = states.next(now) {
                let was_enabled = done > SLICE;
                if was_enabled && received.message.state != OperatingState::ENABLED {
                    stopped = Some(received.message);
                }
            }
        }
        drop(time);
        recording
            .finish()
            .map_err(|error| recording_error(error.to_string()))?;
        if lost.get() > 0 {
            return Err(recording_error(format!(
                "{} messages could not be written: is the disk full?",
                lost.get()
            )));
        }
        match stopped {
            None => Ok(done),
            Some(state) => Err(self.stopped(&state, folder.to_owned())),
        }
    }

    fn stopped(&self, state: &OperatingStateSample, path: PathBuf) -> ExperimentError {
        ExperimentError::Stopped {
            kind: self.kind,
            time: state.stamp.seconds_since(self.start),
            reason: state.reason.to_string(),
            path,
        }
    }
}

/// Stands in while the program is at the commander.
struct Nothing;

impl Program for Nothing {
    fn duration(&self) -> f64 {
        0.0
    }

    fn target(&mut self, _: f64, _: f64, _: &Seen) -> Target {
        Target::Joints([0.0; 2])
    }
}

//! The ROS 2 side, on a thread of its own: joint states in, commands out.
//!
//! No 1 kHz loop waits for DDS or Zenoh: joint states come through a short queue, of commands
//! there is the newest, and neither side ever waits for the other. The thread, and those of the middleware that it starts, stand behind all loops
//! of the control path and before all other programs.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use ferntast_bus::{
    Bus, DdsBus, DdsConfig, Depth, OpenError, Publisher, Subscriber, ZenohBus, ZenohConfig,
    ZenohMode,
};
use ferntast_config::{GatewaySection, Middleware};
use ferntast_model::{JointCount, Joints, MAX_JOINTS};
use ferntast_msgs::{
    Text, Time,
    sample::{ControllerCommandSample, JointNames, RobotJointsSample},
    topics::{Delivery, Topic, TopicName},
};
use ferntast_nodes::process::{Clock, Priority, end_after_a_stop, periodic};

use super::states::JointState;
use crate::newest::Newest;

/// How often the thread looks \[ns\].
const PERIOD_NANOS: i64 = 500_000;
/// How many joint states wait at most.
const QUEUE: usize = 32;
/// A command that was made longer ago is not sent any more \[s\].
const SENT_WITHIN: f64 = 0.05;
/// From one try to reach ROS 2 to the next.
const AGAIN: Duration = Duration::from_millis(500);
/// What was sent last has so long to leave.
const LAST_WORD: Duration = Duration::from_millis(20);

/// What is to be exchanged.
pub struct Wiring {
    /// How ROS 2 is reached.
    pub gateway: GatewaySection,
    /// Where joint states come from.
    pub joint_states: TopicName,
    /// Where commands go to.
    pub command: TopicName,
    /// For each place of a command the number of the arm's joint.
    pub order: Vec<usize>,
    /// The arm's joints.
    pub joints: JointNames,
    /// How many they are.
    pub count: JointCount,
    /// The session's clock.
    pub clock: Clock,
}

/// The thread, as the driver sees it.
pub struct Exchange {
    states: Receiver<JointState>,
    commands: Arc<NewestCommand>,
    problems: Receiver<Text<96>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Exchange {
    /// Starts it.
    ///
    /// # Errors
    ///
    /// The operating system gives no thread.
    pub fn start(wiring: Wiring) -> io::Result<Exchange> {
        if wiring.gateway.middleware == Middleware::Dds {
            // As in the gateway: RustDDS ends silently when a signal interrupts it.
            end_after_a_stop(
                "node arm: it was stopped for a while, which its DDS does not survive",
            )?;
        }
        let (to_driver, states) = sync_channel(QUEUE);
        let commands = Arc::new(NewestCommand::new());
        let (tell, problems) = sync_channel(QUEUE);
        let stop = Arc::new(AtomicBool::new(false));
        let worker = Worker {
            wiring,
            states: to_driver,
            commands: Arc::clone(&commands),
            problems: tell,
            stop: Arc::clone(&stop),
        };
        let thread = thread::Builder::new().name("ros2".to_owned());
        let thread = thread.spawn(move || worker.run())?;
        Ok(Exchange {
            states,
            commands,
            problems,
            stop,
            thread: Some(thread),
        })
    }

    /// The next joint state that came.
    pub fn state(&self) -> Option<JointState> {
        self.states.try_recv().ok()
    }

    /// What went wrong on the ROS 2 side since it was asked last.
    pub fn problem(&self) -> Option<Text<96>> {
        self.problems.try_iter().last()
    }

    /// Sends a command, made at `now`. Where the thread is behind, the newest counts.
    pub fn send(&self, now: Time, command: &Joints<f64>) {
        let mut values = [0.0; 1 + MAX_JOINTS];
        let [made, joints @ ..] = &mut values;
        // To a quarter of a microsecond.
        *made = now.nanos() as f64;
        for (place, value) in joints.iter_mut().zip(command.iter()) {
            *place = *value;
        }
        self.commands.write(&values);
    }

    /// Whether the thread has ended.
    pub fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for Exchange {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so.
            let _ = thread.join();
        }
    }
}

/// When a command was made \[ns\], and its values, by the arm's joints.
type NewestCommand = Newest<{ 1 + MAX_JOINTS }>;

struct Worker {
    wiring: Wiring,
    states: SyncSender<JointState>,
    commands: Arc<NewestCommand>,
    problems: SyncSender<Text<96>>,
    stop: Arc<AtomicBool>,
}

impl Worker {
    fn run(self) {
        // Where that is not allowed it goes on without, as the node says.
        let _ = Priority::ArmTransport.take();
        let Some(bus) = self.open() else { return };
        let Wiring {
            joint_states,
            command,
            ..
        } = self.wiring;
        let opened = bus
            .subscriber(
                Topic::new(joint_states, Delivery::Stream),
                Depth::Queue(QUEUE),
            )
            // Controllers take commands reliably.
            .and_then(|states| {
                let commands = bus.publisher(Topic::new(command, Delivery::Event))?;
                Ok((states, commands))
            });
        let (mut states, mut commands) = match opened {
            Ok(ports) => ports,
            Err(error) => return self.tell(Text::display(error)),
        };
        let (mut refused, mut sent) = (0, 0);
        let go_on = || !self.stop.load(Ordering::Relaxed);
        periodic::run_while(self.wiring.clock, PERIOD_NANOS, go_on, |wake| {
            self.take_in(wake.now, &mut states);
            let counts = states.counts();
            if counts.refused() > refused {
                refused = counts.refused();
                self.tell(counts.last_refusal);
            }
            self.send(wake.now, &mut sent, &mut commands);
        });
        self.send(self.wiring.clock.now(), &mut sent, &mut commands);
        thread::sleep(LAST_WORD);
    }

    /// Tries until ROS 2 can be reached: with Zenoh the session's gateway is the router, and
    /// may come later.
    fn open(&self) -> Option<Bus> {
        while !self.stop.load(Ordering::Relaxed) {
            match open_ros(&self.wiring.gateway) {
                Ok(bus) => return Some(bus),
                Err(error) => self.tell(Text::display(error)),
            }
            thread::sleep(AGAIN);
        }
        None
    }

    fn tell(&self, problem: Text<96>) {
        // Where many wait, those are told.
        let _ = self.problems.try_send(problem);
    }

    fn take_in(&self, now: Time, states: &mut Subscriber<RobotJointsSample>) {
        let Wiring { joints, count, .. } = &self.wiring;
        while let Some(received) = states.next(now) {
            let state = JointState::of(&received.message, joints, *count, now);
            // A node that does not step has no use for it.
            let _ = self.states.try_send(state);
        }
    }

    /// Sends the newest command, if it is another than the one of version `sent`.
    fn send(&self, now: Time, sent: &mut u64, commands: &mut Publisher<ControllerCommandSample>) {
        let newest = self.commands.read().filter(|(version, _)| version != sent);
        let Some((version, [made, command @ ..])) = newest else {
            return;
        };
        *sent = version;
        if now.seconds_since(Time::from_nanos(made as i64)) > SENT_WITHIN {
            return;
        }
        let order = &self.wiring.order;
        let values = Joints::from_fn(self.wiring.count, |place| command[order[place]]);
        if let Err(error) = commands.publish(now, &ControllerCommandSample::new(&values)) {
            self.tell(Text::display(error));
        }
    }
}

/// Joins ROS 2 beside the gateway, outside of the session's namespace: the robot's topics are named
/// in full.
fn open_ros(gateway: &GatewaySection) -> Result<Bus, OpenError> {
    let node_name = format!("{}_arm", gateway.node_name);
    let namespace = "/".to_owned();
    Ok(match gateway.middleware {
        Middleware::Dds => Bus::Dds(DdsBus::open(&DdsConfig {
            domain_id: gateway.domain_id,
            node_name,
            namespace,
        })?),
        Middleware::Zenoh => Bus::Zenoh(ZenohBus::open(&ZenohConfig {
            mode: ZenohMode::Connect {
                endpoint: gateway.router_endpoint.clone(),
            },
            domain_id: gateway.domain_id,
            node_name,
            namespace,
        })?),
    })
}

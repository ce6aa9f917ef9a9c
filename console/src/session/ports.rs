//! The loop's side of the console: topics of the bus.

use std::sync::Arc;

use ferntast_bus::{Bus, CreateError, Depth, Publisher, Subscriber, SubscriberCounts};
use ferntast_msgs::{
    Message, Text, Time,
    sample::{
        AuthoritySample, ContactStateSample, Frame, HealthSample, JointNames, JointSample,
        LawCommandSample, LinkCommandSample, LinkStatusSample, OperatingState,
        OperatingStateSample, PoseSample, RecorderAction, RecorderCommandSample,
        RecorderStatusSample, StateCommand, StateCommandSample, TemperatureSample, WrenchSample,
    },
    topics,
};

use super::{
    PageHand, SharedSession,
    message::{
        AuthorityView, ContactView, Holder, LinkView, NodeView, OperatorView, RecorderView,
        Request, Snapshot, StateRequest,
    },
};

/// Time between snapshots \[ns\]: 50 a second.
const SNAPSHOT_NANOS: i64 = 20_000_000;
/// Time between words on the nodes \[ns\].
const NODES_NANOS: i64 = 500_000_000;
/// A node that was not heard of for this long is stale \[s\].
const NODE_LIFE: f64 = 1.0;
/// Hands of pages are told from others by these bits of their source.
const PAGE_SOURCE: u64 = 0x7061_6765_0000_0000;

/// The newest message of a topic.
struct Newest<M: Message> {
    subscriber: Subscriber<M>,
    last: Option<M>,
}

impl<M: Message> Newest<M> {
    fn open(bus: &Bus, topic: topics::Topic<M>) -> Result<Self, CreateError> {
        Ok(Newest {
            subscriber: bus.subscriber(topic, Depth::Newest)?,
            last: None,
        })
    }

    fn take(&mut self, now: Time) -> Option<M> {
        if let Some(received) = self.subscriber.newest(now) {
            self.last = Some(received.message);
        }
        self.last
    }
}

/// The topics of the console. One [`round`](SessionPorts::round) carries out
/// what pages want, moves the hand, and shows a snapshot when one is due.
pub struct SessionPorts {
    shared: Arc<SharedSession>,
    hand: PageHand,
    joints: Newest<JointSample>,
    tip: Newest<PoseSample>,
    wanted: Newest<PoseSample>,
    force: Newest<WrenchSample>,
    contact: Newest<ContactStateSample>,
    leader: Newest<PoseSample>,
    hand_force: Newest<WrenchSample>,
    links: [Newest<LinkStatusSample>; 2],
    states: [(&'static str, Newest<OperatingStateSample>); 2],
    authority: Newest<AuthoritySample>,
    temperatures: Vec<Newest<TemperatureSample>>,
    recorder: Newest<RecorderStatusSample>,
    diagnostics: Subscriber<HealthSample>,
    nodes: Vec<HealthSample>,
    measured_cp: Publisher<PoseSample>,
    state_commands: [Publisher<StateCommandSample>; 2],
    link_command: Publisher<LinkCommandSample>,
    law_command: Publisher<LawCommandSample>,
    recorder_command: Publisher<RecorderCommandSample>,
    began: Option<Time>,
    last: Option<Time>,
    snapshot_due: Time,
    nodes_due: Time,
    failed: u64,
}

impl SessionPorts {
    /// Opens the topics on `bus`, of an arm of those joints.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn connect(
        bus: &Bus,
        joints: &JointNames,
        shared: Arc<SharedSession>,
        hand: PageHand,
    ) -> Result<Self, CreateError> {
        Ok(SessionPorts {
            shared,
            hand,
            joints: Newest::open(bus, topics::FOLLOWER_MEASURED_JS)?,
            tip: Newest::open(bus, topics::FOLLOWER_MEASURED_CP)?,
            wanted: Newest::open(bus, topics::FOLLOWER_SERVO_CP)?,
            force: Newest::open(bus, topics::FOLLOWER_MEASURED_CF)?,
            contact: Newest::open(bus, topics::FOLLOWER_CONTACT_STATE)?,
            leader: Newest::open(bus, topics::LEADER_SETPOINT_CP)?,
            hand_force: Newest::open(bus, topics::LEADER_SERVO_CF)?,
            links: [
                Newest::open(bus, topics::LINK_STATUS)?,
                Newest::open(bus, topics::LINK_FOLLOWER_STATUS)?,
            ],
            states: [
                (
                    "follower",
                    Newest::open(bus, topics::FOLLOWER_OPERATING_STATE)?,
                ),
                ("leader", Newest::open(bus, topics::LEADER_OPERATING_STATE)?),
            ],
            authority: Newest::open(bus, topics::LEADER_AUTHORITY)?,
            temperatures: topics::FOLLOWER_JOINT_TEMPERATURE
                .of_joints(joints)?
                .into_iter()
                .map(|topic| Newest::open(bus, topic))
                .collect::<Result<_, _>>()?,
            recorder: Newest::open(bus, topics::RECORDER_STATUS)?,
            diagnostics: bus.subscriber(topics::DIAGNOSTICS, Depth::Queue(topics::EVENT_QUEUE))?,
            nodes: Vec::new(),
            measured_cp: bus.publisher(topics::LEADER_MEASURED_CP)?,
            state_commands: [
                bus.publisher(topics::FOLLOWER_STATE_COMMAND)?,
                bus.publisher(topics::LEADER_STATE_COMMAND)?,
            ],
            link_command: bus.publisher(topics::LINK_COMMAND)?,
            law_command: bus.publisher(topics::LINK_LAW_COMMAND)?,
            recorder_command: bus.publisher(topics::RECORDER_COMMAND)?,
            began: None,
            last: None,
            snapshot_due: Time::INVALID,
            nodes_due: Time::INVALID,
            failed: 0,
        })
    }

    /// One round at `now`. Gives how many messages could not be sent so far.
    pub fn round(&mut self, now: Time) -> u64 {
        for wish in self.shared.wishes() {
            self.carry_out(now, wish);
        }
        self.move_hand(now);
        self.listen(now);
        if now >= self.snapshot_due {
            self.snapshot_due = now.plus_nanos(SNAPSHOT_NANOS);
            if self.shared.pages() > 0 {
                self.show(now);
            }
        }
        self.failed
    }

    /// Tells `each` the topic of every queue and what became of its messages.
    pub fn inputs(&self, each: &mut dyn FnMut(&topics::TopicName, &SubscriberCounts)) {
        each(&topics::DIAGNOSTICS.name, self.diagnostics.counts());
    }

    fn carry_out(&mut self, now: Time, wish: Request) {
        let sent = match wish {
            Request::State { word } => {
                self.command(now, word);
                return;
            }
            Request::Link {
                round_trip,
                jitter,
                loss,
            } => {
                let command = LinkCommandSample {
                    stamp: now,
                    round_trip,
                    jitter,
                    loss,
                };
                self.link_command.publish(now, &command).is_ok()
            }
            Request::Law { law } => {
                let command = LawCommandSample {
                    stamp: now,
                    law: Text::new(&law),
                };
                self.law_command.publish(now, &command).is_ok()
            }
            Request::Record { folder } => self.recorder(now, RecorderAction::START, &folder),
            Request::EndRecord => self.recorder(now, RecorderAction::STOP, ""),
            Request::Mark { label } => self.recorder(now, RecorderAction::MARK, &label),
            _ => true,
        };
        self.failed += u64::from(!sent);
    }

    fn recorder(&mut self, now: Time, action: RecorderAction, label: &str) -> bool {
        let command = RecorderCommandSample::new(now, action, label);
        self.recorder_command.publish(now, &command).is_ok()
    }

    fn command(&mut self, now: Time, word: StateRequest) {
        let command = match word {
            StateRequest::Stop => StateCommand::DISABLE,
            StateRequest::Hold => StateCommand::PAUSE,
            StateRequest::Rearm => StateCommand::RESUME,
            StateRequest::Arm => StateCommand::ENABLE,
        };
        for (publisher, (_, state)) in self.state_commands.iter_mut().zip(&mut self.states) {
            let state = state.take(now).map(|sample| sample.state);
            // A fault is left by way of disabled.
            let way_out = word == StateRequest::Arm && state == Some(OperatingState::FAULT);
            let first = way_out.then_some(StateCommand::DISABLE);
            for command in first.into_iter().chain([command]) {
                let sample = StateCommandSample::new(now, command);
                self.failed += u64::from(publisher.publish(now, &sample).is_err());
            }
        }
    }

    fn move_hand(&mut self, now: Time) {
        let lock = self.shared.look();
        let dt = self.last.map_or(0.0, |last| now.seconds_since(last));
        self.last = Some(now);
        let at = self.leader.take(now).map_or([0.0; 3], |pose| pose.position);
        let force = self.hand_force.take(now);
        let force = force.filter(|force| now.seconds_since(force.stamp) < 0.05);
        let force = force.map_or([0.0; 3], |wrench| wrench.force);
        let hand = self
            .hand
            .step(dt, lock.target(), [at[0], at[1]], [force[0], force[1]]);
        if let (Some([x, y]), Some(page)) = (hand, lock.operator()) {
            let pose = PoseSample {
                source: PAGE_SOURCE | page,
                ..PoseSample::at(now, Frame::LEADER_BASE, [x, y, 0.0])
            };
            self.failed += u64::from(self.measured_cp.publish(now, &pose).is_err());
        }
    }

    fn listen(&mut self, now: Time) {
        while let Some(received) = self.diagnostics.next(now) {
            let health = received.message;
            match self
                .nodes
                .iter_mut()
                .find(|known| known.node == health.node)
            {
                Some(known) => *known = health,
                None => self.nodes.push(health),
            }
        }
    }

    fn show(&mut self, now: Time) {
        let began = *self.began.get_or_insert(now);
        let nodes = (now >= self.nodes_due).then(|| {
            self.nodes_due = now.plus_nanos(NODES_NANOS);
            self.nodes.iter().map(|health| node(now, health)).collect()
        });
        let lock = self.shared.look();
        let joints = self.joints.take(now);
        let snapshot = Snapshot {
            r#type: "snapshot",
            t: now.seconds_since(began),
            q: joints.map(|joints| short(joints.position())),
            tau: joints.map_or([0.0; 2], |joints| short(joints.effort())),
            tip: self.tip.take(now).map(|pose| plane(pose.position)),
            wanted: self.wanted.take(now).map(|pose| plane(pose.position)),
            force: self
                .force
                .take(now)
                .map_or([0.0; 2], |wrench| plane(wrench.force)),
            contact: self.contact.take(now).map(contact).unwrap_or_default(),
            hand: self.leader.take(now).map(|pose| plane(pose.position)),
            hand_force: self
                .hand_force
                .take(now)
                .map_or([0.0; 2], |wrench| plane(wrench.force)),
            link: self.links[0].take(now).map(|status| link(&status)),
            follower_link: self.links[1].take(now).map(|status| link(&status)),
            states: self
                .states
                .iter_mut()
                .filter_map(|(device, state)| {
                    let sample = state.take(now)?;
                    let name = sample.state.name().unwrap_or("UNKNOWN").to_owned();
                    Some((*device, (name, sample.reason.to_string())))
                })
                .collect(),
            authority: self.authority.take(now).map(authority).unwrap_or_default(),
            seat: OperatorView {
                operator: lock.operator(),
                target: lock.target().map(short),
                let_go: lock.reason(),
                pages: self.shared.pages(),
            },
            temperatures: self
                .temperatures
                .iter_mut()
                .map(|each| each.take(now).map(|sample| sample.temperature as f32))
                .collect(),
            recorder: self.recorder.take(now).map(recorder).unwrap_or_default(),
            nodes,
        };
        if let Ok(text) = serde_json::to_string(&snapshot) {
            self.shared.show(text);
        }
    }
}

fn short(values: [f64; 2]) -> [f32; 2] {
    values.map(|value| value as f32)
}

fn plane(values: [f64; 3]) -> [f32; 2] {
    [values[0] as f32, values[1] as f32]
}

fn contact(state: ContactStateSample) -> ContactView {
    ContactView {
        on: state.in_contact == 1,
        valid: state.valid == 1,
        edge: state.edge.name().unwrap_or("none"),
        normal: state.normal_force as f32,
        tangential: state.tangential_force as f32,
    }
}

fn link(status: &LinkStatusSample) -> LinkView {
    let measured = |value: f64| value.is_finite().then_some(value as f32);
    LinkView {
        round_trip: measured(status.round_trip),
        delay: measured(status.delay),
        jitter: status.jitter as f32,
        loss: status.loss as f32,
        connected: status.connected == 1,
        energy_in: status.energy_in as f32,
        energy_out: status.energy_out as f32,
        dissipated: status.energy_dissipated as f32,
        law: status.law.to_string(),
    }
}

fn authority(sample: AuthoritySample) -> AuthorityView {
    let (holder, identity) = match sample.holder {
        0 => (Holder::Nobody, String::new()),
        1 => (Holder::Own, String::new()),
        page if page & 0xFFFF_FFFF_0000_0000 == PAGE_SOURCE => {
            (Holder::Page, (page & 0xFFFF_FFFF).to_string())
        }
        client => (Holder::Client, format!("{client:016x}")),
    };
    AuthorityView {
        holder,
        identity,
        refused: sample.refused_count,
        reason: sample.reason.to_string(),
    }
}

fn recorder(status: RecorderStatusSample) -> RecorderView {
    RecorderView {
        on: status.recording == 1,
        folder: status.folder.to_string(),
        messages: status.messages,
    }
}

fn node(now: Time, health: &HealthSample) -> NodeView {
    let stale = now.seconds_since(health.stamp) > NODE_LIFE;
    NodeView {
        name: health.node.to_string(),
        rate: health.rate as f32,
        late: (health.lateness_p99 * 1e6) as f32,
        level: match stale {
            true => "stale",
            false => health.level.name().unwrap_or("error"),
        },
        missed: health.missed,
        faults: health.faults.iter().map(|fault| fault.name()).collect(),
        message: health.message.to_string(),
    }
}

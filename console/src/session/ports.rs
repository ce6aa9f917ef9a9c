//! The loop's side of the console: topics of the bus.

use std::sync::Arc;

use ferntast_bus::{Bus, CreateError, Depth, Publisher, Subscriber, SubscriberCounts};
use ferntast_msgs::{
    Message, Text, Time,
    sample::{
        AuthoritySample, ContactStateSample, Frame, HealthSample, JointNames, JointSample,
        LawCommandSample, LinkCommandSample, LinkStatusSample, MAX_JOINTS, OperatingStateSample,
        PoseSample, RecorderAction, RecorderCommandSample, RecorderStatusSample,
        StateCommandSample, TemperatureSample, WrenchSample,
    },
    topics,
};

use super::{
    HandMapping, PageHand, SharedSession,
    event_log::EventLog,
    message::{
        AuthorityView, ChannelView, ContactView, Holder, LinkView, NodeView, OperatorView,
        RecorderView, Request, Snapshot, StateRequest, StateView,
    },
};

/// Time between snapshots \[ns\]: 50 a second.
const SNAPSHOT_NANOS: i64 = 20_000_000;
/// Time between words on the nodes \[ns\].
const NODES_NANOS: i64 = 500_000_000;
/// A node that was not heard of for this long is stale \[s\].
const NODE_LIFE: f64 = 1.0;
/// Operating states are told every 0.1 s; one that was not for this long is not known \[s\].
const STATE_LIFE: f64 = 1.0;
/// A contact of which nothing was heard for this long is not known \[s\].
const CONTACT_LIFE: f64 = 1.0;
/// A hand that was not measured for this long is not there \[s\].
const HAND_LIFE: f64 = 0.1;
/// Hands of pages are told from others by these bits of their source.
const PAGE_SOURCE: u64 = 0x7061_6765_0000_0000;

/// The number of the page whose hand has that source; `None` of another's.
pub fn page_of(source: u64) -> Option<u64> {
    (source & 0xFFFF_FFFF_0000_0000 == PAGE_SOURCE).then_some(source & 0xFFFF_FFFF)
}

/// The topics that tell of the arm: those of its nodes, or what is heard of it over the link.
#[derive(Clone, Copy, Debug)]
pub struct ArmTopics {
    /// Its joints.
    pub joints: topics::Topic<JointSample>,
    /// Its tip.
    pub tip: topics::Topic<PoseSample>,
    /// The contact force on the tip.
    pub force: topics::Topic<WrenchSample>,
    /// The contact.
    pub contact: topics::Topic<ContactStateSample>,
    /// Its operating state.
    pub state: topics::Topic<OperatingStateSample>,
}

/// The newest message of a topic.
struct Newest<M: Message> {
    subscriber: Subscriber<M>,
    last: Option<M>,
    /// When it was taken.
    taken: Time,
}

impl<M: Message> Newest<M> {
    fn open(bus: &Bus, topic: topics::Topic<M>) -> Result<Self, CreateError> {
        Ok(Newest {
            subscriber: bus.subscriber(topic, Depth::Newest)?,
            last: None,
            taken: Time::INVALID,
        })
    }

    fn take(&mut self, now: Time) -> Option<M> {
        if let Some(received) = self.subscriber.newest(now) {
            self.last = Some(received.message);
            self.taken = now;
        }
        self.last
    }

    /// The same, unless nothing came for `life` \[s\].
    fn living(&mut self, now: Time, life: f64) -> Option<M> {
        self.take(now)
            .filter(|_| now.seconds_since(self.taken) < life)
    }
}

/// The topics of the console. One [`round`](SessionPorts::round) carries out
/// what pages want, moves the hand, and shows a snapshot when one is due.
pub struct SessionPorts {
    shared: Arc<SharedSession>,
    hand: PageHand,
    /// Where the page's hand is, while it is held.
    held: Option<[f64; 3]>,
    mapping: HandMapping,
    joints: Newest<JointSample>,
    tip: Newest<PoseSample>,
    wanted: Newest<PoseSample>,
    force: Newest<WrenchSample>,
    contact: Newest<ContactStateSample>,
    leader: Newest<PoseSample>,
    any_hand: Newest<PoseSample>,
    hand_force: Newest<WrenchSample>,
    links: [Newest<LinkStatusSample>; 2],
    states: [(&'static str, Newest<OperatingStateSample>); 2],
    authority: Newest<AuthoritySample>,
    temperatures: Vec<Newest<TemperatureSample>>,
    recorder: Newest<RecorderStatusSample>,
    diagnostics: Subscriber<HealthSample>,
    nodes: Vec<HealthSample>,
    events: EventLog,
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
    /// Opens the topics on `bus`, of an arm of those joints, of which `arm` tells. `teller` is whose status on `/diagnostics` says what happens.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn connect(
        bus: &Bus,
        joints: &JointNames,
        arm: ArmTopics,
        shared: Arc<SharedSession>,
        hand: PageHand,
        mapping: HandMapping,
        teller: &'static str,
    ) -> Result<Self, CreateError> {
        Ok(SessionPorts {
            shared,
            hand,
            held: None,
            mapping,
            joints: Newest::open(bus, arm.joints)?,
            tip: Newest::open(bus, arm.tip)?,
            wanted: Newest::open(bus, topics::FOLLOWER_SERVO_CP)?,
            force: Newest::open(bus, arm.force)?,
            contact: Newest::open(bus, arm.contact)?,
            leader: Newest::open(bus, topics::LEADER_SETPOINT_CP)?,
            any_hand: Newest::open(bus, topics::LEADER_MEASURED_CP)?,
            hand_force: Newest::open(bus, topics::LEADER_SERVO_CF)?,
            links: [
                Newest::open(bus, topics::LINK_STATUS)?,
                Newest::open(bus, topics::LINK_FOLLOWER_STATUS)?,
            ],
            states: [
                ("follower", Newest::open(bus, arm.state)?),
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
            events: EventLog::new(teller),
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
        for (publisher, (_, state)) in self.state_commands.iter_mut().zip(&mut self.states) {
            let state = state.take(now).map(|sample| sample.state);
            if let Some(command) = word.command(state) {
                let sample = StateCommandSample::new(now, command);
                self.failed += u64::from(publisher.publish(now, &sample).is_err());
            }
        }
    }

    /// A hand that is on the master and no page's: a script's, a client's.
    fn other_hand(&mut self, now: Time) -> Option<[f64; 3]> {
        let pose = self.any_hand.take(now)?;
        let there = page_of(pose.source).is_none() && now.seconds_since(pose.stamp) < HAND_LIFE;
        there.then_some(pose.position)
    }

    /// Where a page's hand begins: where the one is that it takes the master from, else
    /// where the tip is, so that nothing moves because it is there.
    fn begin(&mut self, now: Time) -> [f64; 3] {
        let tip = |own: &mut Self| {
            let tip = own.tip.take(now)?;
            Some(own.mapping.at_hand(tip.position))
        };
        let last = |own: &mut Self| own.leader.take(now).map(|pose| pose.position);
        self.other_hand(now)
            .or_else(|| tip(self))
            .or_else(|| last(self))
            .unwrap_or_default()
    }

    /// What the channel is set to, as both of its ends tell.
    fn channel(&mut self, now: Time) -> Option<ChannelView> {
        let [leader, follower] = &mut self.links;
        let (down, up) = (leader.take(now)?, follower.take(now)?);
        Some(ChannelView {
            round_trip: (down.channel_delay + up.channel_delay) as f32,
            jitter: down.channel_jitter.max(up.channel_jitter) as f32,
            loss: down.channel_loss.max(up.channel_loss) as f32,
        })
    }

    fn move_hand(&mut self, now: Time) {
        let lock = self.shared.look();
        let dt = self.last.map_or(0.0, |last| now.seconds_since(last));
        self.last = Some(now);
        let at = self.begin(now);
        let force = self.hand_force.take(now);
        let force = force.filter(|force| now.seconds_since(force.stamp) < 0.05);
        let force = force.map_or([0.0; 3], |wrench| wrench.force);
        self.held = self.hand.step(dt, lock.target(), at, force);
        if let (Some(position), Some(page)) = (self.held, lock.operator()) {
            let pose = PoseSample {
                source: PAGE_SOURCE | page,
                ..PoseSample::at(now, Frame::LEADER_BASE, position)
            };
            self.failed += u64::from(self.measured_cp.publish(now, &pose).is_err());
        }
    }

    fn listen(&mut self, now: Time) {
        let recorder = self.recorder.take(now);
        self.shared
            .note_recording(recorder.is_some_and(|own| own.recording == 1));
        while let Some(received) = self.diagnostics.next(now) {
            let health = received.message;
            if self.events.note(&health) {
                continue;
            }
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
        let slow = now >= self.nodes_due;
        if slow {
            self.nodes_due = now.plus_nanos(NODES_NANOS);
        }
        let nodes = slow.then(|| self.nodes.iter().map(|health| node(now, health)).collect());
        let lock = self.shared.look();
        let joints = self.joints.take(now);
        let snapshot = Snapshot {
            r#type: "snapshot",
            t: now.seconds_since(began),
            q: joints.map(|joints| of_each(&joints, joints.position::<MAX_JOINTS>())),
            q_age: joints.map(|joints| now.seconds_since(joints.stamp) as f32),
            tau: joints.map_or_else(Vec::new, |joints| {
                of_each(&joints, joints.effort::<MAX_JOINTS>())
            }),
            tip: self.tip.take(now).map(|pose| short(pose.position)),
            wanted: self.wanted.take(now).map(|pose| short(pose.position)),
            force: self
                .force
                .take(now)
                .map_or([0.0; 3], |wrench| short(wrench.force)),
            contact: self.contact.living(now, CONTACT_LIFE).map(contact),
            hand: self.held.or_else(|| self.other_hand(now)).map(short),
            begin: short(self.begin(now)),
            hand_force: self.hand_force.take(now).map(|wrench| short(wrench.force)),
            link: self.links[0].take(now).map(|status| link(&status)),
            follower_link: self.links[1].take(now).map(|status| link(&status)),
            channel: self.channel(now),
            states: self
                .states
                .iter_mut()
                .filter_map(|(device, state)| {
                    let sample = state.take(now)?;
                    let view = StateView {
                        state: sample.state.name().unwrap_or("UNKNOWN"),
                        reason: sample.reason.to_string(),
                        silent: now.seconds_since(sample.stamp) > STATE_LIFE,
                    };
                    Some((*device, view))
                })
                .collect(),
            authority: self.authority.take(now).map(authority),
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
            events: slow.then(|| self.events.views(began)),
        };
        if let Ok(text) = serde_json::to_string(&snapshot) {
            self.shared.show(text);
        }
    }
}

fn short(values: [f64; 3]) -> [f32; 3] {
    values.map(|value| value as f32)
}

/// One value for each joint that there is.
fn of_each(joints: &JointSample, values: [f64; MAX_JOINTS]) -> Vec<f32> {
    let there = values.iter().take(joints.joints.len());
    there.map(|value| *value as f32).collect()
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
    let (holder, identity) = match (sample.holder, page_of(sample.holder)) {
        (0, _) => (Holder::Nobody, String::new()),
        (1, _) => (Holder::Own, String::new()),
        (_, Some(page)) => (Holder::Page, page.to_string()),
        (client, None) => (Holder::Client, format!("{client:016x}")),
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

//! Watches a session's topics: what the live line shows and the summary holds.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};

use ferntast_bus::{Bus, CreateError, Depth, SharedMemoryBus, Subscriber};
use ferntast_control::{delay::Mapping, link::SEND_PERIOD_NS};
use ferntast_identification::numerics::statistics::quantile;
use ferntast_msgs::{
    Message, Time,
    sample::{
        AuthoritySample, ContactStateSample, Edge, FrictionStatusSample, HealthSample, JointNames,
        LinkStatusSample, OperatingState, OperatingStateSample, RecorderCommandSample,
        RecorderStatusSample, StateCommandSample, WrenchSample,
    },
    topics::{self, Topic},
};

use crate::{
    events::{EventWatch, TELLER},
    process::End,
    servo::FrictionSummary,
    twin::{LastWords, TwinSummary},
};

use super::node_view::NodeView;
use super::state_times::StateTimes;
use super::summary::{
    ContactSummary, LeaderSummary, LinkSummary, NodeSummary, ServoSummary, StateSummary, TipSummary,
};
use super::thinned::Thinned;
use super::touch::TouchMeter;

/// Watches the topics of a session.
pub struct Monitor {
    diagnostics: Subscriber<HealthSample>,
    link: Subscriber<LinkStatusSample>,
    contact: Subscriber<ContactStateSample>,
    leader_force: Subscriber<WrenchSample>,
    states: [(&'static str, Subscriber<OperatingStateSample>); 2],
    state_commands: [Subscriber<StateCommandSample>; 2],
    /// When somebody told the arm or the master to stop, since this was looked at last.
    pub stops: Vec<Time>,
    authority: Subscriber<AuthoritySample>,
    /// Whose hand holds the authority; 0 while nobody's does.
    pub holder: u64,
    recorder: Subscriber<RecorderStatusSample>,
    recorder_commands: Subscriber<RecorderCommandSample>,
    /// What happens, in words.
    pub events: EventWatch,
    /// The folders that the recorder told of.
    pub recordings: BTreeSet<PathBuf>,
    twins: LastWords,
    /// Of each joint, and its last word.
    friction: Vec<(
        Subscriber<FrictionStatusSample>,
        Option<FrictionStatusSample>,
    )>,
    /// The nodes that were heard of.
    pub nodes: BTreeMap<String, NodeView>,
    /// The link's last word.
    pub link_status: Option<LinkStatusSample>,
    /// The contact's last word.
    pub contact_state: Option<ContactStateSample>,
    /// The last force in the hand \[N\].
    pub hand_force: f64,
    /// Operating states by device.
    pub operating: BTreeMap<&'static str, StateView>,
    round_trips: Thinned,
    /// The link's first word since it counts.
    first_link: Option<LinkStatusSample>,
    peak_normal_force: f64,
    peak_force: f64,
    /// Hand and tip, where it is known how they correspond.
    touch: Option<TouchMeter>,
    contact_time: f64,
    contact_stamp: Option<Time>,
    edges: Vec<String>,
    peak_hand_force: f64,
    refused_masters: u64,
    servo_rates: (f64, u64),
    updated: Time,
    /// When what counts began.
    begun: Option<Time>,
}

/// The operating states of one device.
#[derive(Debug, Default)]
pub struct StateView {
    /// The last one.
    pub last: Option<OperatingStateSample>,
    visited: Vec<String>,
    times: StateTimes,
}

impl StateView {
    /// Whether the device is in `state`.
    pub fn is(&self, state: OperatingState) -> bool {
        self.last.is_some_and(|last| last.state == state)
    }
}

/// Every message of `topic`, with the longest queue there is: the monitor's
/// rounds are tens of milliseconds long.
fn watch<M: Message>(bus: &Bus, topic: Topic<M>) -> Result<Subscriber<M>, CreateError> {
    let queue = SharedMemoryBus::max_queue(topic.delivery);
    bus.subscriber(topic, Depth::Queue(queue))
}

impl Monitor {
    /// Watches the session on `bus`, of an arm of those joints; by the operator's end of the link, or
    /// by the arm's where that is the only one here.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn new(bus: &Bus, joints: &JointNames, end: Option<End>) -> Result<Monitor, CreateError> {
        let link = match End::Operator.is_at(end) {
            true => topics::LINK_STATUS,
            false => topics::LINK_FOLLOWER_STATUS,
        };
        let friction = topics::FOLLOWER_JOINT_FRICTION.of_joints(joints)?;
        let friction = friction.into_iter().map(|topic| {
            let joint = bus.subscriber(topic, Depth::Newest)?;
            Ok((joint, None))
        });
        Ok(Monitor {
            diagnostics: watch(bus, topics::DIAGNOSTICS)?,
            link: watch(bus, link)?,
            contact: watch(bus, topics::FOLLOWER_CONTACT_STATE)?,
            leader_force: watch(bus, topics::LEADER_SERVO_CF)?,
            states: [
                ("follower", watch(bus, End::arm_state(end))?),
                ("leader", watch(bus, topics::LEADER_OPERATING_STATE)?),
            ],
            state_commands: [
                watch(bus, topics::FOLLOWER_STATE_COMMAND)?,
                watch(bus, topics::LEADER_STATE_COMMAND)?,
            ],
            stops: Vec::new(),
            authority: watch(bus, topics::LEADER_AUTHORITY)?,
            holder: 0,
            recorder: watch(bus, topics::RECORDER_STATUS)?,
            recorder_commands: watch(bus, topics::RECORDER_COMMAND)?,
            events: EventWatch::default(),
            recordings: BTreeSet::new(),
            twins: LastWords::new(bus)?,
            friction: friction.collect::<Result<_, CreateError>>()?,
            nodes: BTreeMap::new(),
            link_status: None,
            contact_state: None,
            hand_force: 0.0,
            operating: BTreeMap::new(),
            round_trips: Thinned::default(),
            first_link: None,
            peak_normal_force: 0.0,
            peak_force: 0.0,
            touch: None,
            contact_time: 0.0,
            contact_stamp: None,
            edges: Vec::new(),
            peak_hand_force: 0.0,
            refused_masters: 0,
            servo_rates: (0.0, 0),
            updated: Time::INVALID,
            begun: None,
        })
    }

    /// The same that also compares hand and tip, which correspond by `mapping`.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn comparing(self, bus: &Bus, mapping: Mapping) -> Result<Monitor, CreateError> {
        Ok(Monitor {
            touch: Some(TouchMeter::new(bus, mapping)?),
            ..self
        })
    }

    /// The operating state of a device that it told last.
    pub fn state_of(&self, device: &str) -> Option<OperatingStateSample> {
        self.operating.get(device)?.last
    }

    /// Whether frames arrive from the other end.
    pub fn is_connected(&self) -> bool {
        self.link_status.is_some_and(|link| link.connected == 1)
    }

    /// Whether `node` was heard of lately.
    pub fn is_alive(&self, node: &str, now: Time) -> bool {
        self.nodes.get(node).is_some_and(|view| view.is_alive(now))
    }

    /// Takes in what arrived until `now`.
    pub fn update(&mut self, now: Time) {
        self.updated = now;
        while let Some(received) = self.diagnostics.next(now) {
            let health = received.message;
            if health.node.as_str() == TELLER {
                continue;
            }
            self.events.health(&health);
            if health.node.as_str() == "servo" {
                self.servo_rates.0 += health.rate;
                self.servo_rates.1 += 1;
            }
            self.nodes
                .entry(health.node.to_string())
                .or_default()
                .note(health, self.begun);
        }
        while let Some(received) = self.link.next(now) {
            let status = received.message;
            if status.round_trip.is_finite() {
                self.round_trips.push(status.round_trip);
            }
            self.events.link(&status);
            self.first_link.get_or_insert(status);
            self.link_status = Some(status);
        }
        while let Some(received) = self.contact.next(now) {
            self.note_contact(received.message);
        }
        while let Some(received) = self.leader_force.next(now) {
            let force = received.message.force;
            self.hand_force = force.iter().map(|f| f * f).sum::<f64>().sqrt();
            self.peak_hand_force = self.peak_hand_force.max(self.hand_force);
        }
        for (device, subscriber) in &mut self.states {
            while let Some(received) = subscriber.next(now) {
                let view = self.operating.entry(device).or_default();
                let name = received.message.state.name().unwrap_or("UNKNOWN");
                if view.visited.last().is_none_or(|last| last != name) {
                    view.visited.push(name.to_owned());
                }
                view.times.note(&received.message);
                self.events.state(device, &received.message);
                view.last = Some(received.message);
            }
        }
        for commands in &mut self.state_commands {
            while let Some(received) = commands.next(now) {
                let told = received.message;
                if told.command.is_stop() {
                    self.stops.push(told.stamp);
                }
            }
        }
        while let Some(received) = self.authority.next(now) {
            self.events.authority(&received.message);
            self.holder = received.message.holder;
            self.refused_masters = received.message.refused_count;
        }
        while let Some(received) = self.recorder.next(now) {
            self.events.recorder(&received.message);
            let folder = received.message.folder;
            if !folder.is_empty() {
                self.recordings.insert(PathBuf::from(folder.as_str()));
            }
        }
        while let Some(received) = self.recorder_commands.next(now) {
            self.events.recorder_command(&received.message);
        }
        let follows = self
            .operating
            .get("follower")
            .and_then(|view| view.last)
            .is_some_and(|last| last.state == OperatingState::ENABLED && last.is_busy == 0);
        if let Some(touch) = &mut self.touch {
            let status = self.link_status.as_ref();
            let round_trip = status.map_or(f64::NAN, |status| status.round_trip);
            touch.update(now, self.contact_state.as_ref(), follows, round_trip);
        }
        self.twins.update(now);
        for (joint, told) in &mut self.friction {
            if let Some(received) = joint.newest(now) {
                *told = Some(received.message);
            }
        }
    }

    fn note_contact(&mut self, state: ContactStateSample) {
        if state.in_contact == 1 && state.valid == 1 {
            self.peak_normal_force = self.peak_normal_force.max(state.normal_force);
            let force = state.normal_force.hypot(state.tangential_force);
            self.peak_force = self.peak_force.max(force);
            if let Some(before) = self.contact_stamp {
                // A gap in the stream is not contact time.
                self.contact_time += state.stamp.seconds_since(before).clamp(0.0, 0.1);
            }
            self.contact_stamp = Some(state.stamp);
            if state.edge != Edge::NONE
                && let Some(name) = state.edge.name()
                && !self.edges.iter().any(|edge| edge == name)
            {
                self.edges.push(name.to_owned());
            }
        } else {
            self.contact_stamp = None;
        }
        self.contact_state = Some(state);
    }

    /// Forgets peaks and times: what counts begins at `now`.
    pub fn begin(&mut self, now: Time) {
        self.operating
            .values_mut()
            .for_each(|view| view.times.begin(now));
        self.round_trips.clear();
        self.first_link = None;
        self.peak_normal_force = 0.0;
        self.peak_force = 0.0;
        if let Some(touch) = &mut self.touch {
            touch.begin();
        }
        self.contact_time = 0.0;
        self.edges.clear();
        self.peak_hand_force = 0.0;
        self.servo_rates = (0.0, 0);
        self.nodes.values_mut().for_each(NodeView::begin);
        self.begun = Some(now);
    }

    /// The servo loop.
    pub fn servo(&self) -> ServoSummary {
        let view = self.nodes.get("servo");
        let (sum, count) = self.servo_rates;
        ServoSummary {
            rate_hz: (count > 0).then(|| sum / count as f64),
            missed: view.map_or(0, NodeView::missed),
            lateness_p99_us: view
                .and_then(|view| view.last)
                .map(|health| health.lateness_p99 * 1e6),
        }
    }

    /// The link.
    pub fn link(&mut self) -> LinkSummary {
        let mut percentile = |share: f64| {
            quantile(self.round_trips.values(), share, f64::total_cmp).map(|seconds| seconds * 1e3)
        };
        let status = self.link_status.as_ref();
        LinkSummary {
            rtt_ms: percentile(0.5),
            rtt_p99_ms: percentile(0.99),
            jitter_ms: status.map(|status| status.jitter * 1e3),
            loss: status.and_then(|status| {
                let expected = status.received + status.lost;
                (expected > 0).then(|| status.lost as f64 / expected as f64)
            }),
            sent: self
                .first_link
                .as_ref()
                .zip(status)
                .and_then(|(first, last)| share_sent(first, last)),
            law: status.map_or_else(String::new, |status| status.law.to_string()),
        }
    }

    /// The contact.
    pub fn contact(&self) -> ContactSummary {
        ContactSummary {
            peak_normal_force: self.peak_normal_force,
            peak_force: self.peak_force,
            time_s: self.contact_time,
            edges: self.edges.clone(),
        }
    }

    /// The tip.
    pub fn tip(&self) -> TipSummary {
        TipSummary {
            drift_mm: self.touch.as_ref().and_then(TouchMeter::drift_mm),
        }
    }

    /// What the hand feels of the first thing that the arm touches \[N/m\], at the tip's scale.
    pub fn felt_stiffness(&self) -> Option<f64> {
        self.touch.as_ref().and_then(TouchMeter::stiffness)
    }

    /// The operator's side.
    pub fn leader(&self) -> LeaderSummary {
        LeaderSummary {
            peak_force: self.peak_hand_force,
            refused_masters: self.refused_masters,
        }
    }

    /// The twins, by joint.
    pub fn twins(&self) -> Vec<TwinSummary> {
        self.twins.summaries()
    }

    /// The friction that the servo feeds forward.
    pub fn friction(&self) -> Vec<FrictionSummary> {
        let told = self.friction.iter().filter_map(|(_, told)| told.as_ref());
        told.map(FrictionSummary::of).collect()
    }

    /// The operating states until the last update.
    pub fn states(&mut self) -> BTreeMap<String, StateSummary> {
        let now = self.updated;
        self.operating
            .iter_mut()
            .map(|(device, view)| {
                view.times.end(now);
                let summary = StateSummary {
                    last: view.visited.last().cloned().unwrap_or_default(),
                    visited: view.visited.clone(),
                    reason: view
                        .last
                        .map_or_else(String::new, |last| last.reason.to_string()),
                    spent: view.times.spent(),
                };
                ((*device).to_owned(), summary)
            })
            .collect()
    }

    /// How long the arm was ENABLED, as far as [`Monitor::states`] counted \[s\].
    pub fn armed(&self) -> f64 {
        let arm = self.operating.get("follower");
        arm.map_or(0.0, |view| view.times.seconds_in("ENABLED"))
    }

    /// Every node that was heard of.
    pub fn node_summaries(&self, now: Time) -> BTreeMap<String, NodeSummary> {
        self.nodes
            .iter()
            .map(|(name, view)| {
                let summary = NodeSummary {
                    alive: view.is_alive(now),
                    restarts: 0,
                    rate_hz: view.last.map(|health| health.rate),
                    missed: view.missed(),
                    refused: view.last.map_or(0, |health| health.refused),
                    lost: view.lost(),
                    faults: view
                        .faults
                        .iter()
                        .map(|fault| fault.name().to_owned())
                        .collect(),
                };
                (name.clone(), summary)
            })
            .collect()
    }
}

/// Share of the link's frames that were sent between two words of one end, both ways, by the
/// 500 a second that there are; `None` where no time passed.
fn share_sent(first: &LinkStatusSample, last: &LinkStatusSample) -> Option<f64> {
    let frames = |own: &LinkStatusSample| own.sent + own.received + own.lost;
    let passed = last.stamp.nanos() - first.stamp.nanos();
    let due = 2.0 * passed as f64 / SEND_PERIOD_NS as f64;
    (due > 0.0).then(|| frames(last).saturating_sub(frames(first)) as f64 / due)
}

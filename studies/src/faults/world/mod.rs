//! Two hosts, the wire between them, and what goes wrong.

mod act;
mod other;

use std::{path::Path, rc::Rc};

use ferntast_bus::{Bus, CreateError, McapBus};
use ferntast_control::link::SHORTEST_HAND_LIFE;
use ferntast_model::ParameterError;
use ferntast_msgs::{
    Message, Time,
    sample::{StateCommand, StateCommandSample},
    topics::{self, Topic},
};
use ferntast_nodes::{
    bridge::{forwarder::Forwarder, recorder::bag_options},
    graph::Build,
    process::{NodeError, SessionContext},
};

use super::{
    arm::{Mechanics, MechanicsError},
    digest::{Digest, DigestError},
    fault::{Device, Fault, Node, Side, Word},
    gateway::Gateway,
    host::{Host, Run},
    keys::Keys,
    kit::Kit,
    log::{Log, Said},
    recorder::{Recorder, everything},
    schedule::Schedule,
    seen::{ArmTaps, OperatorTaps, Seen},
    wire::WireWay,
};
use other::{Other, open};

/// When both devices are enabled \[steps\].
const ENABLE_AT: i64 = 20;
/// A servo that was not stepped for longer begins anew \[steps\]: 10 ms, and what the clock
/// of its host may be slow by.
const HELD_UP: i64 = 13;
/// A hand that was heard of so long ago is none \[steps\].
const HAND_LIFE: i64 = 25;
/// A master that died is missed after so long: its last hand is good till then \[steps\].
const MISSED: i64 = (1e3 * SHORTEST_HAND_LIFE) as i64;
/// A link back that was silent for so long is none \[steps\].
const BACK_LIFE: i64 = 30;

/// Why a schedule cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    /// A node cannot be made.
    #[error(transparent)]
    Node(#[from] NodeError),
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// A topic cannot be opened.
    #[error(transparent)]
    Digest(#[from] DigestError),
    /// The channel.
    #[error(transparent)]
    Channel(#[from] ParameterError),
    /// The arm.
    #[error(transparent)]
    Arm(#[from] MechanicsError),
    /// The recording cannot be written.
    #[error("recording: {0}")]
    Recording(String),
}

/// What is looked at beside the invariants of each step.
#[derive(Clone, Copy, Default)]
pub struct Looks<'a> {
    /// Whether everything that is published goes into a number.
    pub digest: bool,
    /// Where to record.
    pub record: Option<&'a Path>,
}

/// Something that lasts, and until when \[step\].
struct Lasting {
    fault: Fault,
    until: i64,
}

/// Two hosts and the wire between them.
pub struct World<'a> {
    kit: &'a Kit,
    session: &'a SessionContext,
    schedule: &'a Schedule,
    next: usize,
    tick: i64,
    operator: Host<'a>,
    arm: Host<'a>,
    forth: WireWay,
    back: WireWay,
    keys: Keys,
    mechanics: Rc<Mechanics>,
    gateways: Option<[Gateway; 2]>,
    other: Option<Other<'a>>,
    lasting: Vec<Lasting>,
    taps: (OperatorTaps, ArmTaps),
    recorder: Option<Recorder>,
    digest: Option<Digest>,
    recording: Option<(McapBus, [Forwarder; 2])>,
    hand_at: i64,
    /// When the master was enabled last.
    master_at: i64,
    /// Where the hand was when a client took it \[m\].
    client: Option<[f64; 3]>,
    /// What was said and done.
    pub log: Log,
    /// The step as seen.
    pub seen: Seen,
}

impl<'a> World<'a> {
    /// The world of `schedule` in a session; `other` is that of another operator, where
    /// the schedule has one.
    ///
    /// # Errors
    ///
    /// What cannot be made.
    pub fn new(
        kit: &'a Kit,
        session: &'a SessionContext,
        other: Option<&'a SessionContext>,
        schedule: &'a Schedule,
        looks: Looks,
    ) -> Result<World<'a>, WorldError> {
        let scenario = &session.loaded.scenario;
        let start = Time::from_nanos(scenario.start.saturating_mul(1_000_000_000));
        let mut operator = Host::new(session, start);
        let mut arm = Host::new(session, start);
        let mut forth = WireWay::new(kit.link.up.clone(), schedule.seed)?;
        let mut back = WireWay::new(kit.link.down.clone(), schedule.seed ^ 0xb)?;
        let mut keys = Keys::new(session, schedule.seed, 1);
        let mechanics = Mechanics::new(&kit.arm, session)?;
        let joints = session.joints();

        let has = |wanted: &dyn Fn(&Fault) -> bool| {
            schedule.event.iter().any(|event| wanted(&event.fault))
        };
        let gated = has(&|fault| matches!(fault, Fault::Garbage { .. } | Fault::Stranger { .. }));
        let gateways = match gated {
            true => Some([
                Gateway::new(operator.bus(), scenario, joints, session.planted)?,
                Gateway::new(arm.bus(), scenario, joints, session.planted)?,
            ]),
            false => None,
        };
        let mut recorder = None;
        if has(&|fault| matches!(fault, Fault::DiskFull { .. })) {
            let mut own = Recorder::new(session.planted);
            own.add(operator.bus(), &joints)?;
            own.add(arm.bus(), &joints)?;
            recorder = Some(own);
        }
        let mut digest = None;
        if looks.digest {
            let mut own = Digest::default();
            own.add(operator.bus(), &joints)?;
            own.add(arm.bus(), &joints)?;
            digest = Some(own);
        }
        let mut recording = None;
        if let Some(folder) = looks.record {
            let options = bag_options(&session.loaded, "lockstep");
            let bag = McapBus::create_with(folder, options)
                .map_err(|error| WorldError::Recording(error.to_string()))?;
            let to = Bus::Mcap(bag.clone());
            let forwarders = [
                everything(operator.bus(), &to, &joints)?,
                everything(arm.bus(), &to, &joints)?,
            ];
            recording = Some((bag, forwarders));
        }
        let taps = (
            OperatorTaps::open(operator.bus())?,
            ArmTaps::open(arm.bus())?,
        );
        for (node, row) in Node::ALL.into_iter().zip(&kit.rows) {
            let mechanics = mechanics.clone();
            let mut open = |sends| Ok(open(&mut forth, &mut back, &mut keys, sends));
            match (node, node.side()) {
                (Node::Arm, _) => {
                    let make = Box::new(move |build: Build| mechanics.driver(build, &kit.arm));
                    arm.add(row, Some(make), &mut open)?;
                }
                (_, Side::Operator) => operator.add(row, None, &mut open)?,
                (_, Side::Arm) => arm.add(row, None, &mut open)?,
            }
        }
        let seen = Seen::first(mechanics.truth());
        let other = match other {
            Some(other) => Some(Other::new(kit, other, start, schedule.seed)?),
            None => None,
        };
        Ok(World {
            kit,
            session,
            schedule,
            next: 0,
            tick: 0,
            operator,
            arm,
            forth,
            back,
            keys,
            mechanics,
            gateways,
            other,
            lasting: Vec::new(),
            taps,
            recorder,
            digest,
            recording,
            hand_at: i64::MIN / 2,
            master_at: i64::MIN / 2,
            client: None,
            log: Log {
                sensor_wrong: i64::MIN / 2,
                operator_side_stalled: i64::MIN / 2,
                master_stalled: i64::MIN / 2,
                ..Log::default()
            },
            seen,
        })
    }

    fn host(&mut self, side: Side) -> &mut Host<'a> {
        match side {
            Side::Operator => &mut self.operator,
            Side::Arm => &mut self.arm,
        }
    }

    fn publish<M: Message>(
        &mut self,
        side: Side,
        topic: Topic<M>,
        message: impl FnOnce(Time) -> M,
    ) -> Result<(), WorldError> {
        let tick = self.tick;
        let host = self.host(side);
        let now = host.clock.now(tick);
        // Just before this step. Memory refuses nothing on the way in.
        let _ = host
            .bus()
            .publisher(topic)?
            .publish(now.plus_nanos(-1), &message(now));
        Ok(())
    }

    fn say(&mut self, device: Device, word: Word) -> Result<(), WorldError> {
        let command = match word {
            Word::Enable => StateCommand::ENABLE,
            Word::Disable => StateCommand::DISABLE,
            Word::Pause => StateCommand::PAUSE,
            Word::Resume => StateCommand::RESUME,
            Word::Clutch => StateCommand::CLUTCH,
            Word::Engage => StateCommand::ENGAGE,
        };
        let said = Said {
            tick: self.tick,
            device,
            word,
        };
        self.log.words.push(said);
        let sample = |now| StateCommandSample::new(now, command);
        if said.is_for(Device::Leader) {
            self.publish(Side::Operator, topics::LEADER_STATE_COMMAND, sample)?;
        }
        if said.is_for(Device::Follower) {
            self.publish(Side::Arm, topics::FOLLOWER_STATE_COMMAND, sample)?;
        }
        Ok(())
    }

    /// One step of everything.
    ///
    /// # Errors
    ///
    /// A node that cannot be made again, a topic that cannot be opened.
    pub fn step(&mut self) -> Result<(), WorldError> {
        let tick = self.tick;
        self.seen.tick = tick;
        if tick == ENABLE_AT {
            self.say(Device::Both, Word::Enable)?;
        }
        while let Some(event) = self.schedule.event.get(self.next) {
            if event.at_ms > tick {
                break;
            }
            self.next += 1;
            let fault = event.fault.clone();
            self.begin(fault)?;
        }
        if !self.lasting.is_empty() {
            self.go_on()?;
        }
        self.forth.deliver(tick, self.arm.clock.now(tick));
        self.back.deliver(tick, self.operator.clock.now(tick));
        self.run_nodes()?;
        self.look();
        // What comes back is heard after the way through the page's channel.
        let back_life = BACK_LIFE + self.log.channel_delay;
        if self.seen.leader.enabled() {
            self.master_at = tick;
        }
        let valid = tick - self.master_at <= MISSED
            && tick - self.hand_at <= HAND_LIFE
            && tick - self.seen.back.genuine.unwrap_or(0) <= back_life;
        self.forth.collect(tick, valid);
        self.back.collect(tick, true);
        self.tick += 1;
        Ok(())
    }

    fn run_nodes(&mut self) -> Result<(), WorldError> {
        let tick = self.tick;
        let (forth, back, keys) = (&mut self.forth, &mut self.back, &mut self.keys);
        let mut open = |sends| Ok(open(forth, back, keys, sends));
        let seen = &mut self.seen;
        let log = &mut self.log;
        self.operator.step(tick, &mut open, |node, run| {
            if run == Run::Still {
                log.operator_side_stalled = tick;
                if node == "master" {
                    log.master_stalled = tick;
                }
            }
        })?;
        self.arm
            .step(tick, &mut open, |node, run| match (node, run) {
                ("servo", Run::Stepped) => {
                    seen.servo_stepped = true;
                    seen.servo_held_up = tick - seen.servo_last > HELD_UP;
                    seen.servo_last = tick;
                }
                ("servo", Run::Still) => {
                    seen.servo_stepped = false;
                    seen.servo_held_up = false;
                    seen.arm_side_stalled = tick;
                }
                ("link_follower", Run::Still) => seen.arm_side_stalled = tick,
                ("arm", run) => seen.arm_stepped = run == Run::Stepped,
                _ => {}
            })?;
        if !self.arm.lives(Node::Arm.name()) {
            self.mechanics.coast(1e-3);
        }
        if let Some([operator, arm]) = &mut self.gateways {
            operator.round(self.operator.clock.now(tick));
            arm.round(self.arm.clock.now(tick));
        }
        if let Some(other) = &mut self.other {
            other.step(tick, &mut self.forth)?;
        }
        Ok(())
    }

    fn look(&mut self) {
        let tick = self.tick;
        let (operator, arm) = (self.operator.clock.now(tick), self.arm.clock.now(tick));
        self.taps.0.read(operator, &mut self.seen);
        self.taps.1.read(arm, &mut self.seen);
        // A dead device does nothing.
        use ferntast_msgs::sample::OperatingState;
        if !self.operator.lives(Node::Master.name()) {
            self.seen.leader.state = OperatingState::DISABLED;
        }
        if !self.arm.lives(Node::Servo.name()) {
            self.seen.follower.state = OperatingState::DISABLED;
        }
        if self.seen.accepted_hand.is_some() {
            self.hand_at = tick;
        }
        self.seen.truth = self.mechanics.truth();
        self.seen.driven = self.mechanics.driven();
        self.seen.forth = self.forth.arrivals();
        self.seen.back = self.back.arrivals();
        if let Some(digest) = &mut self.digest {
            digest.take(operator.min(arm));
        }
        let now = |place: usize| match place {
            0 => operator,
            1 => arm,
            // The bus of a session that has ended: all of it.
            _ => Time::from_nanos(i64::MAX),
        };
        if let Some(recorder) = &mut self.recorder {
            recorder.round(now);
        }
        if let Some((_, forwarders)) = &mut self.recording {
            for (place, forwarder) in forwarders.iter_mut().enumerate() {
                forwarder.forward(now(place));
            }
        }
    }

    /// Ends the run; gives the number that stands for all that was published, and
    /// what was lost without a word.
    ///
    /// # Errors
    ///
    /// The recording cannot be closed.
    pub fn finish(mut self) -> Result<(Option<u64>, Option<String>), WorldError> {
        let end = Time::from_nanos(i64::MAX);
        if let Some(digest) = &mut self.digest {
            digest.take(end);
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.round(|_| end);
        }
        if let Some((bag, mut forwarders)) = self.recording.take() {
            for forwarder in &mut forwarders {
                forwarder.forward(end);
            }
            drop(forwarders);
            bag.finish()
                .map_err(|error| WorldError::Recording(error.to_string()))?;
        }
        let lost = self.recorder.as_ref().and_then(Recorder::lost_silently);
        Ok((self.digest.as_ref().map(Digest::value), lost))
    }
}

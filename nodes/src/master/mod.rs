//! The haptic master bridge as a node.

use ferntast_control::{
    LONGEST_STEP,
    haptics::{FORCE_LIFE, HandCommand, HandRefusal, Master, MasterConfig},
    operating::OperatingState,
    orientation::Orientation,
    planted::{Planted, Rule},
};
use ferntast_emulation::hand::Hand;
use ferntast_model::ParameterError;
use ferntast_msgs::{
    Text, Time,
    sample::{
        AuthoritySample, Fault, Frame, Level, OperatingStateSample, PoseSample, StateCommand,
        StateCommandSample, WrenchSample,
    },
};

use crate::{
    graph::Build,
    node::{Node, NodeHealth, StatePublisher, Ticking, ports, to_law},
    process::NodeError,
};

/// How often the authority is published though it did not change \[ns\].
const AUTHORITY_PERIOD_NANOS: i64 = 500_000_000;
/// How sources on this host, the master's own hand among them, are told from nobody.
pub const THIS_HOST: u64 = 1;

ports! {
    /// The master's topics.
    MasterPorts for MasterNode;
    /// What the master takes.
    input MasterInput {
        measured_cp: Batch<PoseSample> = LEADER_MEASURED_CP,
        reflected_cf: Newest<WrenchSample> = LEADER_REFLECTED_CF,
        state_command: Batch<StateCommandSample> = LEADER_STATE_COMMAND,
    }
    /// What the master gives.
    output MasterOutput {
        own_hand: PoseSample = LEADER_MEASURED_CP,
        setpoint_cp: PoseSample = LEADER_SETPOINT_CP,
        servo_cf: WrenchSample = LEADER_SERVO_CF,
        authority: AuthoritySample = LEADER_AUTHORITY,
        operating_state: OperatingStateSample = LEADER_OPERATING_STATE,
    }
}

/// The node of the graph.
///
/// # Errors
///
/// A parameter out of its bounds, a hand that is not there, a topic that
/// cannot be opened.
pub fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    let node = MasterNode::new(&loaded.scenario.master, loaded.hand()?)?;
    let node = node.planted(build.session.planted);
    let ports = MasterPorts::connect(build.bus, &build.session.joints())?;
    build.join(node, ports)
}

/// The haptic master bridge: validates the hand, decides who holds the
/// authority, renders the reflected force.
pub struct MasterNode {
    master: Master,
    /// A hand of its own; without one, clients are the hand.
    hand: Option<Hand>,
    /// A client took the master: the own hand has let go for good.
    taken: bool,
    force: [f64; 3],
    last: Option<Time>,
    states: StatePublisher,
    /// Holder, refused source, how many were refused, whether the clutch is open.
    authority: Option<(u64, u64, u64, bool)>,
    authority_due: Time,
    message: Text<96>,
    planted: Planted,
}

impl MasterNode {
    /// A master, disabled. `hand` is its own hand, if it has one.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds.
    pub fn new(config: &MasterConfig, hand: Option<Hand>) -> Result<MasterNode, ParameterError> {
        Ok(MasterNode {
            master: Master::new(config)?,
            hand,
            taken: false,
            force: [0.0; 3],
            last: None,
            states: StatePublisher::default(),
            authority: None,
            authority_due: Time::INVALID,
            message: Text::EMPTY,
            planted: Planted::NONE,
        })
    }

    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> MasterNode {
        MasterNode {
            master: self.master.planted(planted),
            planted,
            ..self
        }
    }

    fn offer(&mut self, now: Time, pose: &PoseSample, health: &mut NodeHealth) {
        if pose.frame != Frame::LEADER_BASE {
            health.raise(Fault::CommandInvalid, Level::WARN);
            self.message =
                Text::new("/leader/measured_cp refused: header.frame_id must be leader_base");
            return;
        }
        let command = HandCommand {
            stamp_ns: pose.stamp.nanos(),
            source: pose.source.max(THIS_HOST),
            position: pose.position,
            orientation: Orientation::given(pose.orientation),
        };
        if let Err(refusal) = self.master.offer(now.nanos(), &command) {
            let fault = match refusal {
                // Before it is enabled, nothing is wrong with a hand that moves.
                HandRefusal::NotEnabled { .. } => return,
                HandRefusal::OutOfRange { .. } => Fault::CommandOutOfRange,
                HandRefusal::Jump { .. } => Fault::CommandJumped,
                HandRefusal::NotAuthorised(_) => Fault::CommandUnauthorised,
                _ => Fault::CommandInvalid,
            };
            health.raise(fault, Level::WARN);
            self.message = Text::display(refusal);
        }
    }

    fn publish_authority(&mut self, now: Time, clutched: bool) -> Option<AuthoritySample> {
        let authority = self.master.authority();
        let sample = AuthoritySample {
            holder: authority.holder().unwrap_or(0),
            refused: authority.refused().unwrap_or(0),
            refused_count: authority.refused_count(),
            ..AuthoritySample::initial(now)
        };
        let (holder, refused) = (sample.holder, sample.refused);
        let changed = self
            .authority
            .is_none_or(|(h, r, _, c)| (h, r, c) != (holder, refused, clutched));
        if !changed && now < self.authority_due {
            return None;
        }
        self.authority = Some((holder, refused, sample.refused_count, clutched));
        self.authority_due = now.plus_nanos(AUTHORITY_PERIOD_NANOS);
        let reason = match (holder, refused) {
            (1.., _) if clutched => "the clutch is open: the hand moves, the arm stays; say engage",
            (0, _) => "nobody: the first valid hand takes it",
            (_, 0) => "held by the first valid hand",
            _ => {
                "another hand was refused; it is free when the holder is silent or the master disabled"
            }
        };
        Some(AuthoritySample {
            reason: Text::new(reason),
            ..sample
        })
    }
}

impl Node for MasterNode {
    type Input = MasterInput;
    type Output = MasterOutput;

    fn step(&mut self, now: Time, input: &MasterInput, output: &mut MasterOutput) {
        for sample in input.state_command.iter() {
            let refused = match (sample.command, to_law(sample.command)) {
                (StateCommand::CLUTCH | StateCommand::ENGAGE, _) => {
                    let opens = sample.command == StateCommand::CLUTCH;
                    self.master.set_clutch(opens).err().map(Text::display)
                }
                (_, Some(command)) => self.master.command(command).err().map(Text::display),
                (_, None) => None,
            };
            if let Some(refusal) = refused {
                output.health.raise(Fault::StateCommandRefused, Level::WARN);
                self.message = refusal;
            }
        }
        let since = |last| now.seconds_since(last).clamp(0.0, LONGEST_STEP);
        let dt = self.last.map_or(0.0, since);
        self.last = Some(now);

        // The own hand moves only once the master is enabled: a script starts then.
        let running = self.master.state() != OperatingState::Disabled;
        let client = |pose: &PoseSample| pose.source > THIS_HOST;
        let owned = self.hand.is_some();
        if owned && !self.taken && running && input.measured_cp.iter().any(client) {
            self.taken = true;
            self.master.release_authority();
        }
        if let Some(hand) = self.hand.as_mut().filter(|_| !self.taken) {
            let moved = hand.step(if running { dt } else { 0.0 }, self.force);
            let mut pose = PoseSample::at(now, Frame::LEADER_BASE, moved.position);
            pose.orientation = moved.orientation.unwrap_or(pose.orientation);
            self.offer(now, &pose, &mut output.health);
            output.own_hand = Some(pose);
        } else {
            // What the own hand said last does not count any more.
            let counts = |pose: &&PoseSample| !owned || client(pose);
            for pose in input.measured_cp.iter().filter(counts) {
                self.offer(now, pose, &mut output.health);
            }
        }

        let reflected = input
            .reflected_cf
            .message
            .filter(|_| {
                input.reflected_cf.silence(now) <= FORCE_LIFE || self.planted.lacks(Rule::ForceLife)
            })
            .map(|wrench| wrench.force);
        let step = self.master.step(now.nanos(), dt, reflected);
        self.force = step.force;
        if step.fresh
            && let Some(hand) = step.hand
        {
            let at = PoseSample::at(now, Frame::LEADER_BASE, hand.position);
            let turned = step.orientation.map(|own| own.quaternion());
            output.setpoint_cp = Some(PoseSample {
                orientation: turned.unwrap_or(at.orientation),
                ..at
            });
        }
        output.servo_cf = Some(WrenchSample::force(now, Frame::LEADER_BASE, step.force));
        output.authority = self.publish_authority(now, step.clutched);
        output.operating_state = self.states.publish(now, step.state, step.reason, false);

        let health = &mut output.health;
        health.input_age = step.hand_age;
        if step.force_limited {
            health.raise(Fault::ForceLimited, Level::OK);
        }
        if step.state == OperatingState::Enabled && step.hand.is_none() && step.hand_age.is_finite()
        {
            health.raise(Fault::CommandSilent, Level::WARN);
        }
        let counts = self.master.refusals();
        health.refused =
            counts.invalid + counts.time + counts.out_of_range + counts.jump + counts.unauthorised;
        health.message = self.message;
    }
}

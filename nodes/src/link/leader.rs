//! The operator's end of the link.

use ferntast_control::{
    link::{LeaderLink, LeaderReadings},
    operating,
    orientation::Orientation,
    switching,
    view::{ArmView, Reason, View},
};
use ferntast_msgs::{
    Text, Time,
    sample::{
        ContactStateSample, Edge, Fault, Frame, JointNames, JointSample, LawCommandSample, Level,
        LinkCommandSample, LinkEnd, LinkPeerSample, LinkStatusSample, OperatingState,
        OperatingStateSample, PoseSample, StateCommand, StateCommandSample, WrenchSample,
    },
};

use super::{
    FrameInput, FrameOutput,
    readings::{operating_state, position},
    status::{PeerWatch, Status},
    transport::LinkNode,
};
use crate::node::{Node, NodeHealth, ports};

ports! {
    /// The leader end's topics.
    LeaderLinkPorts for LeaderLinkNode;
    /// What the leader end takes.
    input LeaderLinkInput {
        setpoint_cp: Newest<PoseSample> = LEADER_SETPOINT_CP,
        servo_cf: Newest<WrenchSample> = LEADER_SERVO_CF,
        operating_state: Newest<OperatingStateSample> = LEADER_OPERATING_STATE,
        state_command: Batch<StateCommandSample> = LEADER_STATE_COMMAND,
        law_command: Batch<LawCommandSample> = LINK_LAW_COMMAND,
        link_command: Newest<LinkCommandSample> = LINK_COMMAND,
    }
    extra { frames: FrameInput, }
    /// What the leader end gives.
    output LeaderLinkOutput {
        reflected_cf: WrenchSample = LEADER_REFLECTED_CF,
        status: LinkStatusSample = LINK_STATUS,
        peer: LinkPeerSample = LINK_PEER,
        arm_state: OperatingStateSample = LINK_ARM_STATE,
        arm_js: JointSample = LINK_ARM_MEASURED_JS,
        arm_cp: PoseSample = LINK_ARM_MEASURED_CP,
        arm_cf: WrenchSample = LINK_ARM_MEASURED_CF,
        arm_contact: ContactStateSample = LINK_ARM_CONTACT_STATE,
    }
    extra { frame: FrameOutput, }
}

/// The operator's end of the link.
pub struct LeaderLinkNode {
    link: LeaderLink,
    /// The arm can turn its tool.
    turns: bool,
    /// Of the arm, as they are called here.
    joints: JointNames,
    status: Status,
    /// A law that was asked for and is not there.
    unknown_law: Option<Text<24>>,
    peers: PeerWatch,
    /// Why the arm is in its state, as was told last.
    reason: Option<Reason>,
}

impl LeaderLinkNode {
    /// The end `link` of the session of that number, of an arm of those `joints`. To one that
    /// `turns` its tool, the hand's orientation is sent, too.
    pub fn new(link: LeaderLink, session: u16, joints: JointNames, turns: bool) -> LeaderLinkNode {
        LeaderLinkNode {
            link,
            turns,
            joints,
            status: Status::new(LinkEnd::LEADER, session),
            unknown_law: None,
            peers: PeerWatch::default(),
            reason: None,
        }
    }

    /// What the arm's end shows of its arm, and when it was so; `None` where nothing newer came.
    fn look(&mut self, frames: &FrameInput, health: &mut NodeHealth) -> Option<(Time, ArmView)> {
        let (bytes, arrived) = frames.view()?;
        let mut wrong = |message| {
            health.raise(Fault::MeasurementInvalid, Level::WARN);
            health.message = message;
        };
        let sent = match self.link.view_arrived(bytes, arrived.nanos()) {
            Ok(sent) => sent?,
            Err(error) => {
                wrong(Text::display(error));
                return None;
            }
        };
        let view = match sent.view {
            View::Arm(view) => view,
            View::Reason(reason) => {
                self.reason = Some(reason);
                return None;
            }
        };
        let (there, here) = (view.joints.len(), self.joints.len());
        if there != here {
            wrong(Text::display(format_args!(
                "the arm there has {there} joints, here {here}: --arm differs"
            )));
            return None;
        }
        Some((Time::from_nanos(sent.sent_ns), view))
    }

    /// The arm's state as its end says it, with why it is in it, where that was told.
    fn arm_state(&self, now: Time, state: operating::OperatingState) -> OperatingStateSample {
        let why = self.reason.as_ref().filter(|own| own.state == state);
        let why = why.map_or("told over the link", Reason::text);
        OperatingStateSample::new(now, OperatingState(state.code()), why)
    }
}

/// Puts what was shown of the arm at `stamp` into messages.
fn tell(stamp: Time, view: &ArmView, joints: JointNames, output: &mut LeaderLinkOutput) {
    let positions = view.joints.map(|own| f64::from(*own)).into_places(0.0);
    output.arm_js = Some(JointSample::empty(joints, stamp).with_position(positions));
    let place = view.tip.map(f64::from);
    output.arm_cp = Some(PoseSample {
        orientation: [0.0; 4],
        ..PoseSample::at(stamp, Frame::FOLLOWER_BASE, place)
    });
    let force = view.force.map(f64::from);
    output.arm_cf = Some(WrenchSample::force(stamp, Frame::FOLLOWER_BASE, force));
    let contact = &view.contact;
    // A code of a newer program.
    let edge = Some(Edge(contact.edge)).filter(|own| own.name().is_some());
    let [normal_force, tangential_force] = contact.forces.map(f64::from);
    output.arm_contact = Some(ContactStateSample {
        in_contact: u8::from(contact.in_contact),
        touches: u8::from(contact.touches),
        valid: u8::from(contact.valid),
        near_rest: u8::from(contact.near_rest),
        edge: edge.unwrap_or(Edge::NONE),
        normal_force,
        tangential_force,
        friction_coefficient: f64::NAN,
        friction_coefficient_error: f64::INFINITY,
        ..ContactStateSample::initial(stamp)
    });
}

impl LinkNode for LeaderLinkNode {
    fn frames(input: &mut LeaderLinkInput) -> &mut FrameInput {
        &mut input.frames
    }

    fn frame(output: &LeaderLinkOutput) -> &FrameOutput {
        &output.frame
    }

    fn command(input: &LeaderLinkInput) -> Option<&LinkCommandSample> {
        input.link_command.fresh()
    }
}

impl Node for LeaderLinkNode {
    type Input = LeaderLinkInput;
    type Output = LeaderLinkOutput;

    fn step(&mut self, now: Time, input: &LeaderLinkInput, output: &mut LeaderLinkOutput) {
        for sample in input.state_command.iter() {
            if sample.command == StateCommand::RESUME {
                self.link.rearm();
            }
        }
        for sample in input.law_command.iter() {
            let known = switching::code(sample.law.as_str());
            let taken = known.is_some_and(|code| self.link.switch_to(code));
            self.unknown_law = (!taken).then_some(sample.law);
        }
        let peer = &input.frames.peer;
        if let Some(other) = self.peers.changed(peer) {
            self.link.peer_changed(now.nanos(), other.clock_offset_ns);
            self.reason = None;
        }
        for (bytes, arrived) in input.frames.iter() {
            self.link.arrived(bytes, arrived.nanos());
        }
        let hand = input.setpoint_cp.message;
        let readings = LeaderReadings {
            hand: position(now, &input.setpoint_cp),
            orientation: hand
                .filter(|_| self.turns)
                .and_then(|own| Orientation::given(own.orientation)),
            state: operating_state(now, &input.operating_state),
        };
        if let Some((stamp, view)) = self.look(&input.frames, &mut output.health) {
            tell(stamp, &view, self.joints, output);
        }
        let step = self.link.step(now.nanos(), &readings);
        // With the pose of this step the master published the force from there on.
        let rendered = input.servo_cf.message.map(|wrench| wrench.force);
        self.link.rendered(rendered.unwrap_or_default());
        output.reflected_cf = Some(WrenchSample::force(now, Frame::LEADER_BASE, step.force));
        output.frame.frame = step.frame;
        let state = self.link.state(now.nanos());
        output.status = self.status.step(now, &state, &input.frames);
        output.peer = self.status.peer(now, &state, peer);
        // Told as often, once there is somebody.
        let told = output.peer.filter(|own| own.handshakes > 0);
        output.arm_state = told.map(|_| self.arm_state(now, state.peer));
        if let Some(law) = &self.unknown_law {
            output.health.raise(Fault::CommandInvalid, Level::WARN);
            output.health.message = Text::display(format_args!(
                "/link/law_command: no law {:?} here",
                law.as_str()
            ));
        }
        self.peers
            .report(&state, peer, "the arm's end", &mut output.health);
    }
}

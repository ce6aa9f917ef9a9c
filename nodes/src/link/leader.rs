//! The operator's end of the link.

use ferntast_control::{
    link::{LeaderLink, LeaderReadings},
    orientation::Orientation,
    switching,
};
use ferntast_msgs::{
    Text, Time,
    sample::{
        Fault, Frame, LawCommandSample, Level, LinkCommandSample, LinkEnd, LinkPeerSample,
        LinkStatusSample, OperatingState, OperatingStateSample, PoseSample, StateCommand,
        StateCommandSample, WrenchSample,
    },
};

use super::{
    FrameInput, FrameOutput,
    readings::{operating_state, position},
    status::{PeerWatch, Status},
    transport::LinkNode,
};
use crate::node::{Node, ports};

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
    }
    extra { frame: FrameOutput, }
}

/// The operator's end of the link.
pub struct LeaderLinkNode {
    link: LeaderLink,
    /// The arm can turn its tool.
    turns: bool,
    status: Status,
    /// A law that was asked for and is not there.
    unknown_law: Option<Text<24>>,
    peers: PeerWatch,
}

impl LeaderLinkNode {
    /// The end `link` of the session of that number. To an arm that `turns` its tool, the hand's
    /// orientation is sent, too.
    pub fn new(link: LeaderLink, session: u16, turns: bool) -> LeaderLinkNode {
        LeaderLinkNode {
            link,
            turns,
            status: Status::new(LinkEnd::LEADER, session),
            unknown_law: None,
            peers: PeerWatch::default(),
        }
    }
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
        let arm = OperatingState(state.peer.code());
        output.arm_state = told.map(|_| OperatingStateSample::new(now, arm, "told over the link"));
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

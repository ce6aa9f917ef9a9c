//! The arm's end of the link.

use ferntast_control::{
    link::{ESTIMATE_LIFE, FollowerLink, FollowerReadings, Word},
    operating::OperatingState,
    view::{ArmView, ContactView, Reason, ViewSender},
};
use ferntast_model::Joints;
use ferntast_msgs::{
    Text, Time,
    sample::{
        ContactStateSample, Fault, Frame, JointSample, Level, LinkCommandSample, LinkEnd,
        LinkPeerSample, LinkStatusSample, OperatingStateSample, PoseSample, StateCommand,
        StateCommandSample, WrenchSample,
    },
};

use super::{
    FrameInput, FrameOutput,
    readings::{operating_state, position},
    status::{PeerWatch, Status, TOLD_STEPS},
    transport::LinkNode,
};
use crate::node::{Node, ports};

ports! {
    /// The follower end's topics.
    FollowerLinkPorts for FollowerLinkNode;
    /// What the follower end takes.
    input FollowerLinkInput {
        measured_js: Newest<JointSample> = FOLLOWER_MEASURED_JS,
        measured_cp: Newest<PoseSample> = FOLLOWER_MEASURED_CP,
        measured_cf: Newest<WrenchSample> = FOLLOWER_MEASURED_CF,
        contact_state: Newest<ContactStateSample> = FOLLOWER_CONTACT_STATE,
        operating_state: Newest<OperatingStateSample> = FOLLOWER_OPERATING_STATE,
        told: Batch<StateCommandSample> = FOLLOWER_STATE_COMMAND,
        link_command: Newest<LinkCommandSample> = LINK_COMMAND,
    }
    extra { frames: FrameInput, }
    /// What the follower end gives.
    output FollowerLinkOutput {
        servo_cp: PoseSample = FOLLOWER_SERVO_CP,
        state_command: StateCommandSample = FOLLOWER_STATE_COMMAND,
        status: LinkStatusSample = LINK_FOLLOWER_STATUS,
        peer: LinkPeerSample = LINK_FOLLOWER_PEER,
    }
    extra { frame: FrameOutput, }
}

/// The arm's end of the link.
pub struct FollowerLinkNode {
    link: FollowerLink,
    status: Status,
    peers: PeerWatch,
    /// Steps in which it is still told that a word was outdated.
    outdated: u32,
    /// Shows the arm to the other end.
    view: Option<ViewSender>,
}

/// An arm that was not measured for this long is not shown \[s\].
const VIEW_LIFE: f64 = 0.1;

impl FollowerLinkNode {
    /// The end `link` of the session of that number.
    pub fn new(link: FollowerLink, session: u16) -> FollowerLinkNode {
        FollowerLinkNode {
            link,
            status: Status::new(LinkEnd::FOLLOWER, session),
            peers: PeerWatch::default(),
            outdated: 0,
            view: None,
        }
    }

    /// The same, which shows its arm to the other end, as people on another host do not see it.
    pub fn showing(self) -> FollowerLinkNode {
        FollowerLinkNode {
            view: Some(ViewSender::default()),
            ..self
        }
    }
}

impl LinkNode for FollowerLinkNode {
    fn frames(input: &mut FollowerLinkInput) -> &mut FrameInput {
        &mut input.frames
    }

    fn frame(output: &FollowerLinkOutput) -> &FrameOutput {
        &output.frame
    }

    fn command(input: &FollowerLinkInput) -> Option<&LinkCommandSample> {
        input.link_command.fresh()
    }
}

/// The force on the tip as the law takes it; `None` when it cannot be told.
fn contact_force(now: Time, input: &FollowerLinkInput) -> Option<[f64; 3]> {
    let state = input.contact_state.message?;
    let wrench = input.measured_cf.message?;
    let old = input
        .measured_cf
        .silence(now)
        .max(input.contact_state.silence(now))
        > ESTIMATE_LIFE;
    let valid = !old && state.valid == 1;
    FollowerReadings::force_of(valid, state.touches == 1, wrench.force)
}

/// The arm as the other end sees it; `None` where it is not measured.
fn view(now: Time, input: &FollowerLinkInput) -> Option<ArmView> {
    let (joints, tip) = (&input.measured_js, &input.measured_cp);
    if joints.silence(now).max(tip.silence(now)) > VIEW_LIFE {
        return None;
    }
    let joints = joints.message.as_ref()?;
    let places = joints.position.map(|own| own as f32);
    let contact = input.contact_state.message.map(|own| ContactView {
        in_contact: own.in_contact == 1,
        touches: own.touches == 1,
        valid: own.valid == 1,
        near_rest: own.near_rest == 1,
        edge: own.edge.0,
        forces: [own.normal_force as f32, own.tangential_force as f32],
    });
    let force = input.measured_cf.message.map(|own| own.force);
    Some(ArmView {
        joints: Joints::from_slice(places.get(..joints.joints.len())?).ok()?,
        tip: tip.message?.position.map(|own| own as f32),
        force: force.unwrap_or_default().map(|own| own as f32),
        contact: contact.unwrap_or_default(),
    })
}

impl Node for FollowerLinkNode {
    type Input = FollowerLinkInput;
    type Output = FollowerLinkOutput;

    fn step(&mut self, now: Time, input: &FollowerLinkInput, output: &mut FollowerLinkOutput) {
        let peer = &input.frames.peer;
        if let Some(other) = self.peers.changed(peer) {
            self.link.peer_changed(now.nanos(), other.clock_offset_ns);
        }
        for (bytes, arrived) in input.frames.iter() {
            self.link.arrived(bytes, arrived.nanos());
        }
        let readings = FollowerReadings {
            tip: position(now, &input.measured_cp),
            contact_force: contact_force(now, input),
            state: operating_state(now, &input.operating_state),
            told_to_stop: input.told.iter().any(|own| own.command.is_stop()),
        };
        let step = self.link.step(now.nanos(), &readings);
        let command = match (step.word, step.resume_after_gap) {
            (Some(Word::Rearm), _) => Some(StateCommand::RESUME),
            (Some(Word::Stop), _) => Some(StateCommand::PAUSE),
            (_, true) => Some(StateCommand::RESUME_AFTER_GAP),
            (_, false) => None,
        };
        output.state_command = command.map(|own| StateCommandSample::new(now, own));
        output.servo_cp = step.command.map(|tip| {
            let made = Time::from_nanos(step.command_ns);
            let at = PoseSample::at(made, Frame::FOLLOWER_BASE, tip.position);
            let hand = step.orientation.map(|own| own.quaternion());
            PoseSample {
                orientation: hand.unwrap_or(at.orientation),
                ..at
            }
        });
        output.frame.frame = step.frame;
        output.frame.view = self.view.as_mut().and_then(|own| {
            let said = input.operating_state.message.as_ref();
            let reason = said.and_then(|own| {
                let state = OperatingState::from_code(own.state.0)?;
                Some(Reason::new(state, own.reason.as_str()))
            });
            own.step(now.nanos(), reason, || view(now, input))
        });
        let state = self.link.state(now.nanos());
        output.status = self.status.step(now, &state, &input.frames);
        output.peer = self.status.peer(now, &state, peer);
        self.peers
            .report(&state, peer, "the operator's end", &mut output.health);
        if step.word == Some(Word::Outdated) {
            self.outdated = TOLD_STEPS;
        }
        if self.outdated > 0 {
            self.outdated -= 1;
            output.health.raise(Fault::StateCommandRefused, Level::WARN);
            output.health.message = Text::new(
                "resume was said before the operator's end knew that the arm had stopped; say it again",
            );
        }
    }
}

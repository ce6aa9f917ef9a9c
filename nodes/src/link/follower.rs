//! The arm's end of the link.

use ferntast_control::{
    delay::{FollowerEnd, FollowerInput, Law, Motion},
    frame::ArmingWatch,
    operating::OperatingState,
};
use ferntast_msgs::{
    Text, Time,
    sample::{
        ContactStateSample, Fault, Frame, Level, LinkCommandSample, LinkEnd, LinkStatusSample,
        OperatingStateSample, PoseSample, StateCommand, StateCommandSample, WrenchSample,
    },
};

use super::{FrameInput, FrameOutput, end::End, transport::LinkNode, velocity::VelocityFilter};
use crate::node::{Node, ports};

/// An estimate older than this \[s\] is not sent.
const ESTIMATE_LIFE: f64 = 0.010;

ports! {
    /// The follower end's topics.
    FollowerLinkPorts for FollowerLinkNode;
    /// What the follower end takes.
    input FollowerLinkInput {
        measured_cp: Newest<PoseSample> = FOLLOWER_MEASURED_CP,
        measured_cf: Newest<WrenchSample> = FOLLOWER_MEASURED_CF,
        contact_state: Newest<ContactStateSample> = FOLLOWER_CONTACT_STATE,
        operating_state: Newest<OperatingStateSample> = FOLLOWER_OPERATING_STATE,
        link_command: Newest<LinkCommandSample> = LINK_COMMAND,
    }
    extra { frames: FrameInput, }
    /// What the follower end gives.
    output FollowerLinkOutput {
        servo_cp: PoseSample = FOLLOWER_SERVO_CP,
        state_command: StateCommandSample = FOLLOWER_STATE_COMMAND,
        status: LinkStatusSample = LINK_FOLLOWER_STATUS,
    }
    extra { frame: FrameOutput, }
}

/// The arm's end of the link.
pub struct FollowerLinkNode {
    end: End,
    name: &'static str,
    law: FollowerEnd,
    velocity: VelocityFilter,
    arming: ArmingWatch,
}

impl FollowerLinkNode {
    /// An end that runs `law`.
    pub fn new(law: &Law, session: u16) -> FollowerLinkNode {
        FollowerLinkNode {
            end: End::new(LinkEnd::FOLLOWER, session),
            name: law.name(),
            law: law.follower(),
            velocity: VelocityFilter::default(),
            arming: ArmingWatch::default(),
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

/// The force on the tip while in contact; zero while it is free: the estimate
/// is noise then. `None` when it cannot be told.
fn contact_force(now: Time, input: &FollowerLinkInput) -> Option<[f64; 3]> {
    let state = input.contact_state.message?;
    let wrench = input.measured_cf.message?;
    let old = input
        .measured_cf
        .silence(now)
        .max(input.contact_state.silence(now))
        > ESTIMATE_LIFE;
    if old || state.valid == 0 {
        return None;
    }
    Some(if state.in_contact == 1 {
        wrench.force
    } else {
        [0.0; 3]
    })
}

impl Node for FollowerLinkNode {
    type Input = FollowerLinkInput;
    type Output = FollowerLinkOutput;

    fn step(&mut self, now: Time, input: &FollowerLinkInput, output: &mut FollowerLinkOutput) {
        if let Some(frame) = self.end.receive(&input.frames)
            && self.arming.observe(frame.arming)
        {
            output.state_command = Some(StateCommandSample::new(now, StateCommand::RESUME));
        }
        let tip: Option<Motion> = input
            .measured_cp
            .message
            .as_ref()
            .map(|pose| self.velocity.step(pose))
            .filter(|_| input.measured_cp.silence(now) <= ESTIMATE_LIFE);
        let dt = self.end.elapsed(now);
        let connected = self.end.connected(now);
        let step = self.law.step(
            dt,
            &FollowerInput {
                tip,
                contact_force: contact_force(now, input),
                received: self.end.received(now),
                connected,
            },
        );
        if let Some(command) = step.command {
            output.servo_cp = Some(PoseSample::at(now, Frame::FOLLOWER_BASE, command.position));
        }
        let state = input
            .operating_state
            .message
            .and_then(|sample| OperatingState::from_code(sample.state.0))
            .unwrap_or(OperatingState::Disabled);
        self.end.send(now, state, 0, step.packet, &mut output.frame);
        output.status = self
            .end
            .status(now, self.name, self.law.energy(), self.law.dissipated());
        let health = &mut output.health;
        health.input_age = self.end.silence(now);
        health.refused = self.end.refused(now);
        if !connected {
            health.raise(Fault::LinkDown, Level::WARN);
            health.message = Text::new("no frames from the operator's end");
        }
    }
}

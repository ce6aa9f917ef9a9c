//! The operator's end of the link.

use ferntast_control::{
    delay::{Law, LeaderEnd, LeaderInput},
    operating::OperatingState,
};
use ferntast_msgs::{
    Text, Time,
    sample::{
        Fault, Frame, Level, LinkCommandSample, LinkEnd, LinkStatusSample, OperatingStateSample,
        PoseSample, StateCommand, StateCommandSample, WrenchSample,
    },
};

use super::{FrameInput, FrameOutput, end::End, transport::LinkNode, velocity::VelocityFilter};
use crate::node::{Node, ports};

/// A hand older than this \[s\] is not sent on: it would only be repeated, and
/// the arm's watchdog has to see at once that the hand is silent.
const HAND_LIFE: f64 = 0.004;

ports! {
    /// The leader end's topics.
    LeaderLinkPorts for LeaderLinkNode;
    /// What the leader end takes.
    input LeaderLinkInput {
        setpoint_cp: Newest<PoseSample> = LEADER_SETPOINT_CP,
        operating_state: Newest<OperatingStateSample> = LEADER_OPERATING_STATE,
        state_command: Batch<StateCommandSample> = LEADER_STATE_COMMAND,
        link_command: Newest<LinkCommandSample> = LINK_COMMAND,
    }
    extra { frames: FrameInput, }
    /// What the leader end gives.
    output LeaderLinkOutput {
        reflected_cf: WrenchSample = LEADER_REFLECTED_CF,
        status: LinkStatusSample = LINK_STATUS,
    }
    extra { frame: FrameOutput, }
}

/// The operator's end of the link.
pub struct LeaderLinkNode {
    end: End,
    name: &'static str,
    law: LeaderEnd,
    velocity: VelocityFilter,
    /// Counts the operator's wishes to re-arm.
    arming: u8,
}

impl LeaderLinkNode {
    /// An end that runs `law`.
    pub fn new(law: &Law, session: u16) -> LeaderLinkNode {
        LeaderLinkNode {
            end: End::new(LinkEnd::LEADER, session),
            name: law.name(),
            law: law.leader(),
            velocity: VelocityFilter::default(),
            arming: 0,
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
                self.arming = self.arming.wrapping_add(1);
            }
        }
        self.end.receive(&input.frames);
        let hand = input.setpoint_cp.message.as_ref().map(|pose| {
            let motion = self.velocity.step(pose);
            (motion, input.setpoint_cp.silence(now) <= HAND_LIFE)
        });
        let dt = self.end.elapsed(now);
        let connected = self.end.connected(now);
        let step = self.law.step(
            dt,
            &LeaderInput {
                hand: hand.filter(|(_, valid)| *valid).map(|(motion, _)| motion),
                received: self.end.received(now),
                connected,
            },
        );
        output.reflected_cf = Some(WrenchSample::force(now, Frame::LEADER_BASE, step.force));
        let state = input
            .operating_state
            .message
            .and_then(|sample| OperatingState::from_code(sample.state.0))
            .unwrap_or(OperatingState::Disabled);
        self.end
            .send(now, state, self.arming, step.packet, &mut output.frame);
        output.status = self
            .end
            .status(now, self.name, self.law.energy(), self.law.dissipated());
        let health = &mut output.health;
        health.input_age = self.end.silence(now);
        health.refused = self.end.refused(now);
        if !connected {
            health.raise(Fault::LinkDown, Level::WARN);
            health.message = Text::new("no frames from the arm's end");
        }
    }
}

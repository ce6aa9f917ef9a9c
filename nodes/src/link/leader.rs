//! The operator's end of the link.

use ferntast_control::{
    operating::OperatingState,
    switching::{self, Laws, LeaderSwitch},
};
use ferntast_msgs::{
    Text, Time,
    sample::{
        Fault, Frame, LawCommandSample, Level, LinkCommandSample, LinkEnd, LinkStatusSample,
        OperatingStateSample, PoseSample, StateCommand, StateCommandSample, WrenchSample,
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
        law_command: Batch<LawCommandSample> = LINK_LAW_COMMAND,
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
    law: LeaderSwitch,
    velocity: VelocityFilter,
    /// Counts the operator's wishes to re-arm.
    arming: u8,
    /// A law that was asked for and is not there.
    unknown_law: Option<Text<24>>,
}

impl LeaderLinkNode {
    /// An end that starts with the first of `laws` and may switch to the others.
    /// Frames wait for up to `buffer` \[s\] to be played out evenly.
    pub fn new(laws: Laws, session: u16, buffer: f64) -> LeaderLinkNode {
        LeaderLinkNode {
            end: End::new(LinkEnd::LEADER, session, buffer),
            law: LeaderSwitch::new(laws),
            velocity: VelocityFilter::default(),
            arming: 0,
            unknown_law: None,
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
        for sample in input.law_command.iter() {
            let known = switching::code(sample.law.as_str());
            let taken = known.is_some_and(|code| self.law.switch_to(code));
            self.unknown_law = (!taken).then_some(sample.law);
        }
        self.end.receive(now, &input.frames);
        let hand = input.setpoint_cp.message.as_ref().map(|pose| {
            let motion = self.velocity.step(pose);
            (motion, input.setpoint_cp.silence(now) <= HAND_LIFE)
        });
        let dt = self.end.elapsed(now);
        let connected = self.end.connected(now);
        let step = self.law.step(
            dt,
            hand.filter(|(_, valid)| *valid).map(|(motion, _)| motion),
            self.end.newest(now),
            connected,
        );
        output.reflected_cf = Some(WrenchSample::force(now, Frame::LEADER_BASE, step.force));
        let state = input
            .operating_state
            .message
            .and_then(|sample| OperatingState::from_code(sample.state.0))
            .unwrap_or(OperatingState::Disabled);
        self.end
            .send(now, state, self.arming, step.outgoing, &mut output.frame);
        output.status = self.end.status(
            now,
            self.law.name(),
            self.law.energy(),
            self.law.dissipated(),
        );
        let health = &mut output.health;
        health.input_age = self.end.silence(now);
        health.refused = self.end.refused(now);
        if let Some(law) = &self.unknown_law {
            health.raise(Fault::CommandInvalid, Level::WARN);
            health.message = Text::display(format_args!(
                "/link/law_command: no law {:?} here",
                law.as_str()
            ));
        }
        if !connected {
            health.raise(Fault::LinkDown, Level::WARN);
            health.message = Text::new("no frames from the arm's end");
        }
    }
}

//! The arm's end of the link.

use ferntast_control::{
    link::{ESTIMATE_LIFE, FollowerLink, FollowerReadings},
    switching::Laws,
};
use ferntast_msgs::{
    Time,
    sample::{
        ContactStateSample, Frame, LinkCommandSample, LinkEnd, LinkStatusSample,
        OperatingStateSample, PoseSample, StateCommand, StateCommandSample, WrenchSample,
    },
};

use super::{
    FrameInput, FrameOutput,
    readings::{operating_state, position},
    status::{Status, report},
    transport::LinkNode,
};
use crate::node::{Node, ports};

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
    link: FollowerLink,
    status: Status,
}

impl FollowerLinkNode {
    /// An end that starts with the first of `laws` and follows the leader's end to the others.
    /// Frames wait for up to `buffer` \[s\] to be played out evenly.
    pub fn new(laws: Laws, session: u16, buffer: f64) -> FollowerLinkNode {
        FollowerLinkNode {
            link: FollowerLink::new(laws, session, buffer),
            status: Status::new(LinkEnd::FOLLOWER, session),
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
        for (bytes, arrived) in input.frames.iter() {
            self.link.arrived(bytes, arrived.nanos());
        }
        let readings = FollowerReadings {
            tip: position(now, &input.measured_cp),
            contact_force: contact_force(now, input),
            state: operating_state(&input.operating_state),
        };
        let step = self.link.step(now.nanos(), &readings);
        if step.rearm {
            output.state_command = Some(StateCommandSample::new(now, StateCommand::RESUME));
        }
        output.servo_cp = step
            .command
            .map(|tip| PoseSample::at(now, Frame::FOLLOWER_BASE, tip.position));
        output.frame.frame = step.frame;
        let state = self.link.state(now.nanos());
        output.status = self.status.step(now, &state);
        let silent = "no frames from the operator's end";
        report(&state, silent, &mut output.health);
    }
}

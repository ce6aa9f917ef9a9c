//! What an end counts comes out as a message.

use ferntast_control::{delay::Law, frame::FRAME_LENGTH, link::FollowerLink, switching::Laws};
use ferntast_msgs::{Time, sample::LinkEnd};

use ferntast_seal::Refusal;

use super::{FollowerLinkInput, FollowerLinkNode, FollowerLinkOutput, FrameInput};
use crate::node::{Node, Output};

#[test]
fn the_status_says_every_10_ms_what_was_refused() {
    let link = FollowerLink::new(Laws::new(Law::default()), 0.0);
    let mut node = FollowerLinkNode::new(link, 7);
    // The first is of long ago, the second says a position that is not a number.
    let mut spoilt = [0; FRAME_LENGTH];
    spoilt[18..22].copy_from_slice(&f32::NAN.to_le_bytes());
    let frames = FrameInput::of(&[[0; FRAME_LENGTH], spoilt], Time::from_nanos(1));
    let mut input = FollowerLinkInput {
        frames,
        ..FollowerLinkInput::default()
    };
    input.frames.peer.refused.forged = 5;
    input.frames.peer.last_refusal = Some(Refusal::Forged);
    let mut output = FollowerLinkOutput::default();
    let mut told = Vec::new();
    for tick in 0..21 {
        output.clear();
        let now = Time::from_nanos(1_700_000_000_000_000_000 + tick * 1_000_000);
        node.step(now, &input, &mut output);
        told.extend(output.status);
    }
    assert_eq!(told.len(), 3);
    let last = told[2];
    assert_eq!((last.refused_checksum, last.refused_value), (5, 21));
    assert_eq!(
        (last.end, last.session, last.connected),
        (LinkEnd::FOLLOWER, 7, 0)
    );
    assert_eq!(last.law.as_str(), Law::default().name());
    assert_eq!(
        output.health.refused,
        21 + 5 + last.refused_time + last.refused_replayed
    );
}
